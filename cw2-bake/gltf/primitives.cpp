#include "cw2-bake/gltf/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <list>
#include <new>
#include <optional>
#include <utility>

#include "cw2-bake/gltf/json.h"
#include "cw2-bake/gltf/pose.h"
#include "cw2-bake/textures/srgb.h"

namespace bake {
namespace {

/// No -0, so that equality of bits is equality of values.
template <typename Vector>
Vector stored(const Vector& v) {
    return v + 0.0f;
}

/// Of length 1; zero where the vector has no direction.
glm::vec3 stored_direction(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? stored(glm::vec3(v / length)) : glm::vec3(0.0f);
}

/// Takes directions of a surface along, up to a positive factor: cofactors instead of an inverse
/// also serve where a scale is 0.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
    const double sign = glm::determinant(m) < 0.0 ? -1.0 : 1.0;
    return sign *
           glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
}

constexpr std::uint32_t kUnused = 0xFFFF'FFFF;

/// What takes positions, normals and tangents into the world.
struct Placement {
    explicit Placement(const glm::dmat4& matrix)
        : world_from_mesh(matrix),
          of_normals(normal_matrix(glm::dmat3(matrix))),
          mirrored(glm::determinant(glm::dmat3(matrix)) < 0.0) {}

    glm::dmat4 world_from_mesh;
    glm::dmat3 of_normals;
    bool mirrored;
};

int attribute_of(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangles_of(int mode,
                                                       std::span<const std::uint32_t> indices) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        const std::array t{indices[a], indices[b], indices[c]};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    };
    const std::size_t count = indices.size();
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        triangles.reserve(count / 3);
        for (std::size_t i = 0; i + 2 < count; i += 3) add(i, i + 1, i + 2);
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (std::size_t i = 0; i + 2 < count; ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);
    } else {
        for (std::size_t i = 1; i + 1 < count; ++i) add(i, i + 1, 0);
    }
    return triangles;
}

/// A primitive's vertices as the file has them, morph targets added; null where it has no such
/// attribute.
struct GltfPrimitives::Arrays {
    std::size_t count = 0;
    const std::vector<float>* positions = nullptr;
    const std::vector<float>* normals = nullptr;
    const std::vector<float>* tangents = nullptr;
    const std::vector<float>* uvs = nullptr;
    const std::vector<float>* colors = nullptr;
    std::size_t color_components = 4;
    std::optional<GltfSkin> skin{};

    std::list<std::vector<float>> morphed{};  ///< what some of the pointers point to

    static glm::dvec3 at3(const std::vector<float>& values, std::size_t i, std::size_t stride = 3) {
        return {values[stride * i], values[stride * i + 1], values[stride * i + 2]};
    }
};

/// Adds the vertices of a primitive to the scene, each when it is first asked for.
class GltfPrimitives::Adder {
 public:
    Adder(GltfPrimitives& primitives, const Arrays& arrays, const Material& material,
          const std::string& place, const glm::dmat4& world_from_mesh)
        : file_(primitives.file_),
          scene_(primitives.scene_),
          new_index_(primitives.new_index_),
          arrays_(arrays),
          material_(material),
          place_(place),
          node_(world_from_mesh),
          first_(static_cast<std::uint32_t>(scene_.positions.size())) {
        if (new_index_.size() < arrays.count) new_index_.resize(arrays.count, kUnused);
    }

    /// Its index in the scene.
    std::uint32_t vertex(std::uint32_t i) {
        if (new_index_[i] == kUnused) {
            new_index_[i] = static_cast<std::uint32_t>(scene_.positions.size());
            if (arrays_.skin) {
                add(i, Placement(arrays_.skin->world_from_vertex(i)));
            } else {
                add(i, node_);
            }
        }
        return new_index_[i];
    }

    /// Whether the vertex of this index in the scene was taken into the world by a reflection.
    bool is_mirrored(std::uint32_t v) const {
        return arrays_.skin ? mirrored_[v - first_] : node_.mirrored;
    }
    const glm::vec4& tangent(std::uint32_t v) const { return tangents_[v - first_]; }
    std::uint32_t color(std::uint32_t v) const { return colors_[v - first_]; }

