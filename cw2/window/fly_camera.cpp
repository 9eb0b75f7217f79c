#include "cw2/window/fly_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace cw2 {

Camera moved(const Camera& camera, const glm::vec3& way) {
    const CameraAxes axes = axes_of(camera);
    const glm::vec3 step =
        way.x * glm::vec3(axes.right) + glm::vec3(0.0f, way.y, 0.0f) - way.z * glm::vec3(axes.back);
    return {camera.position + step, camera.target + step, camera.vertical_fov};
}

Camera turned(const Camera& camera, const glm::vec2& angle) {
    constexpr float kSteepest = 1.5533430f;  // 89 degrees
    const glm::vec3 sight = camera.target - camera.position;
    // Unlike the sight, the horizontal axis has a heading also for a camera that looks along y.
    const glm::vec3 right(axes_of(camera).right);
    const float heading = std::atan2(right.z, right.x) + angle.x;
    const float rise = std::atan2(sight.y, std::hypot(sight.x, sight.z)) - angle.y;
    const float pitch = std::clamp(rise, -kSteepest, kSteepest);
    const glm::vec3 forward{std::cos(pitch) * std::sin(heading), std::sin(pitch),
                            -std::cos(pitch) * std::cos(heading)};
    return {camera.position, camera.position + glm::length(sight) * forward, camera.vertical_fov};
}

}  // namespace cw2
