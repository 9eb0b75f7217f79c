// Cutting a material's triangles into chunks for culling, and into meshes for 16-bit indices.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/geometry/box.h"
#include "cw2-bake/geometry/framed_scene.h"
#include "mesh-format/layout.h"

namespace bake {

/// How exact the UVs of a material must be.
struct UvBudget {
    std::uint32_t texels = 1024;  ///< the longest side of its textures
    bool shiftable = true;        ///< all its textures repeat: whole numbers may be subtracted

    /// Half the step of a UV lattice may be 1/8 texel at most.
    double largest_step() const { return 0.25 / texels; }
};

/// Triangles of one material over at most mesh_format::kMaxMeshVertices vertices, which come in the
/// order of their first use. The chunks follow each other and together hold all the indices; their
/// spheres and cones are those of the vertices as the source has them.
struct ChunkedMesh {
    std::uint32_t material = 0;
    std::vector<std::uint32_t> vertices;  ///< in FramedTriangles::vertices
    std::span<std::uint16_t> indices;     ///< into `vertices`; part of ChunkedScene::indices
    std::vector<mesh_format::ChunkRecord> chunks;
    Box<glm::vec3> positions;
    Box<glm::vec2> uvs;
};

struct ChunkedScene {
    std::vector<ChunkedMesh> meshes;
    RawVector<std::uint16_t> indices;  ///< of all meshes, mesh after mesh
};

/// Cuts the triangles of each material by halving them at the median of their longest side until at
/// most mesh_format::kMaxChunkTriangles are left, and further by UV where 16 bits would not hold a
/// chunk's UVs within the material's budget; then orders each chunk's triangles for the vertex
/// cache. Neighbouring chunks share a mesh as long as its vertices and its UVs allow. The meshes
/// come in the order of their materials.
ChunkedScene make_chunks(const FramedScene& scene, std::span<const UvBudget> budgets,
                         const Advance& advance = kUnwatched);

}  // namespace bake
