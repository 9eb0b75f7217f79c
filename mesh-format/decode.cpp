#include "mesh-format/decode.h"

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <tbb/parallel_for.h>
#include <zstd.h>

#include <cstring>
#include <span>

namespace mesh_format {

namespace {

using Bytes = std::span<const std::byte>;

// Real scenes shrink to a tenth; a small file must not claim all memory.
constexpr std::uint64_t kLargestRatio = 1000;

/// The parts of an encoded section, one a mesh; their sizes have been checked.
std::vector<Bytes> parts_of(Bytes section, std::size_t count) {
    std::vector<Bytes> parts;
    std::size_t offset = count * sizeof(std::uint32_t);
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t size = 0;
        std::memcpy(&size, section.data() + i * sizeof size, sizeof size);
        parts.push_back(section.subspan(offset, size));
        offset += size;
    }
    return parts;
}

/// The stream in a Zstandard frame, if it is one of at most `largest` bytes.
std::vector<unsigned char> unwrap(Bytes frame, std::size_t largest, bool& sound) {
    const auto size = ZSTD_getFrameContentSize(frame.data(), frame.size());
    sound = size <= largest;  // errors are the largest values
    std::vector<unsigned char> stream(sound ? size : 0);
    sound = sound && ZSTD_decompress(stream.data(), stream.size(), frame.data(), frame.size()) ==
                         stream.size();
    return stream;
}

bool decode_vertices(const MeshRecord& mesh, Bytes part, std::byte* out) {
    const std::size_t stride = vertex_layout(mesh.forms).stride;
    const std::size_t padded = (stride + 3) / 4 * 4;
    bool sound = true;
    const auto stream =
        unwrap(part, meshopt_encodeVertexBufferBound(mesh.vertex_count, padded), sound);
    std::vector<std::byte> vertices(mesh.vertex_count * padded);
    if (!sound || meshopt_decodeVertexBuffer(vertices.data(), mesh.vertex_count, padded,
                                             stream.data(), stream.size()) != 0) {
        return false;
    }
    for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
        std::memcpy(out + i * stride, vertices.data() + i * padded, stride);
    }
    return true;
}

bool decode_indices(const MeshRecord& mesh, Bytes part, std::uint16_t* out) {
    bool sound = true;
    const auto stream =
        unwrap(part, meshopt_encodeIndexBufferBound(mesh.index_count, mesh.vertex_count), sound);
    return sound &&
           meshopt_decodeIndexBuffer(out, mesh.index_count, stream.data(), stream.size()) == 0;
}

}  // namespace

DecodedGeometry decode(Document& document, std::string_view name) {
    if (!document.is_encoded()) return {};
    const std::uint64_t stored = document.encoded_vertices.size() + document.encoded_indices.size();
    const std::uint64_t claimed = document.scene.vertex_bytes / kLargestRatio +
                                  document.scene.index_count / kLargestRatio * 2;
    if (claimed > stored) {
        throw FormatError(fmt::format("{}: the scene's sizes are implausible", name));
    }
    DecodedGeometry geometry;
    geometry.vertices.resize(document.scene.vertex_bytes);
    geometry.indices.resize(document.scene.index_count);
    const std::size_t count = document.meshes.size();
    const std::vector<Bytes> vertices = parts_of(document.encoded_vertices, count);
    const std::vector<Bytes> indices = parts_of(document.encoded_indices, count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const MeshRecord& mesh = document.meshes[i];
        if (!decode_vertices(mesh, vertices[i], geometry.vertices.data() + mesh.vertex_offset) ||
            !decode_indices(mesh, indices[i], geometry.indices.data() + mesh.first_index)) {
            throw FormatError(fmt::format("{}: mesh {}: its encoded geometry is damaged", name, i));
        }
    });
    document.vertices = geometry.vertices;
    document.indices = geometry.indices;
    document.encoded_vertices = {};
    document.encoded_indices = {};
    check(document, name);
    return geometry;
}

}  // namespace mesh_format
