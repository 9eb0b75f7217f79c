#include "mesh-format/decode.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh-format/checker.h"
#include "mesh-format/vertex_stream.h"

namespace mesh_format {

namespace {

using Bytes = std::span<const std::byte>;

/// The parts of an encoded section or payload; none where their sizes do not fit it.
std::vector<Bytes> parts_of(Bytes whole, std::size_t count) {
    std::vector<Bytes> parts;
    std::uint64_t offset = std::uint64_t{count} * sizeof(std::uint32_t);
    if (offset > whole.size()) return {};
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t size = 0;
        std::memcpy(&size, whole.data() + i * sizeof size, sizeof size);
        if (!in_range(offset, size, whole.size())) return {};
        parts.push_back(whole.subspan(offset, size));
        offset += size;
    }
    return offset == whole.size() ? parts : std::vector<Bytes>();
}

/// What one task after the other uses.
struct Workplace {
    std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> zstd{ZSTD_createDCtx(), &ZSTD_freeDCtx};
    Scratch scratch;
    std::vector<Neighbours> neighbours;

    Workplace() {
        if (!zstd) throw std::bad_alloc();
    }

    /// How many bytes the Zstandard frames hold, which then are at `out`; more than `room` if they
    /// are none or hold more than that.
    std::size_t unwrap(Bytes frames, std::byte* out, std::size_t room) {
        // Errors are the largest values.
        return ZSTD_decompressDCtx(zstd.get(), out, room, frames.data(), frames.size());
    }
};

/// As many as there are tasks at once.
class Workplaces {
 public:
    /// Calls use(workplace).
    template <typename Use>
    void with_one(const Use& use) {
        std::unique_ptr<Workplace> workplace = take();
        use(*workplace);
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(workplace));
    }

 private:
    std::unique_ptr<Workplace> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) return std::make_unique<Workplace>();
        std::unique_ptr<Workplace> workplace = std::move(free_.back());
        free_.pop_back();
        return workplace;
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<Workplace>> free_;
};

bool decode_mesh(const MeshRecord& mesh, Bytes index_part, Bytes vertex_part,
                 std::span<std::uint16_t> indices, std::byte* vertices, Workplace& workplace) {
    Scratch& scratch = workplace.scratch;
    scratch.reset();
    const std::size_t index_room = index_stream_bound(mesh.index_count);
    std::byte* const index_stream = scratch.take<std::byte>(index_room);
    const std::size_t index_size = workplace.unwrap(index_part, index_stream, index_room);
    if (workplace.neighbours.size() < mesh.vertex_count)
        workplace.neighbours.resize(mesh.vertex_count);
    const std::span neighbours(workplace.neighbours.data(), mesh.vertex_count);
    if (index_size > index_room ||
        !decode_indices({index_stream, index_size}, indices, neighbours, scratch))
        return false;
    scratch.reset();
    const std::size_t vertex_size = vertex_stream_bytes(mesh);
    std::byte* const vertex_stream = scratch.take<std::byte>(vertex_size);
    return workplace.unwrap(vertex_part, vertex_stream, vertex_size) == vertex_size &&
           decode_vertices(mesh, indices, neighbours, vertex_stream, vertices, scratch);
}

void run(const Loop& loop, std::size_t count, const std::function<void(std::size_t)>& task) {
    if (loop) return loop(count, task);
    for (std::size_t i = 0; i < count; ++i) task(i);
}

/// Where a mesh's part of the section ends.
std::uint64_t vertex_end(const MeshRecord& mesh) {
    return mesh.vertex_offset + std::uint64_t{mesh.vertex_count} * vertex_layout(mesh.forms).stride;
}
std::uint64_t index_end(const MeshRecord& mesh) {
    return mesh.first_index + mesh.index_count;
}

}  // namespace

