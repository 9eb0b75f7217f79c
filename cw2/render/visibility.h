// Which chunks of a scene a camera may see, and in which order to draw them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "cw2/render/scene.h"

namespace cw2 {

/// Left, right, bottom, top and near plane, pointing inwards, normalised: a point's distance from
/// a plane is dot(plane, (point, 1)).
using FrustumPlanes = std::array<glm::vec4, 5>;
/// Of what `clip` makes clip space of, with reversed depth.
FrustumPlanes frustum_planes(const glm::mat4& clip);
bool is_outside(const FrustumPlanes& planes, const glm::vec3& center, float radius);

/// What up to five planes leave of a triangle: up to 8 corners, and no more than there is room for
/// where rounding bends it.
struct CutTriangle {
    std::array<glm::vec3, 20> corners;
    std::size_t count;
};
/// Of the side that `planes` point to, as those of a frustum do (Sutherland and Hodgman 1974).
CutTriangle cut(const std::array<glm::vec3, 3>& triangle, std::span<const glm::vec4> planes);

/// Writes to `visible` the indices of the chunks whose spheres meet the frustum and, where back
/// faces are culled, whose normal cones do not all look away: opaque chunks before alpha-masked
/// ones, each from near to far, which spares shading what is hidden.
void find_visible(std::span<const SceneChunk> chunks, std::span<const Draw> draws,
                  const glm::mat4& clip_from_world, const glm::vec3& camera_position,
                  std::vector<std::uint32_t>& visible);

}  // namespace cw2
