#include "cw2-bake/gltf/start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <string>

#include "cw2-bake/gltf/light.h"

namespace bake {
namespace {

struct Box {
    glm::dvec3 center{0.0};
    double half_diagonal = 0.0;
};

Box box_of(const SourceScene& scene) {
    glm::vec3 low(scene.positions.front()), high(low);
    for (const glm::vec3& position : scene.positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    const glm::dvec3 diagonal = glm::dvec3(high) - glm::dvec3(low);
    return {0.5 * (glm::dvec3(low) + glm::dvec3(high)), 0.5 * glm::length(diagonal)};
}

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Nothing where the node takes the camera out of the range of floats.
std::optional<SourceCamera> camera_at(const glm::dmat4& world_from_node, float fov,
                                      const Box& box) {
    const glm::dvec3 position(world_from_node[3]);
    const glm::dvec3 sight = glm::normalize(-glm::dvec3(world_from_node[2]));
    // Far enough that floats tell the two points apart.
    const double distance = std::max(glm::length(box.center - position), 0.01 * box.half_diagonal);
    const SourceCamera camera{glm::vec3(position), glm::vec3(position + distance * sight), fov};
    const bool usable =
        finite(camera.position) && finite(camera.target) && camera.position != camera.target;
    return usable ? std::optional(camera) : std::nullopt;
}

void take_camera(const GltfFile& file, const GltfNodes& nodes, const Box& box, const Warn& warn,
                 SourceScene& scene) {
    for (const int shown : nodes.shown) {
        const auto node = static_cast<std::size_t>(shown);
        const int index = file.model.nodes[node].camera;
        if (index < 0) continue;
        const glm::dmat4& world_from_node = nodes.world_from_node[node];
        const auto& camera = file.model.cameras[static_cast<std::size_t>(index)];
        const std::string place = fmt::format("{}: /cameras/{}", file.path.string(), index);
        const auto fov = static_cast<float>(camera.perspective.yfov);
        if (camera.type != "perspective" || !(fov > 0.0f && fov < 3.1f) ||
            !(glm::length(glm::dvec3(world_from_node[2])) > 0.0)) {
            warn(place + ": is not in perspective, and left out");
            continue;
        }
        scene.camera = camera_at(world_from_node, fov, box);
        if (!scene.camera) continue;
        const glm::dvec3 right =
            glm::cross(-glm::dvec3(world_from_node[2]), glm::dvec3(world_from_node[1]));
        if (std::abs(right.y) > 1e-3 * glm::length(right))
            warn(place + ": is rolled; it will stand upright");
        return;
    }
}

/// How many half diagonals of the scene's box a directional light is away: what it lights differs
/// in direction by at most 0.06 degrees from one end to the other.
constexpr double kFarAway = 1000.0;

/// Nothing where it cannot be had in floats, or is of no kind that there is.
std::optional<SourceLight> light_at(const glm::dmat4& world_from_node, const tinygltf::Light& light,
                                    const Box& box) {
    glm::dvec3 position(world_from_node[3]);
    double brightness = light.intensity;
    if (light.type == "directional") {
        const glm::dvec3 backward(world_from_node[2]);
        position =
            box.center + kFarAway * std::max(box.half_diagonal, 1e-30) * glm::normalize(backward);
    } else if (light.type == "point" || light.type == "spot") {
        const double distance = light_distance(position, box.center, box.half_diagonal);
        brightness /= distance * distance;
    } else {
        return std::nullopt;
    }
    glm::vec3 color(static_cast<float>(brightness));
    for (int c = 0; c < 3 && light.color.size() == 3; ++c)
        color[c] *= static_cast<float>(light.color[static_cast<std::size_t>(c)]);
    const SourceLight result{glm::vec3(position), color};
    return finite(color) && finite(result.position) ? std::optional(result) : std::nullopt;
}

void warn_of_kind(const std::string& place, const std::string& type, const Warn& warn) {
    if (type == "directional") {
        warn(
            fmt::format("{}: is directional: becomes a point light {} half diagonals of the scene "
                        "away",
                        place, kFarAway));
    } else if (type == "spot") {
        warn(place + ": is a spot light: becomes a point light that shines all around");
    }
}

void take_light(const GltfFile& file, const GltfNodes& nodes, const Box& box, const Warn& warn,
                SourceScene& scene) {
    std::size_t left_out = 0;
    std::string first_left_out;
    for (const int shown : nodes.shown) {
        const auto node = static_cast<std::size_t>(shown);
        const auto& extensions = file.model.nodes[node].extensions;
        const auto extension = extensions.find("KHR_lights_punctual");
        if (extension == extensions.end()) continue;
        const auto index =
            static_cast<std::size_t>(extension->second.Get("light").GetNumberAsInt());
        if (index >= file.model.lights.size()) continue;
        const auto& light = file.model.lights[index];
        const std::string place =
            fmt::format("{}: /extensions/KHR_lights_punctual/lights/{}", file.path.string(), index);
        if (!scene.light) {
            scene.light = light_at(nodes.world_from_node[node], light, box);
            if (scene.light) {
                warn_of_kind(place, light.type, warn);
                continue;
            }
        }
        if (left_out++ == 0) first_left_out = place;
    }
    if (left_out > 0) {
        warn(fmt::format("{}: is left out, for one light is used, the first ({} left out in all)",
                         first_left_out, left_out));
    }
}

}  // namespace

void take_camera_and_light(const GltfFile& file, const GltfNodes& nodes, const Warn& warn,
                           SourceScene& scene) {
    const Box box = box_of(scene);
    take_camera(file, nodes, box, warn, scene);
    take_light(file, nodes, box, warn, scene);
}

}  // namespace bake
