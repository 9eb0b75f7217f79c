// A mesh's triangles to and from the stream that a compressed file holds of them, see TriangleStart
// in layout.h. On the way vertices get the neighbours from which vertex_stream.h predicts them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh-format/layout.h"
#include "mesh-format/scratch.h"

namespace mesh_format {

/// Three vertices before a vertex; what one of its numbers probably is: a + b - c, those of the
/// three. Where b and c are the same, that is a.
struct Neighbours {
    std::uint16_t a, b, c;
    std::uint16_t unused;  // so that they are one word
    bool operator==(const Neighbours&) const = default;
};

/// The stream of triangles; sets the neighbours of all vertices, of which there are at most
/// kMaxMeshVertices. Every index must be below their number. `indices` become those that the stream
/// is decoded to: the same triangles, but each may start at another of its corners.
std::vector<std::byte> encode_indices(std::span<std::uint16_t> indices,
                                      std::span<Neighbours> neighbours);

/// The most bytes that a stream of `index_count` indices has: a code and three numbers a triangle.
constexpr std::size_t index_stream_bound(std::size_t index_count) {
    return index_count / 3 + 2 * index_count;
}

/// Sets the indices that a stream stands for, and the neighbours. False if the stream is none, or
/// has an index that is no vertex.
bool decode_indices(std::span<const std::byte> stream, std::span<std::uint16_t> indices,
                    std::span<Neighbours> neighbours, Scratch& scratch);

}  // namespace mesh_format
