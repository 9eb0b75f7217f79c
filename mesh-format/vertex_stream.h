// A mesh's vertices to and from the stream that a compressed file holds of them, see FrameModel in
// layout.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh-format/index_stream.h"
#include "mesh-format/layout.h"

namespace mesh_format {

/// Bytes of a stream before its planes.
inline constexpr std::size_t kVertexStreamHead = 3;

/// Bytes of a mesh's stream.
std::size_t vertex_stream_bytes(const MeshRecord& mesh);

/// The stream of `mesh`, whose vertices start at those given. `indices` are as they are once
/// decoded; `neighbours` came with them.
std::vector<std::byte> encode_vertices(const MeshRecord& mesh,
                                       std::span<const std::uint16_t> indices,
                                       std::span<const Neighbours> neighbours,
                                       const std::byte* vertices);

/// Writes the vertices that the vertex_stream_bytes(mesh) bytes at `stream` stand for to
/// `vertices`, but for the gaps between their parts. Every index must be below the number of
/// vertices. False if the stream is none; any other bytes become vertices, too.
bool decode_vertices(const MeshRecord& mesh, std::span<const std::uint16_t> indices,
                     std::span<const Neighbours> neighbours, const std::byte* stream,
                     std::byte* vertices, Scratch& scratch);

}  // namespace mesh_format
