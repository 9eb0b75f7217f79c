// Which chunks of a scene a camera may see, and in which order to draw them.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "cw2/scene.h"

namespace cw2 {

/// Writes to `chunks` the indices of the scene's chunks whose spheres meet the frustum and, where
/// back faces are culled, whose normal cones do not all look away: opaque chunks before
/// alpha-masked ones, each from near to far, which spares shading what is hidden.
void find_visible(const Scene& scene, const glm::mat4& clip_from_world,
                  const glm::vec3& camera_position, std::vector<std::uint32_t>& chunks);

}  // namespace cw2
