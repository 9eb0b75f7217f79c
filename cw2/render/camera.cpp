#include "cw2/render/camera.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace cw2 {

Bounds bounds_of(const mesh_format::SceneRecord& scene, std::span<const glm::vec3> vertices) {
    const glm::vec3 low = glm::make_vec3(scene.bounds_min);
    const glm::vec3 high = glm::make_vec3(scene.bounds_max);
    const glm::vec3 center(0.5 * (glm::dvec3(low) + glm::dvec3(high)));
    const glm::dvec3 origin = glm::make_vec3(scene.origin);
    if (scene.radius > 0.0f) return {center, scene.radius, vertices, origin};
    // A scene of one point still has a picture, from where floats tell camera and point apart.
    const auto distance = static_cast<float>(glm::length(glm::dvec3(center)));
    return {center, distance > 0.0f ? 1e-3f * distance : 1.0f, vertices, origin};
}

glm::vec3 from_user(const glm::dvec3& position, const Bounds& bounds) {
    return glm::vec3(position - bounds.origin);
}

glm::dvec3 to_user(const glm::vec3& position, const Bounds& bounds) {
    if (bounds.origin != glm::dvec3(0.0)) return bounds.origin + glm::dvec3(position);
    glm::dvec3 result;
    for (int axis = 0; axis < 3; ++axis) {
        std::array<char, 32> text;
        char* const end = std::to_chars(text.data(), text.data() + text.size(), position[axis]).ptr;
        std::from_chars(text.data(), end, result[axis]);
    }
    return result;
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

CameraAxes axes_of(const Camera& camera) {
    const glm::dvec3 back = glm::normalize(glm::dvec3(camera.position) - glm::dvec3(camera.target));
    const glm::dvec3 up =
        std::abs(back.y) < 0.9999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, -1.0);
    const glm::dvec3 right = glm::normalize(glm::cross(up, back));
    return {right, glm::cross(back, right), back};
}

Camera framed(std::span<const glm::vec3> vertices, const glm::vec3& target, const glm::dvec3& back,
              double nearest, float vertical_fov, float aspect) {
    constexpr double kInside = 0.95;
    const glm::dvec3 center(target);
    const CameraAxes axes = axes_of({glm::vec3(back), glm::vec3(0.0f), vertical_fov});
    const double high = kInside * std::tan(0.5 * double{vertical_fov});
    const double wide = high * double{aspect};
    // At distance d a point is in view where |x| <= wide (d - z), |y| <= high (d - z).
    using Range = tbb::blocked_range<std::size_t>;
    const double distance = tbb::parallel_reduce(
        Range(0, vertices.size(), 16'384), nearest,
        [&](const Range& range, double largest) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const glm::dvec3 arm = glm::dvec3(vertices[i]) - center;
                const double aside = std::max(std::abs(glm::dot(arm, axes.right)) / wide,
                                              std::abs(glm::dot(arm, axes.up)) / high);
                largest = std::max(largest, glm::dot(arm, axes.back) + std::max(aside, nearest));
            }
            return largest;
        },
        [](double a, double b) { return std::max(a, b); });
    return {glm::vec3(center + distance * axes.back), target, vertical_fov};
}

Camera default_camera(const Bounds& bounds, float vertical_fov, float aspect) {
    return framed(bounds.vertices, bounds.center, {1.0, 0.5, 1.0}, nearest_frame(bounds),
                  vertical_fov, aspect);
}

Camera around_target(const Camera& camera, double radians) {
    const double sine = std::sin(radians);
    const double cosine = std::cos(radians);
    const glm::dvec3 arm = glm::dvec3(camera.position) - glm::dvec3(camera.target);
    const glm::dvec3 turned(cosine * arm.x + sine * arm.z, arm.y, cosine * arm.z - sine * arm.x);
    return {glm::vec3(glm::dvec3(camera.target) + turned), camera.target, camera.vertical_fov};
}

glm::mat4 view_from_world(const Camera& camera) {
    const CameraAxes axes = axes_of(camera);
    const glm::dmat3 world_from_view(axes.right, axes.up, axes.back);
    glm::dmat4 view(glm::transpose(world_from_view));
    view[3] = glm::dvec4(-(glm::dvec3(camera.position) * world_from_view), 1.0);
    return glm::mat4(view);
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

double nearest_frame(const Bounds& bounds) {
    // Something to spare beyond the near plane.
    return 2.0 * double{near_distance(bounds)};
}

glm::vec3 default_light_position(const Bounds& bounds, const Camera& camera) {
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 direction =
        glm::normalize(0.75 * axes.back + 0.55 * axes.up - 0.45 * axes.right);
    return glm::vec3(glm::dvec3(bounds.center) + 4.0 * double{bounds.radius} * direction);
}

glm::vec3 orbit(const glm::vec3& start, const glm::vec3& center, double seconds, Axis axis) {
    const double sine = std::sin(seconds);
    const double cosine = std::cos(seconds);
    const int from = (static_cast<int>(axis) + 1) % 3;
    const int towards = (static_cast<int>(axis) + 2) % 3;
    const glm::dvec3 arm = glm::dvec3(start) - glm::dvec3(center);
    glm::dvec3 turned = arm;
    turned[from] = cosine * arm[from] - sine * arm[towards];
    turned[towards] = sine * arm[from] + cosine * arm[towards];
    return glm::vec3(glm::dvec3(center) + turned);
}

}  // namespace cw2
