#include "cw2-bake/gltf/read_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <string_view>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/gltf/file.h"
#include "cw2-bake/gltf/json.h"
#include "cw2-bake/gltf/light.h"
#include "cw2-bake/gltf/primitives.h"

namespace bake {
namespace {

glm::dmat4 parent_from_node(const tinygltf::Node& node) {
    if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
    glm::dmat4 matrix(1.0);
    if (node.translation.size() == 3)
        matrix[3] = glm::dvec4(glm::make_vec3(node.translation.data()), 1.0);
    if (node.rotation.size() == 4) {
        const auto& r = node.rotation;
        const glm::dquat rotation(r[3], r[0], r[1], r[2]);
        const double length = glm::length(rotation);
        if (length > 0.0) matrix *= glm::mat4_cast(rotation / length);
    }
    if (node.scale.size() == 3) {
        for (int axis = 0; axis < 3; ++axis)
            matrix[axis] *= node.scale[static_cast<std::size_t>(axis)];
    }
    return matrix;
}

std::vector<int> root_nodes(const tinygltf::Model& model) {
    if (model.defaultScene >= 0)
        return model.scenes[static_cast<std::size_t>(model.defaultScene)].nodes;
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
        for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
        if (!is_child[i]) roots.push_back(static_cast<int>(i));
    return roots;
}

/// Where a camera or light stands, before it is known how large the scene is.
struct Placed {
    glm::dmat4 world_from_node;
    int index;  ///< into the glTF's cameras or lights
};

/// What the nodes hold, in the order in which a walk down the hierarchy meets it.
struct Instances {
    std::vector<Placed> meshes, cameras, lights;
};

Instances walk(const tinygltf::Model& model) {
    struct Visit {
        int node;
        glm::dmat4 world_from_parent;
    };
    Instances found;
    std::vector<Visit> stack;
    const auto push = [&](const std::vector<int>& nodes, const glm::dmat4& world_from_parent) {
        for (auto node = nodes.rbegin(); node != nodes.rend(); ++node)
            stack.push_back({*node, world_from_parent});
    };
    push(root_nodes(model), glm::dmat4(1.0));
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(visit.node)];
        const glm::dmat4 matrix = visit.world_from_parent * parent_from_node(node);
        if (node.mesh >= 0) found.meshes.push_back({matrix, node.mesh});
        if (node.camera >= 0) found.cameras.push_back({matrix, node.camera});
        if (const auto light = node.extensions.find("KHR_lights_punctual");
            light != node.extensions.end()) {
            const int index = light->second.Get("light").GetNumberAsInt();
            if (index < static_cast<int>(model.lights.size()))
                found.lights.push_back({matrix, index});
        }
        push(node.children, matrix);
    }
    return found;
}

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
    return {0.5 * (glm::dvec3(low) + glm::dvec3(high)), 0.5 * glm::length(glm::dvec3(high - low))};
}

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void take_camera(const GltfFile& file, const std::vector<Placed>& cameras, const Box& box,
                 const Warn& warn, SourceScene& scene) {
    for (const Placed& placed : cameras) {
        const auto& camera = file.model.cameras[static_cast<std::size_t>(placed.index)];
        const std::string place = fmt::format("{}: /cameras/{}", file.path.string(), placed.index);
        const auto fov = static_cast<float>(camera.perspective.yfov);
        const glm::dvec3 position(placed.world_from_node[3]);
        const glm::dvec3 forward(-glm::dvec3(placed.world_from_node[2]));
        const glm::dvec3 up(placed.world_from_node[1]);
        if (camera.type != "perspective" || !(fov > 0.0f && fov < 3.1f) ||
            !(glm::length(forward) > 0.0)) {
            warn(place + ": is not in perspective, and left out");
            continue;
        }
        const glm::dvec3 sight = glm::normalize(forward);
        // Far enough that floats tell the two points apart.
        const double distance =
            std::max({glm::length(box.center - position), 0.01 * box.half_diagonal, 1e-3});
        scene.camera = {glm::vec3(position), glm::vec3(position + distance * sight), fov};
        if (!finite(scene.camera->position) || !finite(scene.camera->target) ||
            scene.camera->position == scene.camera->target) {
            scene.camera.reset();
            continue;
        }
        const glm::dvec3 right = glm::cross(sight, up);
        if (std::abs(right.y) > 1e-3 * glm::length(right))
            warn(place + ": is rolled; it will stand upright");
        return;
    }
}

void take_light(const GltfFile& file, const std::vector<Placed>& lights, const Box& box,
                const Warn& warn, SourceScene& scene) {
    std::size_t left_out = 0;
    for (const Placed& placed : lights) {
        const auto& light = file.model.lights[static_cast<std::size_t>(placed.index)];
        const glm::dvec3 position(placed.world_from_node[3]);
        const double distance = light_distance(position, box.center, box.half_diagonal);
        glm::vec3 color(static_cast<float>(light.intensity / (distance * distance)));
        for (int c = 0; c < 3 && light.color.size() == 3; ++c)
            color[c] *= static_cast<float>(light.color[static_cast<std::size_t>(c)]);
        const bool usable = light.type == "point" && finite(color) && finite(glm::vec3(position));
        if (usable && !scene.light) {
            scene.light = {glm::vec3(position), color};
        } else {
            ++left_out;
        }
    }
    if (left_out > 0) {
        warn(fmt::format("{}: lights beside the first point light are left out ({})",
                         file.path.string(), left_out));
    }
}

void warn_of_extensions(const GltfFile& file, const Warn& warn) {
    for (const std::string& name : file.model.extensionsUsed) {
        const bool says_nothing_of_looks = name.starts_with("KHR_xmp");
        if (is_known_extension(name) || says_nothing_of_looks) continue;
        warn(fmt::format("{}: the extension {} is not supported, and ignored", file.path.string(),
                         in_quotes(name)));
    }
}

void warn_of_left_out(const GltfFile& file, const Warn& warn) {
    const std::string name = file.path.string();
    if (!file.left_out.empty())
        warn(fmt::format("{}: is shown in its rest pose; left out: {}", name, file.left_out));
    const auto glows = [](const tinygltf::Material& material) {
        return std::ranges::any_of(material.emissiveFactor, [](double e) { return e > 0.0; });
    };
    if (std::ranges::any_of(file.model.materials, glows))
        warn(name + ": emissive materials do not glow");
    warn_of_extensions(file, warn);
}

}  // namespace

SourceScene read_gltf(const std::filesystem::path& path, const Warn& warn) {
    const GltfFile file = load_gltf(path);
    warn_of_left_out(file, warn);
    SourceScene scene;
    scene.files = file.buffer_files;
    scene.files.insert(scene.files.begin(), path);

    const Instances instances = walk(file.model);
    GltfPrimitives primitives(file, warn, scene);
    for (const Placed& mesh : instances.meshes) primitives.expect_mesh(mesh.index);
    for (const Placed& mesh : instances.meshes)
        primitives.add_mesh(mesh.index, mesh.world_from_node);
    primitives.warn_of_left_out();
    if (scene.corners.empty()) throw BakeError(path.string() + ": shows no triangles");

    const Box box = box_of(scene);
    take_camera(file, instances.cameras, box, warn, scene);
    take_light(file, instances.lights, box, warn, scene);
    return scene;
}

}  // namespace bake
