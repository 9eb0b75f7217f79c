// A camera that flies.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cw2/render/camera.h"

namespace cw2 {

/// `camera` moved by `way`, in scene units to its right, up the world's y, and forward.
Camera moved(const Camera& camera, const glm::vec3& way);

/// `camera` turned where it stands, by `angle` in radians to the right and down. It stays a degree
/// away from looking along the world's y.
Camera turned(const Camera& camera, const glm::vec2& angle);

}  // namespace cw2
