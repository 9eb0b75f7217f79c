// Vertices with their tangents.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "cw2-bake/weld.h"

namespace bake {

/// Triangles of one material; a vertex has one tangent.
struct FramedMesh {
    std::uint32_t material = 0;
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;       ///< as the file has them: v = 0 is the top row
    std::vector<glm::vec4> tangents;  ///< see tangents.h
    std::vector<std::uint32_t> indices;
};

/// Gives `mesh` its tangents (those it has, else MikkTSpace's), which follow OBJ's v (up), and
/// turns v down: vertices whose corners differ in them are split. Vertices come in the order of
/// their first use.
FramedMesh add_tangents(WeldedMesh mesh);

}  // namespace bake
