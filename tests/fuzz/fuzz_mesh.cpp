// A .cw2mesh file; its checksums are set right first, so that what they guard is reached.
#include <algorithm>
#include <cstring>
#include <vector>

#include "mesh-format/file.h"
#include "tests/fuzz/fuzzing.h"

namespace {

using namespace mesh_format;

/// Starts at a multiple of 16, as a mapped file does.
struct alignas(16) Block {
    std::byte bytes[16];
};

std::span<std::byte> part(std::span<std::byte> file, std::uint64_t offset, std::uint64_t size) {
    if (offset > file.size() || size > file.size() - offset) return {};
    return file.subspan(offset, size);
}

void seal(std::span<std::byte> file) {
    if (file.size() < sizeof(Header)) return;
    Header header;
    std::memcpy(&header, file.data(), sizeof header);
    for (Section& section : header.sections)
        section.checksum = checksum(part(file, section.offset, section.size));
    header.sections[static_cast<std::size_t>(SectionKind::texels)].checksum = 0;
    header.checksum = 0;
    header.checksum = checksum(std::as_bytes(std::span(&header, 1)));
    std::memcpy(file.data(), &header, sizeof header);
}

/// Before seal(): the checksum of a texture lies in a section that has one itself.
void seal_textures(std::span<std::byte> file) {
    if (file.size() < sizeof(Header)) return;
    Header header;
    std::memcpy(&header, file.data(), sizeof header);
    const auto section = [&](SectionKind kind) {
        const Section& found = header.sections[static_cast<std::size_t>(kind)];
        return part(file, found.offset, found.size);
    };
    const auto records = section(SectionKind::textures);
    for (std::size_t at = 0; at + sizeof(TextureRecord) <= records.size();
         at += sizeof(TextureRecord)) {
        TextureRecord record;
        std::memcpy(&record, records.data() + at, sizeof record);
        record.checksum = checksum(part(section(SectionKind::texels), record.offset, record.size));
        std::memcpy(records.data() + at, &record, sizeof record);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<Block> blocks(size / sizeof(Block) + 1);
    const auto file = std::as_writable_bytes(std::span(blocks)).first(size);
    std::copy_n(reinterpret_cast<const std::byte*>(data), size, file.begin());
    seal_textures(file);
    seal(file);
    fuzzing::read_mesh(file);
    return 0;
}