DecodedGeometry decode(Document& document, std::string_view name, const Loop& loop) {
    if (!document.is_encoded()) return {};
    const std::uint64_t stored = document.encoded_vertices.size() +
                                 document.encoded_indices.size() + document.chunks.size_bytes();
    const std::uint64_t claimed = document.scene.vertex_bytes / kLargestRatio +
                                  document.scene.index_count / kLargestRatio * 2;
    if (claimed > stored) {
        throw FormatError(std::string(name) + ": the scene's sizes are implausible");
    }
    DecodedGeometry geometry{
        std::make_unique_for_overwrite<std::byte[]>(document.scene.vertex_bytes),
        std::make_unique_for_overwrite<std::uint16_t[]>(document.scene.index_count)};
    const std::size_t count = document.meshes.size();
    const std::vector<Bytes> vertices = parts_of(document.encoded_vertices, count);
    const std::vector<Bytes> indices = parts_of(document.encoded_indices, count);
    Workplaces workplaces;
    // The tasks are the first to touch this memory, each its mesh's and what lies before that.
    const auto decode_one = [&](std::size_t i) {
        const MeshRecord& mesh = document.meshes[i];
        const bool is_first = i == 0;
        std::byte* const mesh_vertices = geometry.vertices.get() + mesh.vertex_offset;
        const std::span mesh_indices(geometry.indices.get() + mesh.first_index, mesh.index_count);
        std::fill(geometry.vertices.get() + (is_first ? 0 : vertex_end(document.meshes[i - 1])),
                  mesh_vertices, std::byte{0});
        std::fill(geometry.indices.get() + (is_first ? 0 : index_end(document.meshes[i - 1])),
                  mesh_indices.data(), std::uint16_t{0});
        if (vertex_layout(mesh.forms).has_gaps)
            std::fill(mesh_vertices, geometry.vertices.get() + vertex_end(mesh), std::byte{0});
        bool is_sound = false;
        workplaces.with_one([&](Workplace& workplace) {
            is_sound =
                decode_mesh(mesh, indices[i], vertices[i], mesh_indices, mesh_vertices, workplace);
        });
        if (!is_sound) {
            throw FormatError(std::string(name) + ": mesh " + std::to_string(i) +
                              ": its encoded geometry is damaged");
        }
    };
    run(loop, count, decode_one);
    const std::span all_vertices(geometry.vertices.get(), document.scene.vertex_bytes);
    const std::span all_indices(geometry.indices.get(), document.scene.index_count);
    const MeshRecord& last = document.meshes.back();
    std::ranges::fill(all_vertices.subspan(vertex_end(last)), std::byte{0});
    std::ranges::fill(all_indices.subspan(index_end(last)), std::uint16_t{0});
    document.vertices = all_vertices;
    document.indices = all_indices;
    document.encoded_vertices = {};
    document.encoded_indices = {};
    check_decoded(document, name);
    return geometry;
}

Payload decode_payload(const Document& document, std::size_t texture, std::string_view name,
                       std::uint32_t first_level, const Loop& loop) {
    const TextureRecord& record = document.textures[texture];
    const Bytes stored = document.payload(record);
    if (!(record.flags & kCompressed)) return {stored, {}};
    const std::uint64_t size = mip_chain_bytes(record.format, record.width, record.height);
    const std::vector<Bytes> parts = parts_of(stored, (size + kPartBytes - 1) / kPartBytes);
    const Checker checker(name);
    const char* const kDamaged = "its compressed texels are damaged";
    checker.require(!parts.empty(), "texture", texture, kDamaged);
    std::uint64_t begin = 0;
    for (std::uint32_t level = 0; level < first_level; ++level)
        begin += mip_bytes(record.format, record.width, record.height, level);
    const std::size_t first = begin / kPartBytes;
    Payload payload{{}, std::make_unique_for_overwrite<std::byte[]>(size)};
    payload.bytes = {payload.memory.get(), size};
    Workplaces workplaces;
    run(loop, parts.size() - first, [&](std::size_t i) {
        const Bytes part = parts[first + i];
        const std::uint64_t offset = (first + i) * kPartBytes;
        const std::uint64_t expected = std::min(kPartBytes, size - offset);
        workplaces.with_one([&](Workplace& workplace) {
            checker.require(
                workplace.unwrap(part, payload.memory.get() + offset, expected) == expected,
                "texture", texture, kDamaged);
        });
    });
    return payload;
}

}  // namespace mesh_format
