// Skins and morph targets: the pose in which a glTF is at load.
#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <string>
#include <vector>

#include "cw2-bake/gltf/accessors.h"
#include "cw2-bake/gltf/nodes.h"

namespace bake {

/// World from skinned vertex, one matrix a joint (glTF 2.0, 3.7.3): where the joint stands, times
/// its inverse bind matrix.
std::vector<glm::dmat4> joint_matrices(const GltfFile& file, const GltfNodes& nodes,
                                       GltfAccessors& accessors, int skin);

/// The matrices of a primitive's vertices, blended from those of the joints.
class GltfSkin {
 public:
    /// Of a node that has a skin and a primitive with joints; those must outlive this.
    GltfSkin(const GltfFile& file, const std::vector<glm::dmat4>& matrices,
             const tinygltf::Primitive& primitive, GltfAccessors& accessors, std::size_t count);

    /// Whether the primitive says to which joints its vertices belong.
    static bool has_joints(const tinygltf::Primitive& primitive);

    /// Weights are brought to a sum of 1; a vertex that has none follows its first joint. Throws
    /// BakeError where it names a joint that there is not.
    glm::dmat4 world_from_vertex(std::size_t vertex) const;

 private:
    /// Four joints a vertex: JOINTS_n and WEIGHTS_n.
    struct Set {
        int joints_accessor;
        std::vector<float> joints, weights;
    };
    const glm::dmat4& matrix(const Set& set, std::size_t at) const;

    const GltfFile& file_;
    const std::vector<glm::dmat4>& matrices_;
    std::vector<Set> sets_;
};

/// The weights of a primitive's morph targets: the node's, else the mesh's, else 0.
std::vector<double> morph_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                                  const tinygltf::Primitive& primitive);

/// Adds to `values`, `components` a vertex, what the targets move of the attribute (glTF 2.0,
/// 3.7.2.2). A tangent has 4 components, of which 3 move.
void add_morph_targets(const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                       const std::string& attribute, int components, GltfAccessors& accessors,
                       std::vector<float>& values);

/// Whether a target that has a weight moves the attribute.
bool is_morphed(const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                const std::string& attribute);

}  // namespace bake