 private:
    void add(std::uint32_t i, const Placement& placement) {
        const glm::dvec4 point(Arrays::at3(*arrays_.positions, i), 1.0);
        const glm::vec3 position(glm::dvec3(placement.world_from_mesh * point));
        if (!std::isfinite(position.x + position.y + position.z))
            fail_at(file_.path, place_, "its node takes it out of the range of floats");
        scene_.positions.push_back(stored(position));
        const glm::vec3 normal =
            arrays_.normals
                ? stored_direction(placement.of_normals * Arrays::at3(*arrays_.normals, i))
                : glm::vec3(0.0f);
        scene_.normals.push_back(normal);
        scene_.uvs.push_back(uv(i));
        if (arrays_.tangents) {
            const glm::vec3 t = stored_direction(glm::dmat3(placement.world_from_mesh) *
                                                 Arrays::at3(*arrays_.tangents, i, 4));
            const bool usable = glm::length(glm::cross(t, normal)) > 1e-3f;
            const float w = (*arrays_.tangents)[4 * i + 3] < 0.0f ? -1.0f : 1.0f;
            tangents_.push_back(usable ? glm::vec4(t, placement.mirrored ? -w : w)
                                       : glm::vec4(0.0f));
        }
        if (arrays_.colors) colors_.push_back(color_of(i));
        if (arrays_.skin) mirrored_.push_back(placement.mirrored);
    }

    /// As SourceScene::colors has it; the file's is linear.
    std::uint32_t color_of(std::uint32_t i) const {
        const float* const color = arrays_.colors->data() + arrays_.color_components * i;
        std::uint32_t packed = 0;
        for (int channel = 2; channel >= 0; --channel)
            packed = packed << 8 | srgb().to_srgb8(color[channel]);
        const float alpha = arrays_.color_components == 4 ? std::clamp(color[3], 0.0f, 1.0f) : 1.0f;
        return packed | static_cast<std::uint32_t>(std::lround(255.0f * alpha)) << 24;
    }

    glm::vec2 uv(std::uint32_t i) const {
        glm::dvec2 uv(0.0);
        if (arrays_.uvs) {
            uv =
                material_.of.uv_transform.apply({(*arrays_.uvs)[2 * i], (*arrays_.uvs)[2 * i + 1]});
        }
        const glm::vec2 upward(uv.x, 1.0f - static_cast<float>(uv.y));
        if (!std::isfinite(upward.x + upward.y))
            fail_at(file_.path, place_,
                    "its texture's transform takes it out of the range of floats");
        return stored(upward);
    }

    const GltfFile& file_;
    SourceScene& scene_;
    std::vector<std::uint32_t>& new_index_;
    const Arrays& arrays_;
    const Material& material_;
    const std::string& place_;
    const Placement node_;
    const std::uint32_t first_;
    std::vector<glm::vec4> tangents_;  ///< of the new vertices
    std::vector<std::uint32_t> colors_;
    std::vector<bool> mirrored_;  ///< of those of a skin
};

GltfPrimitives::GltfPrimitives(const GltfFile& file, const GltfNodes& nodes, const Warn& warn,
                               SourceScene& scene)
    : file_(file),
      nodes_(nodes),
      warn_(warn),
      scene_(scene),
      accessors_(file, warn),
      converter_(file, warn) {
    // Nodes may show a mesh again and again, and accessors share their bytes; a small file must not
    // claim all memory, or all day.
    constexpr std::size_t kAlways = std::size_t{1} << 24, kCornersPerByte = 64;
    constexpr std::size_t kValuesAlways = std::size_t{1} << 28, kValuesPerByte = 16;
    most_corners_ = std::clamp(kCornersPerByte * file.size, kAlways, std::size_t{kAbsent} - 1);
    most_values_ = std::max(kValuesPerByte * file.size, kValuesAlways);
}

const GltfPrimitives::Material& GltfPrimitives::material(int index) {
    const auto [entry, fresh] = materials_.try_emplace(index);
    if (fresh) {
        entry->second = {converter_.convert(index),
                         static_cast<std::uint32_t>(scene_.materials.size())};
        if (entry->second.of.visible) scene_.materials.push_back(entry->second.of.source);
    }
    return entry->second;
}

const std::vector<glm::dmat4>& GltfPrimitives::joints(int skin) {
    const auto [entry, fresh] = joints_.try_emplace(skin);
    if (fresh) entry->second = joint_matrices(file_, nodes_, accessors_, skin);
    return entry->second;
}

