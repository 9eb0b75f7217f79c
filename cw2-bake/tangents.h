// Tangents by MikkTSpace's rules.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace bake {

/// One tangent a corner: xyz of unit length and, where the UVs allow it, orthogonal to the
/// corner's normal; w = +1 or -1, so that the bitangent is w * cross(normal, tangent), along +v.
///
/// The result is MikkTSpace's (Mikkelsen 2008) with its default angular threshold of 180 degrees
/// for the same triangles, v pointing up. `indices` are triangles over vertices of which no two
/// have equal position, normal and UV (weld first: two corners are one vertex for MikkTSpace when
/// those are equal).
std::vector<glm::vec4> generate_tangents(std::span<const glm::vec3> positions,
                                         std::span<const glm::vec3> normals,
                                         std::span<const glm::vec2> uvs,
                                         std::span<const std::uint32_t> indices);

}  // namespace bake
