// Where the camera and the light are.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "mesh-format/layout.h"

namespace cw2 {

/// Where a scene lies: its origin in the user's coordinates, to which all else is relative, here
/// and wherever something is drawn; the centre of its bounding box, the largest distance from
/// there, and its vertices.
struct Bounds {
    glm::vec3 center;
    float radius;                         ///< scene units, positive
    std::span<const glm::vec3> vertices;  ///< of the scene that the bounds are of
    glm::dvec3 origin{0.0};
};

/// Between the user's coordinates and those relative to the origin. Without an origin a number
/// becomes the double with the fewest digits that is the same float: what people can read.
glm::vec3 from_user(const glm::dvec3& position, const Bounds& bounds);
glm::dvec3 to_user(const glm::vec3& position, const Bounds& bounds);
Bounds bounds_of(const mesh_format::SceneRecord& scene, std::span<const glm::vec3> vertices);

/// A right-handed camera, up +Y (unless it looks along Y).
struct Camera {
    glm::vec3 position;
    glm::vec3 target;
    float vertical_fov;  ///< radians, in (0, pi)
};

/// The directions of a picture's axes in the world, each of unit length.
struct CameraAxes {
    glm::dvec3 right;
    glm::dvec3 up;
    glm::dvec3 back;  ///< from the target to the camera
};
CameraAxes axes_of(const Camera& camera);

/// Looks at `target` against direction `back`, from as near as leaves every vertex in view, 5 % of
/// the way from the centre of the picture to its border free, and `nearest` between it and the
/// camera. `aspect` is width / height. Takes 2 ms for a million vertices.
Camera framed(std::span<const glm::vec3> vertices, const glm::vec3& target, const glm::dvec3& back,
              double nearest, float vertical_fov, float aspect);

/// Frames the scene, seen from direction (1, 0.5, 1).
Camera default_camera(const Bounds& bounds, float vertical_fov, float aspect);

/// What a scene says about how it wants to be seen.
struct SceneStart {
    std::optional<Camera> camera;             ///< relative to the scene's origin
    std::optional<glm::vec3> light_position;  ///< the same
    std::optional<glm::vec3> light_color;     ///< linear
};
SceneStart start_of(const mesh_format::SceneRecord& scene);

/// The camera after it has gone `radians` around the vertical through its target, x towards -z.
Camera around_target(const Camera& camera, double radians);

glm::mat4 view_from_world(const Camera& camera);

/// Vulkan's clip space (y down), depth 1 at distance `near`, 0 at infinity.
glm::mat4 clip_from_view(float vertical_fov, float aspect, float near);

/// The near plane for a scene of this size.
float near_distance(const Bounds& bounds);

/// From how near something of a scene of this size is framed.
double nearest_frame(const Bounds& bounds);

/// One point light without falloff, and the ambient light.
struct Light {
    glm::vec3 position;
    glm::vec3 color{1.0f};     ///< linear
    glm::vec3 ambient{0.02f};  ///< linear
};

/// Over the left shoulder of a camera: four radii from the centre, towards the camera, up and left
/// in its frame as 0.75, 0.55 and 0.45.
glm::vec3 default_light_position(const Bounds& bounds, const Camera& camera);

/// An axis of the world.
enum class Axis { x, y, z };

/// Where the light's orbit has taken `start` after `seconds`: about the line through `center`
/// parallel to the axis, right-handed (about z: x towards y), 1 rad/s.
glm::vec3 orbit(const glm::vec3& start, const glm::vec3& center, double seconds,
                Axis axis = Axis::z);

}  // namespace cw2
