#include "cw2-bake/inspection.h"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cw2-bake/report.h"

namespace bake {

namespace {

using json = nlohmann::ordered_json;
using mesh_format::ColorForm;
using mesh_format::Document;
using mesh_format::FrameForm;
using mesh_format::MaterialRecord;
using mesh_format::MeshRecord;
using mesh_format::PositionForm;
using mesh_format::SourceRecord;
using mesh_format::TextureFormat;
using mesh_format::TextureRecord;
using mesh_format::UvForm;

const char* name_of(PositionForm form) {
    return form == PositionForm::quantised ? "quantised" : "f32";
}
const char* name_of(UvForm form) {
    return form == UvForm::quantised ? "quantised" : "f32";
}
const char* name_of(ColorForm form) {
    return form == ColorForm::none ? "none" : "rgba8";
}
const char* name_of(FrameForm form) {
    switch (form) {
        case FrameForm::quat48:
            return "quat48";
        case FrameForm::quat32:
            return "quat32";
        case FrameForm::half3:
            return "half3";
        case FrameForm::f32:
            return "f32";
    }
    return "";
}
const char* name_of(TextureFormat format) {
    switch (format) {
        case TextureFormat::r8_unorm:
            return "r8_unorm";
        case TextureFormat::rg8_unorm:
            return "rg8_unorm";
        case TextureFormat::rgba8_srgb:
            return "rgba8_srgb";
        case TextureFormat::bc1_srgb:
            return "bc1_srgb";
        case TextureFormat::bc4_unorm:
            return "bc4_unorm";
        case TextureFormat::bc5_unorm:
            return "bc5_unorm";
        case TextureFormat::bc7_srgb:
            return "bc7_srgb";
    }
    return "";
}

void list_meshes(const Document& document, std::string& out) {
    for (std::size_t i = 0; i < document.meshes.size(); ++i) {
        const MeshRecord& mesh = document.meshes[i];
        fmt::format_to(
            std::back_inserter(out),
            "mesh {}: {} vertices, {} triangles in {} chunks, material {}, position {}, frame {}, "
            "uv {}{}\n",
            i, grouped(mesh.vertex_count), grouped(mesh.index_count / 3), mesh.chunk_count,
            mesh.material, name_of(mesh.forms.position), name_of(mesh.forms.frame),
            name_of(mesh.forms.uv), mesh.forms.color == ColorForm::none ? "" : ", with colours");
    }
}

/// What JSON calls the texture of each map.
constexpr mesh_format::PerMap<const char*> kTextureKeys{{"base_color_texture", "roughness_texture",
                                                         "metalness_texture", "normal_texture",
                                                         "alpha_mask_texture", "emission_texture"}};
static_assert(kTextureKeys.values[mesh_format::kMapUseCount - 1] != nullptr);

/// What each flag of a material says, for people and for JSON.
struct FlagName {
    mesh_format::MaterialFlags flag;
    const char* words;
    const char* key;
};
constexpr FlagName kFlagNames[] = {
    {mesh_format::kAlphaMask, "alpha mask", "alpha_mask"},
    {mesh_format::kCullBack, "seen from the front", "culled"},
    {mesh_format::kFlipBackNormals, "lit on both sides", "flips_back_normals"},
    {mesh_format::kUnlit, "unlit", "unlit"},
    {mesh_format::kBlend, "blended in the source, drawn opaque", "blend"},
};

void list_materials(const Document& document, std::string& out) {
    const auto vector = [](const float(&v)[3]) {
        return fmt::format("{:.3g} {:.3g} {:.3g}", v[0], v[1], v[2]);
    };
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        const MaterialRecord& material = document.materials[i];
        fmt::format_to(std::back_inserter(out),
                       "material {} '{}': base colour {}, roughness {:.3g}, metalness {:.3g}, "
                       "normal scale {:.3g}, alpha cutoff {:.3g}, emission {}, opacity {:.3g}",
                       i, document.text(material.name), vector(material.base_color),
                       material.roughness, material.metalness, material.normal_scale,
                       material.alpha_cutoff, vector(material.emission), material.opacity);
        for (const FlagName& name : kFlagNames) {
            if (material.flags & name.flag)
                fmt::format_to(std::back_inserter(out), ", {}", name.words);
        }
        for (std::size_t use = 0; use < mesh_format::kMapUseCount; ++use) {
            const std::uint32_t index = material.textures.values[use];
            if (index == mesh_format::kNoTexture) continue;
            fmt::format_to(std::back_inserter(out), ", {} texture {}",
                           mesh_format::kMaps.values[use].name, index);
        }
        out += '\n';
    }
}

void list_textures(const Document& document, std::string& out) {
    for (std::size_t i = 0; i < document.textures.size(); ++i) {
        const TextureRecord& texture = document.textures[i];
        fmt::format_to(
            std::back_inserter(out), "texture {} '{}': {} x {} {}, {} bytes{}{}{}\n", i,
            document.text(texture.name), texture.width, texture.height, name_of(texture.format),
            grouped(texture.size), texture.flags & mesh_format::kClampToEdge ? ", clamped" : "",
            texture.flags & mesh_format::kCompressed ? ", compressed" : "",
            texture.psnr > 0.0f ? fmt::format(", {:.1f} dB in blocks", texture.psnr) : "");
    }
}

/// Source keys as hexadecimal numbers.
std::string key_text(const SourceRecord& source) {
    return fmt::format("{:016x}{:016x}", source.key[1], source.key[0]);
}

void list_sources(const Document& document, std::string& out) {
    for (const SourceRecord& source : document.sources) {
        const auto index = [](std::uint32_t texture) {
            return texture == mesh_format::kNoTexture ? "none" : std::to_string(texture);
        };
        fmt::format_to(std::back_inserter(out), "source {}: texture {}, alpha mask {}{}\n",
                       key_text(source), index(source.texture), index(source.alpha_mask),
                       source.flags & mesh_format::kHoldsFactor ? ", holds its factor" : "");
    }
}

/// As few digits as tell a float from its neighbours, and no number where it is none.
json number(float value) {
    return json::parse(fmt::format("{}", value), nullptr, false).is_number()
               ? json::parse(fmt::format("{}", value))
               : json();
}

template <typename Real, std::size_t count>
json vector(const Real (&values)[count]) {
    json result = json::array();
    for (const Real value : values) result.push_back(number(value));
    return result;
}

json texture_index(std::uint32_t index) {
    return index == mesh_format::kNoTexture ? json() : json(index);
}

/// One element a record.
template <typename Records, typename Convert>
json array_of(const Records& records, Convert convert) {
    json result = json::array();
    for (const auto& record : records) result.push_back(convert(record));
    return result;
}

json json_of(const MeshRecord& mesh) {
    return {{"vertices", mesh.vertex_count},
            {"triangles", mesh.index_count / 3},
            {"chunks", mesh.chunk_count},
            {"material", mesh.material},
            {"position", name_of(mesh.forms.position)},
            {"frame", name_of(mesh.forms.frame)},
            {"uv", name_of(mesh.forms.uv)},
            {"color", name_of(mesh.forms.color)}};
}

json json_of(const Document& document, const MaterialRecord& material) {
    json result{{"name", document.text(material.name)},
                {"base_color", vector(material.base_color)},
                {"roughness", number(material.roughness)},
                {"metalness", number(material.metalness)},
                {"normal_scale", number(material.normal_scale)},
                {"alpha_cutoff", number(material.alpha_cutoff)},
                {"emission", vector(material.emission)},
                {"opacity", number(material.opacity)}};
    for (const FlagName& name : kFlagNames) result[name.key] = (material.flags & name.flag) != 0;
    for (std::size_t use = 0; use < mesh_format::kMapUseCount; ++use) {
        result[kTextureKeys.values[use]] = texture_index(material.textures.values[use]);
    }
    return result;
}

json json_of(const Document& document, const TextureRecord& texture) {
    return {{"name", document.text(texture.name)},
            {"format", name_of(texture.format)},
            {"width", texture.width},
            {"height", texture.height},
            {"mips", texture.mip_count},
            {"clamped", (texture.flags & mesh_format::kClampToEdge) != 0},
            {"compressed", (texture.flags & mesh_format::kCompressed) != 0},
            {"bytes", texture.size},
            {"psnr", number(texture.psnr)}};
}

json json_of(const SourceRecord& source) {
    return {{"key", key_text(source)},
            {"texture", texture_index(source.texture)},
            {"alpha_mask", texture_index(source.alpha_mask)},
            {"holds_factor", (source.flags & mesh_format::kHoldsFactor) != 0}};
}

}  // namespace

