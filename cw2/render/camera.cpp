#include "cw2/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace cw2 {

Bounds bounds_of(const mesh_format::SceneRecord& scene) {
    const glm::vec3 low = glm::make_vec3(scene.bounds_min);
    const glm::vec3 high = glm::make_vec3(scene.bounds_max);
    // A scene of one point still has a picture.
    return {0.5f * (low + high), std::max(scene.radius, 1e-6f)};
}

SceneStart start_of(const mesh_format::SceneRecord& scene) {
    SceneStart start;
    if (scene.flags & mesh_format::kHasCamera) {
        start.camera = {glm::make_vec3(scene.camera_position), glm::make_vec3(scene.camera_target),
                        scene.camera_fov};
    }
    if (scene.flags & mesh_format::kHasLight) {
        start.light_position = glm::make_vec3(scene.light_position);
        start.light_color = glm::make_vec3(scene.light_color);
    }
    return start;
}

Camera default_camera(const Bounds& bounds, float vertical_fov, float aspect) {
    const float half_vertical = 0.5f * vertical_fov;
    const float half_horizontal = std::atan(std::tan(half_vertical) * aspect);
    const float distance = bounds.radius / std::sin(std::min(half_vertical, half_horizontal));
    const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, 0.5f, 1.0f));
    return {bounds.center + distance * direction, bounds.center, vertical_fov};
}

Camera around_target(const Camera& camera, double radians) {
    const double sine = std::sin(radians);
    const double cosine = std::cos(radians);
    const glm::dvec3 arm = glm::dvec3(camera.position) - glm::dvec3(camera.target);
    const glm::dvec3 turned(cosine * arm.x + sine * arm.z, arm.y, cosine * arm.z - sine * arm.x);
    return {glm::vec3(glm::dvec3(camera.target) + turned), camera.target, camera.vertical_fov};
}

glm::mat4 view_from_world(const Camera& camera) {
    const glm::vec3 forward = glm::normalize(camera.target - camera.position);
    const glm::vec3 up =
        std::abs(forward.y) < 0.9999f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(0.0f, 0.0f, -1.0f);
    return glm::lookAtRH(camera.position, camera.position + forward, up);
}

glm::mat4 clip_from_view(float vertical_fov, float aspect, float near) {
    const float focal = 1.0f / std::tan(0.5f * vertical_fov);
    glm::mat4 clip(0.0f);
    clip[0][0] = focal / aspect;
    clip[1][1] = -focal;
    clip[2][3] = -1.0f;
    clip[3][2] = near;
    return clip;
}

float near_distance(const Bounds& bounds) {
    // With reversed depth in 32-bit floats the near plane costs no precision.
    return 1e-4f * bounds.radius;
}

glm::vec3 default_light_position(const Bounds& bounds) {
    return bounds.center + bounds.radius * glm::vec3(0.5f, 0.8f, 0.6f);
}

glm::vec3 orbit(const glm::vec3& start, const glm::vec3& center, double seconds) {
    const double sine = std::sin(seconds);
    const double cosine = std::cos(seconds);
    const glm::dvec3 arm(start - center);
    const glm::dvec3 turned(cosine * arm.x - sine * arm.y, sine * arm.x + cosine * arm.y, arm.z);
    return glm::vec3(glm::dvec3(center) + turned);
}

}  // namespace cw2