/// As many numbers as reading it reads; where it claims more than there are, reading it fails.
std::size_t GltfPrimitives::values_of(int index) const {
    const auto& accessor = file_.model.accessors[static_cast<std::size_t>(index)];
    const auto& views = file_.model.bufferViews;
    const std::size_t most = accessor.bufferView < 0
                                 ? GltfAccessors::kMostZeros
                                 : views[static_cast<std::size_t>(accessor.bufferView)].byteLength;
    std::size_t elements = std::min(accessor.count, most);
    if (accessor.sparse.isSparse) elements += static_cast<std::size_t>(accessor.sparse.count);
    return elements * static_cast<std::size_t>(accessors_.components(index));
}

/// Counts what read_arrays() and read_indices() may read: of the attributes what the primitive
/// before did not read, but joints and weights always.
void GltfPrimitives::expect_values(const tinygltf::Node& node,
                                   const tinygltf::Primitive& primitive) {
    std::set<int> read;
    for (const auto& [name, accessor] : primitive.attributes) {
        const bool is_of_skin = name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
        if (is_of_skin ? node.skin >= 0
                       : read.insert(accessor).second && !read_last_.contains(accessor))
            values_ += values_of(accessor);
    }
    read_last_ = std::move(read);
    for (const auto& target : primitive.targets)
        for (const auto& [name, accessor] : target) values_ += values_of(accessor);
    if (primitive.indices >= 0) values_ += values_of(primitive.indices);
    if (node.skin < 0 || !skins_.insert(node.skin).second) return;
    const int matrices = file_.model.skins[static_cast<std::size_t>(node.skin)].inverseBindMatrices;
    if (matrices >= 0) values_ += values_of(matrices);
}

void GltfPrimitives::expect_node(int node_index) {
    const auto& node = file_.model.nodes[static_cast<std::size_t>(node_index)];
    if (node.mesh < 0) return;
    for (const auto& primitive :
         file_.model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
        const int positions = attribute_of(primitive, "POSITION");
        if (positions < 0) continue;
        expect_values(node, primitive);
        const int counted = primitive.indices >= 0 ? primitive.indices : positions;
        const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
        corners_ += accessors_.count(counted) * (is_list ? 1 : 3);
    }
    if (values_ > most_values_) {
        fail_at(file_.path, fmt::format("/meshes/{}", node.mesh),
                fmt::format("its morph targets are so many, or its nodes take turns with others so "
                            "often, that more than {} numbers would be read",
                            most_values_));
    }
    if (corners_ > most_corners_) {
        fail_at(file_.path, fmt::format("/meshes/{}", node.mesh),
                fmt::format("its nodes give the scene more than {} corners, implausible for the "
                            "file's bytes",
                            most_corners_));
    }
}

GltfPrimitives::Arrays GltfPrimitives::read_arrays(const tinygltf::Node& node,
                                                   const tinygltf::Primitive& primitive,
                                                   const Material& material,
                                                   const std::string& place) {
    const std::string uv_name = fmt::format("TEXCOORD_{}", material.of.uv_set);
    const int positions = attribute_of(primitive, "POSITION");
    const int normals = attribute_of(primitive, "NORMAL");
    const int tangents = normals < 0 ? -1 : attribute_of(primitive, "TANGENT");
    const int uvs = attribute_of(primitive, uv_name);
    const int colors = attribute_of(primitive, "COLOR_0");
    accessors_.keep_only(std::array{positions, normals, tangents, uvs, colors});
    const std::vector<double> weights =
        morph_weights(node, file_.model.meshes[static_cast<std::size_t>(node.mesh)], primitive);

    Arrays arrays;
    arrays.count = accessors_.count(positions);
    const auto read = [&](int accessor, const std::string& name,
                          int components) -> const std::vector<float>* {
        if (accessor < 0) return nullptr;
        if (accessors_.count(accessor) != arrays.count)
            fail_at(file_.path, place + "/attributes", "its accessors differ in count");
        const auto& floats = name == "POSITION" ? accessors_.floats(accessor, components)
                                                : accessors_.optional_floats(accessor, components);
        if (!is_morphed(primitive, weights, name)) return &floats;
        auto& morphed = arrays.morphed.emplace_back(floats);
        add_morph_targets(primitive, weights, name, components, accessors_, morphed);
        return &morphed;
    };
    arrays.positions = read(positions, "POSITION", 3);
    arrays.normals = read(normals, "NORMAL", 3);
    arrays.tangents = read(tangents, "TANGENT", 4);
    arrays.uvs = read(uvs, uv_name, 2);
    if (colors >= 0) {
        arrays.color_components = accessors_.components(colors) == 3 ? 3 : 4;
        arrays.colors = read(colors, "COLOR_0", static_cast<int>(arrays.color_components));
    }
    const auto& maps = material.of.source.maps.values;
    if (uvs < 0 && std::ranges::any_of(maps, [](const auto& map) { return map.has_value(); }) &&
        without_uvs_++ == 0) {
        first_without_uvs_ =
            fmt::format("{}: has no {}, which its textures ask for", place, uv_name);
    }
    if (node.skin >= 0 && GltfSkin::has_joints(primitive))
        arrays.skin.emplace(file_, joints(node.skin), primitive, accessors_, arrays.count);
    return arrays;
}