std::string inspection(const Document& document, std::uint64_t file_bytes) {
    std::string out = summary(document, file_bytes);
    const auto& scene = document.scene;
    fmt::format_to(std::back_inserter(out), "  box from {} {} {} to {} {} {}, radius {}\n",
                   scene.bounds_min[0], scene.bounds_min[1], scene.bounds_min[2],
                   scene.bounds_max[0], scene.bounds_max[1], scene.bounds_max[2], scene.radius);
    if (scene.origin[0] != 0.0 || scene.origin[1] != 0.0 || scene.origin[2] != 0.0) {
        fmt::format_to(std::back_inserter(out), "  all relative to the origin {} {} {}\n",
                       scene.origin[0], scene.origin[1], scene.origin[2]);
    }
    if (scene.flags & mesh_format::kHasCamera) {
        fmt::format_to(std::back_inserter(out), "  camera at {} {} {}, towards {} {} {}\n",
                       scene.camera_position[0], scene.camera_position[1], scene.camera_position[2],
                       scene.camera_target[0], scene.camera_target[1], scene.camera_target[2]);
    }
    if (scene.flags & mesh_format::kHasLight) {
        fmt::format_to(std::back_inserter(out), "  light at {} {} {}, colour {} {} {}\n",
                       scene.light_position[0], scene.light_position[1], scene.light_position[2],
                       scene.light_color[0], scene.light_color[1], scene.light_color[2]);
    }
    list_meshes(document, out);
    list_materials(document, out);
    list_textures(document, out);
    list_sources(document, out);
    return out;
}

