// The triangles of glTF's primitives, collected into a scene.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/gltf/accessors.h"
#include "cw2-bake/gltf/materials.h"
#include "cw2-bake/gltf/nodes.h"

namespace bake {

/// A primitive mode's triangles over `indices`, in the order and winding that the glTF
/// specification gives them (section 3.7.2.1); those with two equal indices are left out.
std::vector<std::array<std::uint32_t, 3>> triangles_of(int mode,
                                                       std::span<const std::uint32_t> indices);

class GltfPrimitives {
 public:
    /// All must outlive this.
    GltfPrimitives(const GltfFile& file, const GltfNodes& nodes, const Warn& warn,
                   SourceScene& scene);

    /// To be called for each node that will be added, before any is and in their order: throws
    /// BakeError where they are so many that a small file would claim all memory, or all day.
    void expect_node(int node);

    /// Adds the triangles of the node's mesh, if it has one, as its skin or else its place in the
    /// world and the weights of its morph targets have them. Throws BakeError.
    void add_node(int node);

    /// Of what was left out, once for the file.
    void warn_of_left_out() const;

 private:
    struct Arrays;
    class Adder;
    struct Material {
        GltfMaterial of;
        std::uint32_t index;  ///< in the scene
    };
    const Material& material(int index);
    const std::vector<glm::dmat4>& joints(int skin);
    Arrays read_arrays(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
                       const Material& material, const std::string& place);
    std::vector<std::uint32_t> read_indices(const tinygltf::Primitive& primitive,
                                            std::size_t vertices, const std::string& place);
    std::size_t values_of(int index) const;
    void expect_values(const tinygltf::Node& node, const tinygltf::Primitive& primitive);
    void add_primitive(int node, const tinygltf::Primitive& primitive, const std::string& place);

    const GltfFile& file_;
    const GltfNodes& nodes_;
    const Warn& warn_;
    SourceScene& scene_;
    GltfAccessors accessors_;
    GltfMaterials converter_;
    std::map<int, Material> materials_;              ///< by index in the glTF
    std::map<int, std::vector<glm::dmat4>> joints_;  ///< by skin
    std::vector<std::uint32_t>
        new_index_;  ///< of the vertices of the primitive at hand; else kUnused
    std::size_t corners_ = 0;
    std::set<int> read_last_;  ///< accessors that the primitive before keeps
    std::set<int> skins_;      ///< that were expected
    std::size_t most_values_;  ///< to be read
    std::size_t values_ = 0;
    std::size_t most_corners_;
    std::size_t points_or_lines_ = 0;
    std::string first_points_or_lines_;
    std::size_t without_uvs_ = 0;
    std::string first_without_uvs_;
    bool some_without_normals_ = false;
};

}  // namespace bake
