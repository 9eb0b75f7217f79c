// Cutting meshes into chunks for culling, and ordering what is in them for the GPU.
#pragma once

#include <cstdint>
#include <vector>

#include "cw2-bake/framed_mesh.h"

namespace bake {

/// How exact the UVs of a material must be.
struct UvBudget {
    std::uint32_t texels = 1024;  ///< the longest side of its textures
    bool shiftable = true;        ///< all its textures repeat: whole numbers may be subtracted

    /// Half the step of a UV lattice may be 1/8 texel at most.
    double largest_step() const { return 0.25 / texels; }
};

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
/// mesh_format::kMaxChunkTriangles are left, and further by UV where 16 bits would not hold a
/// chunk's UVs within `budget`; then orders each chunk's triangles for the vertex cache and against
/// overdraw. Neighbouring chunks share a mesh as long as its vertices and its UVs allow.
std::vector<ChunkedMesh> make_chunks(const FramedMesh& mesh, const UvBudget& budget);

}  // namespace bake
