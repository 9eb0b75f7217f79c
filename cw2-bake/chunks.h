// Cutting meshes into chunks for culling, and ordering what is in them for the GPU.
#pragma once

#include <cstdint>
#include <vector>

#include "cw2-bake/framed_mesh.h"

namespace bake {

/// Triangles of a mesh that lie close together.
struct Chunk {
    std::uint32_t first_index;  ///< into the mesh's indices
    std::uint32_t index_count;
};

/// A mesh of at most mesh_format::kMaxMeshVertices vertices, in the order of their first use; its
/// chunks follow each other and together hold all its indices.
struct ChunkedMesh {
    FramedMesh mesh;
    std::vector<Chunk> chunks;
};

/// Cuts `mesh` by halving its triangles at the median of their longest side until at most
/// mesh_format::kMaxChunkTriangles are left, then orders each chunk's triangles for the vertex
/// cache and against overdraw. Neighbouring chunks share a mesh as long as its vertices allow.
std::vector<ChunkedMesh> make_chunks(const FramedMesh& mesh);

}  // namespace bake
