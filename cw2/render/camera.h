// Where the camera and the light are.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "mesh-format/layout.h"

namespace cw2 {

/// The sphere around a scene: the centre of its bounding box, and the largest distance from there.
struct Bounds {
    glm::vec3 center;
    float radius;  ///< scene units, positive
};
Bounds bounds_of(const mesh_format::SceneRecord& scene);

/// A right-handed camera, up +Y (unless it looks along Y).
struct Camera {
    glm::vec3 position;
    glm::vec3 target;
    float vertical_fov;  ///< radians, in (0, pi)
};

/// The whole bounding sphere in view, seen from direction (1, 0.5, 1). `aspect` is width / height.
Camera default_camera(const Bounds& bounds, float vertical_fov, float aspect);

/// What a scene says about how it wants to be seen.
struct SceneStart {
    std::optional<Camera> camera;
    std::optional<glm::vec3> light_position;
    std::optional<glm::vec3> light_color;  ///< linear
};
SceneStart start_of(const mesh_format::SceneRecord& scene);

/// The camera after it has gone `radians` around the vertical through its target, x towards -z.
Camera around_target(const Camera& camera, double radians);

glm::mat4 view_from_world(const Camera& camera);

/// Vulkan's clip space (y down), depth 1 at distance `near`, 0 at infinity.
glm::mat4 clip_from_view(float vertical_fov, float aspect, float near);

/// The near plane for a scene of this size.
float near_distance(const Bounds& bounds);

/// One point light without falloff, and the ambient light.
struct Light {
    glm::vec3 position;
    glm::vec3 color{1.0f};     ///< linear
    glm::vec3 ambient{0.02f};  ///< linear
};

/// The bounding sphere's centre + (0.5, 0.8, 0.6) radii.
glm::vec3 default_light_position(const Bounds& bounds);

/// Where the light's orbit has taken `start` after `seconds`: about the axis through `center`
/// parallel to z, x towards y, 1 rad/s.
glm::vec3 orbit(const glm::vec3& start, const glm::vec3& center, double seconds);

}  // namespace cw2
