#include "cw2-bake/gltf/nodes.h"

#include <fmt/format.h>

#include <cstddef>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <string>

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

class Walk {
 public:
    Walk(const tinygltf::Model& model, GltfNodes& nodes) : model_(model), nodes_(nodes) {}

    /// Calls `visit` with the roots and all below them, parents before their children.
    template <typename Visit>
    void down_from(const std::vector<int>& roots, Visit&& visit) const {
        std::vector<int> stack(roots.rbegin(), roots.rend());
        while (!stack.empty()) {
            const int node = stack.back();
            stack.pop_back();
            if (!visit(node)) continue;
            const std::vector<int>& children = at(node).children;
            stack.insert(stack.end(), children.rbegin(), children.rend());
        }
    }

    void place_all() {
        parents_.assign(model_.nodes.size(), -1);
        for (std::size_t i = 0; i < model_.nodes.size(); ++i)
            for (const int child : model_.nodes[i].children)
                parents_[static_cast<std::size_t>(child)] = static_cast<int>(i);
        for (std::size_t i = 0; i < parents_.size(); ++i)
            if (parents_[i] < 0) roots_.push_back(static_cast<int>(i));
        nodes_.world_from_node.assign(model_.nodes.size(), glm::dmat4(1.0));
        down_from(roots_, [&](int node) {
            const int parent = parent_of(node);
            world_from(node) =
                (parent < 0 ? glm::dmat4(1.0) : world_from(parent)) * parent_from_node(at(node));
            return true;
        });
    }

    void show_scene(const std::string& name, const Warn& warn) {
        const int scene = model_.defaultScene;
        const auto& listed =
            scene < 0 ? roots_ : model_.scenes[static_cast<std::size_t>(scene)].nodes;
        std::vector<bool> is_shown(model_.nodes.size(), false);
        down_from(listed, [&](int node) {
            if (is_shown[static_cast<std::size_t>(node)]) return false;
            nodes_.shown.push_back(node);
            return static_cast<bool>(is_shown[static_cast<std::size_t>(node)] = true);
        });
        std::vector<bool> is_listed(model_.nodes.size(), false);
        std::size_t first = 0, odd = 0;
        for (std::size_t k = 0; k < listed.size(); ++k) {
            const auto node = static_cast<std::size_t>(listed[k]);
            if (parents_[node] < 0 && !is_listed[node]) {
                is_listed[node] = true;
            } else if (odd++ == 0) {
                first = k;
            }
        }
        if (odd == 0) return;
        warn(
            fmt::format("{}: /scenes/{}/nodes/{}: is a child of another node, or listed twice: "
                        "shown once, where its parents put it{}",
                        name, scene, first, odd > 1 ? fmt::format(" ({} such nodes)", odd) : ""));
    }

 private:
    const tinygltf::Node& at(int node) const {
        return model_.nodes[static_cast<std::size_t>(node)];
    }
    int parent_of(int node) const { return parents_[static_cast<std::size_t>(node)]; }
    glm::dmat4& world_from(int node) {
        return nodes_.world_from_node[static_cast<std::size_t>(node)];
    }

    const tinygltf::Model& model_;
    GltfNodes& nodes_;
    std::vector<int> parents_;  ///< -1: none
    std::vector<int> roots_;
};

}  // namespace

GltfNodes walk_nodes(const GltfFile& file, const Warn& warn) {
    GltfNodes nodes;
    Walk walk(file.model, nodes);
    walk.place_all();
    walk.show_scene(file.path.string(), warn);
    return nodes;
}

}  // namespace bake
