#include "cw2/window/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "cw2/window/fly_camera.h"

namespace cw2 {

namespace {

/// What a vector becomes by a turn of `angle` radians about `axis`, of unit length.
glm::dvec3 turned_about(const glm::dvec3& vector, const glm::dvec3& axis, double angle) {
    return std::cos(angle) * vector + std::sin(angle) * glm::cross(axis, vector) +
           (1.0 - std::cos(angle)) * glm::dot(axis, vector) * axis;
}

/// How many scene units a height of the picture is at the target's depth, to the right and down.
glm::dmat2x3 picture_plane(const Camera& camera) {
    const CameraAxes axes = axes_of(camera);
    const double height = 2.0 * std::tan(0.5 * double{camera.vertical_fov}) *
                          glm::distance(glm::dvec3(camera.position), glm::dvec3(camera.target));
    return {height * axes.right, -height * axes.up};
}

}  // namespace

Camera orbited(const Camera& camera, const glm::vec2& angle) {
    const Camera there = turned(camera, angle);
    return {camera.target - (there.target - there.position), camera.target, camera.vertical_fov};
}

Camera panned(const Camera& camera, const glm::vec2& way) {
    const glm::vec3 step(picture_plane(camera) * glm::dvec2(way));
    return {camera.position - step, camera.target - step, camera.vertical_fov};
}

glm::vec3 point_at(const Camera& camera, const glm::vec2& place) {
    return camera.target + glm::vec3(picture_plane(camera) * glm::dvec2(place));
}

Camera dollied(const Camera& camera, const glm::vec3& point, float factor, float nearest,
               float farthest) {
    const float to_point = glm::distance(camera.position, point);
    const float to_target = glm::distance(camera.position, camera.target);
    // Where it is too near already it does not go back by itself.
    const float least = std::min(1.0f, nearest / std::min(to_point, to_target));
    const float most = std::max(1.0f, farthest / std::max(to_point, to_target));
    const float part = std::clamp(factor, least, most);
    return {point + part * (camera.position - point), point + part * (camera.target - point),
            camera.vertical_fov};
}

glm::vec3 dragged_about(const glm::vec3& position, const glm::vec3& center, const Camera& camera,
                        const glm::vec2& angle) {
    const CameraAxes axes = axes_of(camera);
    glm::dvec3 arm = glm::dvec3(position) - glm::dvec3(center);
    arm = turned_about(arm, axes.up, angle.x);
    arm = turned_about(arm, axes.right, angle.y);
    return glm::vec3(glm::dvec3(center) + arm);
}

}  // namespace cw2
