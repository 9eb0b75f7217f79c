#include "cw2-bake/gltf/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/gltf/json.h"

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

/// A primitive's vertices as the file has them; null where it has no such attribute.
struct GltfPrimitives::Arrays {
    std::size_t count = 0;
    const std::vector<float>* positions = nullptr;
    const std::vector<float>* normals = nullptr;
    const std::vector<float>* tangents = nullptr;
    const std::vector<float>* uvs = nullptr;

    static glm::dvec3 at3(const std::vector<float>& values, std::size_t i, std::size_t stride = 3) {
        return {values[stride * i], values[stride * i + 1], values[stride * i + 2]};
    }
};

GltfPrimitives::GltfPrimitives(const GltfFile& file, const Warn& warn, SourceScene& scene)
    : file_(file), warn_(warn), scene_(scene), accessors_(file), converter_(file, warn) {
    // Nodes may show a mesh again and again; a small file must not claim all memory.
    constexpr std::size_t kAlways = std::size_t{1} << 24, kCornersPerByte = 64;
    std::size_t bytes = 0;
    for (const auto& buffer : file.buffers) bytes += buffer.size();
    most_corners_ = std::clamp(kCornersPerByte * bytes, kAlways, std::size_t{kAbsent} - 1);
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

void GltfPrimitives::expect_mesh(int mesh) {
    for (const auto& primitive : file_.model.meshes[static_cast<std::size_t>(mesh)].primitives) {
        const auto positions = primitive.attributes.find("POSITION");
        if (positions == primitive.attributes.end()) continue;
        const bool first_time = read_.insert(positions->second).second;
        if (std::exchange(read_last_, positions->second) != positions->second && !first_time)
            read_again_ += accessors_.count(positions->second);
        const int counted = primitive.indices >= 0 ? primitive.indices : positions->second;
        const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
        corners_ += accessors_.count(counted) * (is_list ? 1 : 3);
    }
    // Only the latest accessor is kept.
    constexpr std::size_t kMostReads = std::size_t{1} << 33;
    if (read_again_ > kMostReads) {
        fail_at(file_.path, fmt::format("/meshes/{}", mesh),
                fmt::format("its nodes take turns with others so often that more than {} positions "
                            "would be read",
                            kMostReads));
    }
    if (corners_ > most_corners_) {
        fail_at(file_.path, fmt::format("/meshes/{}", mesh),
                fmt::format("its nodes give the scene more than {} corners, implausible for the "
                            "file's bytes",
                            most_corners_));
    }
}

GltfPrimitives::Arrays GltfPrimitives::read_arrays(const tinygltf::Primitive& primitive,
                                                   const Material& material,
                                                   const std::string& place) {
    const auto attribute = [&](const std::string& name) {
        const auto found = primitive.attributes.find(name);
        return found == primitive.attributes.end() ? -1 : found->second;
    };
    const int positions = attribute("POSITION");
    const int normals = attribute("NORMAL");
    const int tangents = normals < 0 ? -1 : attribute("TANGENT");
    const int uvs = attribute(fmt::format("TEXCOORD_{}", material.of.uv_set));
    accessors_.keep_only(std::array{positions, normals, tangents, uvs});
    colors_ |= attribute("COLOR_0") >= 0;

    Arrays arrays;
    arrays.count = accessors_.count(positions);
    const auto read = [&](int accessor, int components) -> const std::vector<float>* {
        if (accessor < 0) return nullptr;
        if (accessors_.count(accessor) != arrays.count)
            fail_at(file_.path, place + "/attributes", "its accessors differ in count");
        return &accessors_.floats(accessor, components);
    };
    arrays.positions = read(positions, 3);
    arrays.normals = read(normals, 3);
    arrays.tangents = read(tangents, 4);
    arrays.uvs = read(uvs, 2);
    return arrays;
}

void GltfPrimitives::add_primitive(const tinygltf::Primitive& primitive, const std::string& place,
                                   const glm::dmat4& world_from_mesh) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) fail_at(file_.path, place + "/mode", "is no mode");
    if (mode < TINYGLTF_MODE_TRIANGLES) {
        ++points_or_lines_;
        return;
    }
    if (!primitive.attributes.contains("POSITION")) return;  // allowed, and nothing to see
    const Material& material = this->material(primitive.material);
    if (!material.of.visible) return;
    const Arrays arrays = read_arrays(primitive, material, place);

    std::vector<std::uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = accessors_.indices(primitive.indices);
    } else {
        indices.resize(arrays.count);
        for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
    }
    for (const std::uint32_t index : indices) {
        if (index >= arrays.count)
            fail_at(file_.path, place + "/indices",
                    fmt::format("refers to vertex {} of {}", index, arrays.count));
    }
    const auto triangles = triangles_of(mode, indices);

    const glm::dmat3 linear(world_from_mesh);
    const glm::dmat3 of_normals = normal_matrix(linear);
    const bool mirrored = glm::determinant(linear) < 0.0;
    if (new_index_.size() < arrays.count) new_index_.resize(arrays.count, kUnused);
    std::vector<glm::vec4> tangents;  // of the new vertices
    const auto first_vertex = static_cast<std::uint32_t>(scene_.positions.size());
    const auto add_vertex = [&](std::uint32_t i) {
        new_index_[i] = static_cast<std::uint32_t>(scene_.positions.size());
        const glm::dvec4 point(Arrays::at3(*arrays.positions, i), 1.0);
        const glm::vec3 position(glm::dvec3(world_from_mesh * point));
        if (!std::isfinite(position.x + position.y + position.z))
            fail_at(file_.path, place, "its node takes it out of the range of floats");
        scene_.positions.push_back(stored(position));
        const glm::vec3 normal =
            arrays.normals ? stored_direction(of_normals * Arrays::at3(*arrays.normals, i))
                           : glm::vec3(0.0f);
        scene_.normals.push_back(normal);
        glm::dvec2 uv(0.0);
        if (arrays.uvs) {
            uv = material.of.uv_transform.apply({(*arrays.uvs)[2 * i], (*arrays.uvs)[2 * i + 1]});
        }
        const glm::vec2 upward(uv.x, 1.0f - static_cast<float>(uv.y));
        if (!std::isfinite(upward.x + upward.y))
            fail_at(file_.path, place,
                    "its texture's transform takes it out of the range of floats");
        scene_.uvs.push_back(stored(upward));
        if (arrays.tangents) {
            const glm::vec3 t = stored_direction(linear * Arrays::at3(*arrays.tangents, i, 4));
            const bool usable = glm::length(glm::cross(t, normal)) > 1e-3f;
            const float w = (*arrays.tangents)[4 * i + 3] < 0.0f ? -1.0f : 1.0f;
            tangents.push_back(usable ? glm::vec4(t, mirrored ? -w : w) : glm::vec4(0.0f));
        }
    };
    if (arrays.tangents) scene_.tangents.resize(scene_.corners.size(), glm::vec4(0.0f));
    for (const auto& triangle : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t i = triangle[mirrored && k > 0 ? 3 - k : k];
            if (new_index_[i] == kUnused) add_vertex(i);
            const std::uint32_t v = new_index_[i];
            const bool has_normal = scene_.normals[v] != glm::vec3(0.0f);
            some_without_normals_ |= !has_normal;
            scene_.corners.push_back({.position = v, .normal = has_normal ? v : kAbsent, .uv = v});
            if (arrays.tangents) scene_.tangents.push_back(tangents[v - first_vertex]);
        }
        scene_.triangle_material.push_back(material.index);
    }
    // Only what was used: a few triangles of a long accessor may be shown again and again.
    for (const std::uint32_t i : indices) new_index_[i] = kUnused;
    if (!scene_.tangents.empty()) scene_.tangents.resize(scene_.corners.size(), glm::vec4(0.0f));
    if (some_without_normals_) scene_.smoothing_group.resize(scene_.triangle_material.size(), 0);
}

void GltfPrimitives::add_mesh(int mesh, const glm::dmat4& world_from_mesh) {
    const auto& primitives = file_.model.meshes[static_cast<std::size_t>(mesh)].primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        add_primitive(primitives[i], fmt::format("/meshes/{}/primitives/{}", mesh, i),
                      world_from_mesh);
    }
}

void GltfPrimitives::warn_of_left_out() const {
    const std::string name = file_.path.string();
    if (points_or_lines_ > 0) {
        warn_(fmt::format("{}: points and lines are left out ({} primitives)", name,
                          points_or_lines_));
    }
    if (colors_) warn_(name + ": vertex colours are left out");
}

}  // namespace bake
