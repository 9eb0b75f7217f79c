#include "cw2-bake/gltf/geometry.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <limits>

#include "cw2-bake/textures/srgb.h"
#include "mesh-format/vertices.h"

namespace bake {
namespace {

using mesh_format::Document;
using mesh_format::MeshRecord;
using nlohmann::ordered_json;

enum : int { kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125 };
enum : int { kArrayBuffer = 34962, kElementArrayBuffer = 34963 };

struct Vertices {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents;
    std::vector<glm::vec2> uvs;
    std::vector<glm::u16vec4> colors;  ///< linear, 65535 is 1; empty if the mesh has none
};

/// Every byte that a channel may be is another word.
glm::u16vec4 linear_words(const std::uint8_t (&color)[4]) {
    glm::u16vec4 words;
    for (int channel = 0; channel < 4; ++channel) {
        const std::uint8_t byte = color[channel];
        const float linear = channel < 3 ? srgb().to_linear(byte) : byte / 255.0f;
        words[channel] = static_cast<std::uint16_t>(std::lround(65535.0f * linear));
    }
    return words;
}

Vertices vertices_of(const Document& document, const MeshRecord& mesh) {
    Vertices vertices;
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) {
        const mesh_format::Vertex vertex = mesh_format::unpack_vertex(document, mesh, i);
        const mesh_format::TangentFrame& frame = vertex.frame;
        vertices.positions.push_back(glm::make_vec3(vertex.position));
        vertices.normals.push_back(glm::make_vec3(frame.normal));
        vertices.tangents.emplace_back(glm::make_vec3(frame.tangent), frame.handedness);
        vertices.uvs.push_back(glm::make_vec2(vertex.uv));
        if (mesh.forms.color != mesh_format::ColorForm::none)
            vertices.colors.push_back(linear_words(vertex.color));
    }
    return vertices;
}

/// One view after the other grows with the meshes; they are joined at the end.
class View {
 public:
    View(int target, int stride) : target_(target), stride_(stride) {}

    /// Returns the offset of what was added.
    template <typename T>
    std::size_t add(const std::vector<T>& values) {
        const std::size_t offset = bytes_.size();
        const auto bytes = std::as_bytes(std::span(values));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        return offset;
    }

    /// Adds nothing where there is nothing: a view must not be empty.
    void finish(GltfGeometry& geometry) {
        if (bytes_.empty()) return;
        ordered_json view{
            {"buffer", 0}, {"byteOffset", geometry.bytes.size()}, {"byteLength", bytes_.size()}};
        if (stride_ > 0) view["byteStride"] = stride_;
        view["target"] = target_;
        geometry.views.push_back(std::move(view));
        geometry.bytes.insert(geometry.bytes.end(), bytes_.begin(), bytes_.end());
        bytes_ = {};
    }

 private:
    int target_;
    int stride_;  ///< bytes; 0: not stated
    std::vector<std::byte> bytes_;
};

class Builder {
 public:
    explicit Builder(const Document& document) : document_(document) {
        geometry_.low = glm::vec3(std::numeric_limits<float>::infinity());
        geometry_.high = -geometry_.low;
    }

    GltfGeometry build() {
        for (const MeshRecord& mesh : document_.meshes) add(mesh);
        for (View& view : views_) view.finish(geometry_);  // that of the colours is the last
        return std::move(geometry_);
    }

 private:
    enum : std::size_t { kPositions, kNormals, kTangents, kUvs, kIndices, kColors };

    void add(const MeshRecord& mesh) {
        const Vertices vertices = vertices_of(document_, mesh);
        ordered_json attributes;
        attributes["POSITION"] = add(kPositions, vertices.positions, "VEC3", kFloat);
        bound(vertices.positions);
        attributes["NORMAL"] = add(kNormals, vertices.normals, "VEC3", kFloat);
        attributes["TANGENT"] = add(kTangents, vertices.tangents, "VEC4", kFloat);
        attributes["TEXCOORD_0"] = add(kUvs, vertices.uvs, "VEC2", kFloat);
        if (!vertices.colors.empty()) {
            attributes["COLOR_0"] = add(kColors, vertices.colors, "VEC4", kUnsignedShort);
            geometry_.accessors.back()["normalized"] = true;
        }
        const auto indices = document_.indices.subspan(mesh.first_index, mesh.index_count);
        const bool fits = mesh.vertex_count <= 0xFFFF;  // index 65,535 would mean a restart
        const std::size_t accessor =
            fits ? add(kIndices, std::vector<std::uint16_t>(indices.begin(), indices.end()),
                       "SCALAR", kUnsignedShort)
                 : add(kIndices, std::vector<std::uint32_t>(indices.begin(), indices.end()),
                       "SCALAR", kUnsignedInt);
        geometry_.primitives.push_back({{"attributes", std::move(attributes)},
                                        {"indices", accessor},
                                        {"material", mesh.material}});
    }

    /// Returns the accessor's index.
    template <typename T>
    std::size_t add(std::size_t view, const std::vector<T>& values, const char* type,
                    int component_type) {
        geometry_.accessors.push_back({{"bufferView", view},
                                       {"byteOffset", views_[view].add(values)},
                                       {"componentType", component_type},
                                       {"count", values.size()},
                                       {"type", type}});
        return geometry_.accessors.size() - 1;
    }

    /// The accessor added last is asked to state its bounds.
    void bound(const std::vector<glm::vec3>& positions) {
        glm::vec3 low = positions.front();
        glm::vec3 high = low;
        for (const glm::vec3& position : positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        geometry_.accessors.back()["min"] = {low.x, low.y, low.z};
        geometry_.accessors.back()["max"] = {high.x, high.y, high.z};
        geometry_.low = glm::min(geometry_.low, low);
        geometry_.high = glm::max(geometry_.high, high);
    }

    const Document& document_;
    GltfGeometry geometry_;
    View views_[6] = {{kArrayBuffer, 12}, {kArrayBuffer, 12},       {kArrayBuffer, 16},
                      {kArrayBuffer, 8},  {kElementArrayBuffer, 0}, {kArrayBuffer, 8}};
};

}  // namespace

GltfGeometry make_gltf_geometry(const Document& document) {
    return Builder(document).build();
}

}  // namespace bake
