#include "cw2-bake/gltf/write_gltf.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/file_kind.h"
#include "common/io.h"
#include "cw2-bake/gltf/geometry.h"
#include "cw2-bake/gltf/light.h"

namespace bake {
namespace {

using mesh_format::Document;
using mesh_format::MaterialRecord;
using mesh_format::SceneRecord;
using nlohmann::ordered_json;

template <typename T>
ordered_json json_of(const glm::vec<3, T>& v) {
    return {v.x, v.y, v.z};
}

/// Adds the emission, and that there is no light. A factor of glTF is at most 1; what goes beyond
/// is a strength.
void add_glow(const MaterialRecord& material, const GltfMaterialImages& images,
              ordered_json& json) {
    if (material.flags & mesh_format::kUnlit)
        json["extensions"]["KHR_materials_unlit"] = ordered_json::object();
    const glm::vec3 emission = glm::make_vec3(material.emission);
    const float largest = std::max({emission.r, emission.g, emission.b});
    if (largest == 0.0f) return;
    json["emissiveFactor"] = json_of(largest > 1.0f ? emission / largest : emission);
    if (largest > 1.0f)
        json["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = largest;
    if (images.emission != kNoImage) json["emissiveTexture"] = {{"index", images.emission}};
}

/// The names of the extensions that the materials have.
void add_used_extensions(ordered_json& root) {
    for (const char* name : {"KHR_materials_emissive_strength", "KHR_materials_unlit"}) {
        const bool used = std::ranges::any_of(root["materials"], [&](const ordered_json& material) {
            return material.contains("extensions") && material["extensions"].contains(name);
        });
        if (used) root["extensionsUsed"].push_back(name);
    }
}

ordered_json material_json(const Document& document, const MaterialRecord& material,
                           const GltfMaterialImages& images) {
    ordered_json surface;
    const glm::vec3 color = glm::make_vec3(material.base_color);
    const bool blends = material.flags & mesh_format::kBlend;
    surface["baseColorFactor"] = {color.r, color.g, color.b, blends ? material.opacity : 1.0f};
    surface["metallicFactor"] = material.metalness;
    surface["roughnessFactor"] = material.roughness;
    const auto texture = [](std::uint32_t image) { return ordered_json{{"index", image}}; };
    if (images.color != kNoImage) surface["baseColorTexture"] = texture(images.color);
    if (images.metallic_roughness != kNoImage)
        surface["metallicRoughnessTexture"] = texture(images.metallic_roughness);

    ordered_json json{{"name", document.text(material.name)},
                      {"pbrMetallicRoughness", std::move(surface)}};
    if (images.normal != kNoImage) {
        json["normalTexture"] = texture(images.normal);
        json["normalTexture"]["scale"] = material.normal_scale;
    }
    add_glow(material, images, json);
    if (blends) {
        json["alphaMode"] = "BLEND";
    } else if (material.flags & mesh_format::kAlphaMask) {
        json["alphaMode"] = "MASK";
        json["alphaCutoff"] = material.alpha_cutoff;
    }
    if (!(material.flags & mesh_format::kCullBack)) {
        json["doubleSided"] = true;
        if (!(material.flags & mesh_format::kFlipBackNormals))
            json["extras"]["cw2_back_normals"] = "kept";
    }
    return json;
}

glm::dvec3 origin_of(const SceneRecord& scene) {
    return glm::make_vec3(scene.origin);
}

/// Adds a camera and its node.
void add_camera(const SceneRecord& scene, ordered_json& root) {
    const glm::dvec3 position(glm::make_vec3(scene.camera_position));
    const glm::dvec3 sight =
        glm::normalize(glm::dvec3(glm::make_vec3(scene.camera_target)) - position);
    const glm::dvec3 up =
        std::abs(sight.y) < 0.9999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, -1.0);
    const glm::dquat rotation = glm::quatLookAtRH(sight, up);
    const float near = std::max(1e-4f * scene.radius, std::numeric_limits<float>::min());
    root["cameras"].push_back(
        {{"type", "perspective"}, {"perspective", {{"yfov", scene.camera_fov}, {"znear", near}}}});
    root["nodes"].push_back({{"name", "camera"},
                             {"camera", 0},
                             {"translation", json_of(origin_of(scene) + position)},
                             {"rotation", {rotation.x, rotation.y, rotation.z, rotation.w}}});
}

/// Adds a point light and its node.
void add_light(const SceneRecord& scene, const GltfGeometry& geometry, ordered_json& root) {
    const glm::dvec3 position(glm::make_vec3(scene.light_position));
    const glm::dvec3 low(geometry.low), high(geometry.high);
    const double distance =
        light_distance(position, 0.5 * (low + high), 0.5 * glm::length(high - low));
    const glm::vec3 color = glm::max(glm::make_vec3(scene.light_color), glm::vec3(0.0f));
    const float largest = std::max({color.r, color.g, color.b});
    root["extensionsUsed"].push_back("KHR_lights_punctual");
    root["extensions"]["KHR_lights_punctual"]["lights"].push_back(
        {{"type", "point"},
         {"color", json_of(largest > 0.0f ? color / largest : glm::vec3(1.0f))},
         {"intensity", largest * distance * distance}});
    root["nodes"].push_back({{"name", "light"},
                             {"translation", json_of(origin_of(scene) + position)},
                             {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
}

/// Adds what samples the images, which become views of the buffer.
void add_images(const GltfImages& images, GltfGeometry& geometry, ordered_json& root) {
    constexpr int kLinear = 9729, kTrilinear = 9987, kRepeat = 10497, kClamp = 33071;
    if (images.images.empty()) return;
    std::map<bool, std::size_t> samplers;
    const auto sampler = [&](bool clamp) {
        const auto [entry, fresh] = samplers.try_emplace(clamp, samplers.size());
        if (fresh) {
            const int wrap = clamp ? kClamp : kRepeat;
            root["samplers"].push_back({{"magFilter", kLinear},
                                        {"minFilter", kTrilinear},
                                        {"wrapS", wrap},
                                        {"wrapT", wrap}});
        }
        return entry->second;
    };
    for (std::size_t i = 0; i < images.images.size(); ++i) {
        const GltfImages::File& image = images.images[i];
        // First: a member that is new moves the others, and with them what root["textures"] is.
        const std::size_t of_image = sampler(image.clamp);
        root["textures"].push_back({{"sampler", of_image}, {"source", i}});
        root["images"].push_back({{"name", image.name},
                                  {"bufferView", geometry.views.size()},
                                  {"mimeType", "image/png"}});
        geometry.views.push_back({{"buffer", 0},
                                  {"byteOffset", geometry.bytes.size()},
                                  {"byteLength", image.png.size()}});
        geometry.bytes.insert(geometry.bytes.end(), image.png.begin(), image.png.end());
        geometry.bytes.resize((geometry.bytes.size() + 3) / 4 * 4);
    }
}

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 |
                   (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
        const std::size_t digits = std::min<std::size_t>(bytes.size() - i, 3) + 1;
        for (std::size_t k = 0; k < 4; ++k)
            text += k < digits ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

static_assert(std::endian::native == std::endian::little);

/// Those of the file's header and before each chunk's contents.
void write_words(common::OutputFile& file, std::initializer_list<std::uint32_t> words) {
    file.write(std::as_bytes(std::span(words.begin(), words.size())));
}

std::uint64_t write_glb(std::string json, std::span<const std::byte> binary,
                        const std::filesystem::path& path) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t size = 12 + 8 + json.size() + 8 + binary.size();
    if (size > 0xFFFF'FFFF)
        throw common::FileError(path.string() + ": would be larger than 4 GiB, a .glb's limit");
    common::OutputFile file(path);
    constexpr std::uint32_t kMagic = 0x4654'6C67, kJson = 0x4E4F'534A, kBinary = 0x004E'4942;
    write_words(file, {kMagic, 2, static_cast<std::uint32_t>(size),
                       static_cast<std::uint32_t>(json.size()), kJson});
    file.write(std::as_bytes(std::span(json)));
    write_words(file, {static_cast<std::uint32_t>(binary.size()), kBinary});
    file.write(binary);
    file.commit();
    return size;
}

std::uint64_t write_text(const std::string& json, const std::filesystem::path& path) {
    common::write_file(path, std::as_bytes(std::span(json)));
    return json.size();
}

}  // namespace

std::uint64_t write_gltf(const Document& document, TexturePayloads payloads,
                         const std::filesystem::path& path, const Warn& warn) {
    const GltfImages images = make_gltf_images(
        document, payloads, [&](const std::string& what) { warn(path.string() + ": " + what); });
    GltfGeometry geometry = make_gltf_geometry(document);
    ordered_json root;
    root["asset"] = {{"version", "2.0"}, {"generator", "cw2-bake " CW2_VERSION}};
    root["scene"] = 0;
    root["nodes"].push_back({{"name", path.stem().string()}, {"mesh", 0}});
    if (const glm::dvec3 origin = origin_of(document.scene); origin != glm::dvec3(0.0))
        root["nodes"][0]["translation"] = json_of(origin);
    root["meshes"][0]["primitives"] = std::move(geometry.primitives);
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        root["materials"].push_back(
            material_json(document, document.materials[i], images.materials[i]));
    }
    add_used_extensions(root);
    if (document.scene.flags & mesh_format::kHasCamera) add_camera(document.scene, root);
    if (document.scene.flags & mesh_format::kHasLight) add_light(document.scene, geometry, root);
    add_images(images, geometry, root);
    for (std::size_t i = 0; i < root["nodes"].size(); ++i) root["scenes"][0]["nodes"].push_back(i);
    root["accessors"] = std::move(geometry.accessors);
    root["bufferViews"] = std::move(geometry.views);
    ordered_json buffer{{"byteLength", geometry.bytes.size()}};
    const auto text = [&] {
        return root.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    };
    if (common::lower_extension(path) == ".glb") {
        root["buffers"].push_back(std::move(buffer));
        return write_glb(text(), geometry.bytes, path);
    }
    buffer["uri"] = "data:application/octet-stream;base64," + base64(geometry.bytes);
    root["buffers"].push_back(std::move(buffer));
    return write_text(text(), path);
}

}  // namespace bake