std::vector<std::uint32_t> GltfPrimitives::read_indices(const tinygltf::Primitive& primitive,
                                                        std::size_t vertices,
                                                        const std::string& place) {
    std::vector<std::uint32_t> indices;
    if (primitive.indices < 0) {
        indices.resize(vertices);
        for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
        return indices;
    }
    indices = accessors_.indices(primitive.indices);
    for (const std::uint32_t index : indices) {
        if (index >= vertices)
            fail_at(file_.path, place + "/indices",
                    fmt::format("refers to vertex {} of {}", index, vertices));
    }
    return indices;
}

void GltfPrimitives::add_primitive(int node_index, const tinygltf::Primitive& primitive,
                                   const std::string& place) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) fail_at(file_.path, place + "/mode", "is no mode");
    if (mode < TINYGLTF_MODE_TRIANGLES) {
        if (points_or_lines_++ == 0) first_points_or_lines_ = place;
        return;
    }
    if (attribute_of(primitive, "POSITION") < 0) return;  // allowed, and nothing to see
    const Material& material = this->material(primitive.material);
    if (!material.of.visible) return;
    const auto node = static_cast<std::size_t>(node_index);
    const Arrays arrays = read_arrays(file_.model.nodes[node], primitive, material, place);
    const std::vector<std::uint32_t> indices = read_indices(primitive, arrays.count, place);

    Adder adder(*this, arrays, material, place, nodes_.world_from_node[node]);
    constexpr std::uint32_t kWhite = 0xFFFF'FFFF;
    if (arrays.tangents) scene_.tangents.resize(scene_.corners.size(), glm::vec4(0.0f));
    if (arrays.colors) scene_.colors.resize(scene_.corners.size(), kWhite);
    for (const auto& triangle : triangles_of(mode, indices)) {
        const bool mirrored = adder.is_mirrored(adder.vertex(triangle[0]));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = adder.vertex(triangle[mirrored && k > 0 ? 3 - k : k]);
            const bool has_normal = scene_.normals[v] != glm::vec3(0.0f);
            some_without_normals_ |= !has_normal;
            scene_.corners.push_back({.position = v, .normal = has_normal ? v : kAbsent, .uv = v});
            if (arrays.tangents) scene_.tangents.push_back(adder.tangent(v));
            if (arrays.colors) scene_.colors.push_back(adder.color(v));
        }
        scene_.triangle_material.push_back(material.index);
    }
    // Only what was used: a few triangles of a long accessor may be shown again and again.
    for (const std::uint32_t i : indices) new_index_[i] = kUnused;
    if (!scene_.tangents.empty()) scene_.tangents.resize(scene_.corners.size(), glm::vec4(0.0f));
    if (!scene_.colors.empty()) scene_.colors.resize(scene_.corners.size(), kWhite);
    if (some_without_normals_) {
        scene_.smoothing_group.extend(scene_.triangle_material.size(), 0);
        scene_.without_normals = {{0, scene_.triangle_material.size()}};
    }
}

void GltfPrimitives::add_node(int node) {
    const int mesh = file_.model.nodes[static_cast<std::size_t>(node)].mesh;
    if (mesh < 0) return;
    const auto& primitives = file_.model.meshes[static_cast<std::size_t>(mesh)].primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const std::string place = fmt::format("/meshes/{}/primitives/{}", mesh, i);
        try {
            add_primitive(node, primitives[i], place);
        } catch (const std::bad_alloc&) {
            fail_at(file_.path, place, "there is not enough memory to read it");
        }
    }
}

void GltfPrimitives::warn_of_left_out() const {
    const std::string name = file_.path.string();
    if (points_or_lines_ > 0) {
        warn_(fmt::format("{}: {}: points and lines are left out ({} primitives)", name,
                          first_points_or_lines_, points_or_lines_));
    }
    converter_.warn_of_left_out();
    if (without_uvs_ > 0)
        warn_(fmt::format("{}: {} ({} primitives)", name, first_without_uvs_, without_uvs_));
}

}  // namespace bake
