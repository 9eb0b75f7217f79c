#include "mesh-format/file.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "mesh-format/checker.h"

namespace mesh_format {

namespace {

template <typename T>
std::span<const std::byte> as_bytes(const T* data, std::size_t count) {
    return std::as_bytes(std::span<const T>(data, count));
}

std::uint64_t header_checksum(Header header) {
    header.checksum = 0;
    return checksum(as_bytes(&header, 1));
}

/// The header, once it is known to be one of ours, whole and unaltered.
Header checked_header(const Checker& check, std::span<const std::byte> bytes) {
    check.require(!bytes.empty(), "the file is empty");
    const std::size_t magic_bytes = std::min(bytes.size(), kMagic.size());
    check.require(std::memcmp(bytes.data(), kMagic.data(), magic_bytes) == 0,
                  "is no .cw2mesh file; bake one with cw2-bake");
    check.require(bytes.size() >= sizeof(Header), "is truncated: the header is incomplete");
    Header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.version != kVersion) {
        check.fail("has format version " + std::to_string(header.version) +
                   ", this program reads " + std::to_string(kVersion) + "; bake again");
    }
    check.require(header.header_size == sizeof(Header), "the header's size is wrong");
    check.require(header.checksum == header_checksum(header), "is altered: wrong header checksum");
    if (bytes.size() < header.file_size) {
        check.fail("is truncated: " + std::to_string(bytes.size()) + " of " +
                   std::to_string(header.file_size) + " bytes");
    }
    check.require(bytes.size() == header.file_size, "is altered: bytes after its end");
    return header;
}

constexpr std::array<const char*, kSectionCount> kSectionNames{
    "scene",   "meshes",   "chunks",  "materials", "textures",         "sources",
    "strings", "vertices", "indices", "texels",    "encoded vertices", "encoded indices"};
static_assert(kSectionNames.back() != nullptr);

constexpr std::uint64_t align_section(std::uint64_t offset) {
    return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

/// The sections follow each other, and nothing but zeros lies between them.
void check_sections(const Checker& check, std::span<const std::byte> bytes, const Header& header) {
    std::uint64_t end = sizeof(Header);
    for (std::size_t k = 0; k < kSectionCount; ++k) {
        const Section& section = header.sections[k];
        if (section.offset != align_section(end) ||
            !in_range(section.offset, section.size, bytes.size())) {
            check.fail(std::string("section ") + kSectionNames[k] + " is not where it belongs");
        }
        for (const std::byte padding : bytes.subspan(end, section.offset - end)) {
            check.require(padding == std::byte{0}, "is altered: a byte between two sections");
        }
        end = section.offset + section.size;
    }
    check.require(end == bytes.size(), "is altered: bytes after the last section");
}

/// The sections of a file whose header and their places have been checked.
class SectionReader {
 public:
    SectionReader(const Checker& check, std::span<const std::byte> bytes, const Header& header)
        : check_(check), bytes_(bytes), header_(header) {}

    std::span<const std::byte> bytes(SectionKind kind) const {
        const auto k = static_cast<std::size_t>(kind);
        const Section& section = header_.sections[k];
        const auto contents = bytes_.subspan(section.offset, section.size);
        const bool by_payload = kind == SectionKind::texels;
        if ((by_payload ? 0 : checksum(contents)) != section.checksum) {
            check_.fail(std::string("is altered: wrong checksum of section ") + kSectionNames[k]);
        }
        return contents;
    }

    template <typename Record>
    std::span<const Record> records(SectionKind kind) const {
        const auto contents = bytes(kind);
        if (contents.size() % sizeof(Record) != 0) {
            check_.fail(std::string("section ") + kSectionNames[static_cast<std::size_t>(kind)] +
                        " ends within a record");
        }
        // Aligned: sections start at multiples of 64 from a base that is a multiple of 16.
        return {reinterpret_cast<const Record*>(contents.data()), contents.size() / sizeof(Record)};
    }

 private:
    const Checker& check_;
    std::span<const std::byte> bytes_;
    const Header& header_;
};

}  // namespace

std::uint64_t checksum(std::span<const std::byte> bytes) {
    constexpr std::uint64_t kMultiplier = 0x9E37'79B9'7F4A'7C15;
    const auto fold = [](std::uint64_t lane, std::uint64_t word) {
        return std::rotl((lane ^ word) * kMultiplier, 29);
    };
    std::uint64_t lanes[4] = {0, 1, 2, 3};
    const std::size_t block_bytes = bytes.size() / 32 * 32;
    for (std::size_t at = 0; at < block_bytes; at += 32) {
        std::uint64_t words[4];
        std::memcpy(words, bytes.data() + at, sizeof words);
        for (int i = 0; i < 4; ++i) lanes[i] = fold(lanes[i], words[i]);
    }
    const std::size_t rest = bytes.size() - block_bytes;
    if (rest > 0) {
        std::uint64_t words[4] = {};
        std::memcpy(words, bytes.data() + block_bytes, rest);
        for (std::size_t i = 0; i < (rest + 7) / 8; ++i) lanes[i] = fold(lanes[i], words[i]);
    }
    std::uint64_t result = bytes.size();
    for (const std::uint64_t lane : lanes) result = fold(result, lane);
    return result;
}

Document parse(std::span<const std::byte> bytes, std::string_view name, Payloads payloads) {
    assert(reinterpret_cast<std::uintptr_t>(bytes.data()) % 16 == 0);
    const Checker checker(name);
    const Header header = checked_header(checker, bytes);
    check_sections(checker, bytes, header);
    const SectionReader sections(checker, bytes, header);

    const auto scenes = sections.records<SceneRecord>(SectionKind::scene);
    checker.require(scenes.size() == 1, "section scene does not hold one record");
    Document document;
    document.scene = scenes.front();
    document.meshes = sections.records<MeshRecord>(SectionKind::meshes);
    document.chunks = sections.records<ChunkRecord>(SectionKind::chunks);
    document.materials = sections.records<MaterialRecord>(SectionKind::materials);
    document.textures = sections.records<TextureRecord>(SectionKind::textures);
    document.sources = sections.records<SourceRecord>(SectionKind::sources);
    const auto strings = sections.bytes(SectionKind::strings);
    document.strings = {reinterpret_cast<const char*>(strings.data()), strings.size()};
    document.vertices = sections.bytes(SectionKind::vertices);
    document.indices = sections.records<std::uint16_t>(SectionKind::indices);
    document.texels = sections.bytes(SectionKind::texels);
    document.encoded_vertices = sections.bytes(SectionKind::encoded_vertices);
    document.encoded_indices = sections.bytes(SectionKind::encoded_indices);
    check(document, name);
    for (std::size_t i = 0; payloads == Payloads::checked && i < document.textures.size(); ++i) {
        check_payload(document, i, name);
    }
    return document;
}

void check_payload(const Document& document, std::size_t texture, std::string_view name) {
    const TextureRecord& record = document.textures[texture];
    Checker(name).require(checksum(document.payload(record)) == record.checksum, "texture", texture,
                          "is altered: wrong checksum of its texels");
}

std::uint64_t write(const Document& document, std::span<const std::span<const std::byte>> payloads,
                    std::string_view name, const Sink& sink) {
    assert(payloads.size() == document.textures.size());
    std::uint64_t texel_bytes = 0;
    for (std::size_t i = 0; i < payloads.size(); ++i) {
        assert(payloads[i].size() == document.textures[i].size);
        assert(checksum(payloads[i]) == document.textures[i].checksum);
        texel_bytes += payloads[i].size();
    }
    check(document, texel_bytes, name);

    constexpr auto kTexels = static_cast<std::size_t>(SectionKind::texels);
    const std::array<std::span<const std::byte>, kSectionCount> contents{
        as_bytes(&document.scene, 1),
        std::as_bytes(document.meshes),
        std::as_bytes(document.chunks),
        std::as_bytes(document.materials),
        std::as_bytes(document.textures),
        std::as_bytes(document.sources),
        as_bytes(document.strings.data(), document.strings.size()),
        document.vertices,
        std::as_bytes(document.indices),
        {},  // the payloads
        document.encoded_vertices,
        document.encoded_indices,
    };
    Header header{};
    header.magic = kMagic;
    header.version = kVersion;
    header.header_size = sizeof(Header);
    std::uint64_t end = sizeof(Header);
    for (std::size_t k = 0; k < kSectionCount; ++k) {
        const std::uint64_t offset = align_section(end);
        header.sections[k] = k == kTexels
                                 ? Section{offset, texel_bytes, 0}
                                 : Section{offset, contents[k].size(), checksum(contents[k])};
        end = offset + header.sections[k].size;
    }
    header.file_size = end;
    header.checksum = header_checksum(header);

    sink(as_bytes(&header, 1));
    std::uint64_t position = sizeof(Header);
    for (std::size_t k = 0; k < kSectionCount; ++k) {
        static constexpr std::byte kPadding[kSectionAlignment] = {};
        sink(std::span(kPadding).first(header.sections[k].offset - position));
        sink(contents[k]);
        for (const auto payload : k == kTexels ? payloads : payloads.first(0)) sink(payload);
        position = header.sections[k].offset + header.sections[k].size;
    }
    return header.file_size;
}

}  // namespace mesh_format
