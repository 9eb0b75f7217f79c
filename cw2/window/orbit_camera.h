// A camera, or a light, that is moved about what it looks at.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cw2/render/camera.h"

namespace cw2 {

/// `camera` after a drag by `angle`, in radians to the right and down, has turned what it looks at
/// about its target: up stays up, and it stays a degree away from looking along the world's y.
Camera orbited(const Camera& camera, const glm::vec2& angle);

/// `camera` after a drag by `way`, in heights of the picture to the right and down, has moved what
/// is at the target's depth along with the cursor.
Camera panned(const Camera& camera, const glm::vec2& way);

/// What a picture shows at `place`, in heights of the picture from its centre to the right and
/// down, as deep in it as the target is.
glm::vec3 point_at(const Camera& camera, const glm::vec2& place);

/// `camera` at `factor` times its distance from `point`, which stays where it is seen; the target
/// keeps its part of the way. Not nearer to the point, or the target, than `nearest`, and not
/// farther than `farthest`.
Camera dollied(const Camera& camera, const glm::vec3& point, float factor, float nearest,
               float farthest);

/// `position` after a drag by `angle`, in radians to the right and down as `camera` sees it, has
/// moved it on a sphere about `center`.
glm::vec3 dragged_about(const glm::vec3& position, const glm::vec3& center, const Camera& camera,
                        const glm::vec2& angle);

}  // namespace cw2