std::string inspection_json(const Document& document, std::uint64_t file_bytes) {
    const Counts counts = count(document);
    const auto& scene = document.scene;
    json result{{"format_version", mesh_format::kVersion},
                {"bytes", file_bytes},
                {"vertex_bytes", counts.vertex_bytes},
                {"index_bytes", counts.index_bytes},
                {"texel_bytes", counts.texel_bytes},
                {"vertices", counts.vertices},
                {"triangles", counts.triangles},
                {"origin", scene.origin},
                {"bounds_min", vector(scene.bounds_min)},
                {"bounds_max", vector(scene.bounds_max)},
                {"radius", number(scene.radius)},
                {"position_error", number(scene.position_error)},
                {"frame_error_mean_degrees", number(scene.frame_error_mean)},
                {"frame_error_max_degrees", number(scene.frame_error_max)},
                {"uv_error_texels", number(scene.uv_error)}};
    if (scene.flags & mesh_format::kHasCamera) {
        result["camera"] = {{"position", vector(scene.camera_position)},
                            {"target", vector(scene.camera_target)},
                            {"fov_radians", number(scene.camera_fov)}};
    }
    if (scene.flags & mesh_format::kHasLight) {
        result["light"] = {{"position", vector(scene.light_position)},
                           {"color", vector(scene.light_color)}};
    }
    result["meshes"] =
        array_of(document.meshes, [](const MeshRecord& mesh) { return json_of(mesh); });
    result["materials"] = array_of(document.materials, [&](const MaterialRecord& material) {
        return json_of(document, material);
    });
    result["textures"] = array_of(document.textures, [&](const TextureRecord& texture) {
        return json_of(document, texture);
    });
    result["sources"] =
        array_of(document.sources, [](const SourceRecord& source) { return json_of(source); });
    // Names may be in any encoding.
    return result.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

}  // namespace bake
