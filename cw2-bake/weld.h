// Corners to indexed vertices.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "cw2-bake/source_scene.h"

namespace bake {

/// The triangles of one material. No two vertices are equal in position, normal and UV; they come
/// in the order of their first use.
struct WeldedMesh {
    std::uint32_t material;
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<std::uint32_t> indices;  ///< 3 a triangle, triangles in their source's order
    /// Those that the source gives, one an index as in SourceScene::tangents; empty if it gives
    /// none.
    std::vector<glm::vec4> tangents;
};

/// One mesh a material that is used, in the order of the materials. Every corner of `scene` has a
/// normal (see normals.h); a corner with no UV gets (0, 0).
std::vector<WeldedMesh> weld(const SourceScene& scene);

}  // namespace bake
