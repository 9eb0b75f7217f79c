#include "cw2-bake/gltf/pose.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "cw2-bake/gltf/json.h"

namespace bake {
namespace {

constexpr std::size_t kJointsPerSet = 4;

int attribute_of(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

std::vector<float> floats_of(GltfAccessors& accessors, int accessor, int components,
                             std::size_t count) {
    std::vector<float> floats = accessors.take_floats(accessor, components);
    if (floats.size() != count * static_cast<std::size_t>(components))
        accessors.fail(accessor, "differs in count from the accessor of the positions");
    return floats;
}

}  // namespace

std::vector<glm::dmat4> joint_matrices(const GltfFile& file, const GltfNodes& nodes,
                                       GltfAccessors& accessors, int skin_index) {
    const auto& skin = file.model.skins[static_cast<std::size_t>(skin_index)];
    std::vector<float> inverse_binds;
    if (skin.inverseBindMatrices >= 0) {
        inverse_binds = accessors.take_floats(skin.inverseBindMatrices, 16);
        if (inverse_binds.size() < 16 * skin.joints.size()) {
            fail_at(file.path, fmt::format("/skins/{}/inverseBindMatrices", skin_index),
                    fmt::format("gives {} matrices for {} joints", inverse_binds.size() / 16,
                                skin.joints.size()));
        }
    }
    std::vector<glm::dmat4> matrices;
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        glm::dmat4 matrix = nodes.world_from_node[static_cast<std::size_t>(skin.joints[i])];
        if (!inverse_binds.empty()) {
            matrix *= glm::dmat4(glm::make_mat4(inverse_binds.data() + 16 * i));
        }
        matrices.push_back(matrix);
    }
    return matrices;
}

bool GltfSkin::has_joints(const tinygltf::Primitive& primitive) {
    return attribute_of(primitive, "JOINTS_0") >= 0 && attribute_of(primitive, "WEIGHTS_0") >= 0;
}

GltfSkin::GltfSkin(const GltfFile& file, const std::vector<glm::dmat4>& matrices,
                   const tinygltf::Primitive& primitive, GltfAccessors& accessors,
                   std::size_t count)
    : file_(file), matrices_(matrices) {
    for (int n = 0;; ++n) {
        const int joints = attribute_of(primitive, fmt::format("JOINTS_{}", n));
        const int weights = attribute_of(primitive, fmt::format("WEIGHTS_{}", n));
        if (joints < 0 || weights < 0) return;
        sets_.push_back({joints, floats_of(accessors, joints, kJointsPerSet, count),
                         floats_of(accessors, weights, kJointsPerSet, count)});
    }
}

const glm::dmat4& GltfSkin::matrix(const Set& set, std::size_t at) const {
    const float joint = set.joints[at];
    // Also where it is no whole number: a file may hold joints as floats.
    if (!(joint >= 0.0f && joint < static_cast<float>(matrices_.size()))) {
        fail_at(file_.path, fmt::format("/accessors/{}", set.joints_accessor),
                fmt::format("element {} names joint {} of {}", at / kJointsPerSet, joint,
                            matrices_.size()));
    }
    return matrices_[static_cast<std::size_t>(joint)];
}

glm::dmat4 GltfSkin::world_from_vertex(std::size_t vertex) const {
    glm::dmat4 blended(0.0);
    double sum = 0.0;
    for (const Set& set : sets_) {
        for (std::size_t at = kJointsPerSet * vertex; at < kJointsPerSet * (vertex + 1); ++at) {
            const double weight = set.weights[at];
            if (weight == 0.0) continue;
            blended += weight * matrix(set, at);
            sum += weight;
        }
    }
    if (sum > 0.0) return blended / sum;
    return matrix(sets_.front(), kJointsPerSet * vertex);
}

std::vector<double> morph_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                                  const tinygltf::Primitive& primitive) {
    std::vector<double> weights = node.weights.empty() ? mesh.weights : node.weights;
    weights.resize(primitive.targets.size(), 0.0);
    return weights;
}

bool is_morphed(const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                const std::string& attribute) {
    for (std::size_t t = 0; t < weights.size(); ++t)
        if (weights[t] != 0.0 && primitive.targets[t].contains(attribute)) return true;
    return false;
}

void add_morph_targets(const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                       const std::string& attribute, int components, GltfAccessors& accessors,
                       std::vector<float>& values) {
    const auto stride = static_cast<std::size_t>(components);
    const int moved = attribute == "TANGENT" ? 3 : components;
    for (std::size_t t = 0; t < weights.size(); ++t) {
        const auto target = primitive.targets[t].find(attribute);
        if (weights[t] == 0.0 || target == primitive.targets[t].end()) continue;
        const std::vector<float> deltas =
            floats_of(accessors, target->second, moved, values.size() / stride);
        for (std::size_t i = 0; i < deltas.size(); ++i) {
            const std::size_t at =
                i / static_cast<std::size_t>(moved) * stride + i % static_cast<std::size_t>(moved);
            values[at] = static_cast<float>(values[at] + weights[t] * deltas[i]);
            if (!std::isfinite(values[at])) {
                accessors.fail(
                    target->second,
                    fmt::format("element {} times its weight is beyond the range of floats",
                                i / static_cast<std::size_t>(moved)));
            }
        }
    }
}

}  // namespace bake
