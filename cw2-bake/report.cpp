#include "cw2-bake/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "common/quoted_text.h"

namespace bake {

namespace {

using common::quoted_text;
using mesh_format::Document;
using mesh_format::FrameForm;
using mesh_format::MapUse;
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
        case TextureFormat::rgba8_unorm:
            return "rgba8_unorm";
        case TextureFormat::rgba8_srgb:
            return "rgba8_srgb";
        case TextureFormat::bc1_srgb:
            return "bc1_srgb";
        case TextureFormat::bc4_unorm:
            return "bc4_unorm";
        case TextureFormat::bc5_unorm:
            return "bc5_unorm";
    }
    return "";
}

struct Counts {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    std::size_t masked_materials = 0;
    std::size_t wide_meshes = 0;     ///< whose UVs 16 bits would not hold exactly enough
    std::uint64_t vertex_bytes = 0;  ///< as stored
    std::uint64_t index_bytes = 0;
    std::uint64_t texel_bytes = 0;
    float extent = 0.0f;  ///< longest side of the bounding box
};

Counts count(const Document& document) {
    Counts counts;
    for (const MeshRecord& mesh : document.meshes) {
        counts.vertices += mesh.vertex_count;
        counts.triangles += mesh.index_count / 3;
        if (mesh.forms.uv == UvForm::f32 && mesh.forms.position == PositionForm::quantised) {
            ++counts.wide_meshes;
        }
    }
    for (const MaterialRecord& material : document.materials) {
        if (material.flags & mesh_format::kAlphaMask) ++counts.masked_materials;
    }
    counts.vertex_bytes = document.vertices.size() + document.encoded_vertices.size();
    for (const TextureRecord& texture : document.textures) counts.texel_bytes += texture.size;
    counts.index_bytes = document.indices.size_bytes() + document.encoded_indices.size();
    for (int axis = 0; axis < 3; ++axis) {
        counts.extent = std::max(counts.extent,
                                 document.scene.bounds_max[axis] - document.scene.bounds_min[axis]);
    }
    return counts;
}

/// 1234567 -> "1,234,567".
std::string grouped(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
        text.insert(static_cast<std::size_t>(at), 1, ',');
    }
    return text;
}

std::string position_error(const Document& document, const Counts& counts) {
    const float error = document.scene.position_error;
    if (error == 0.0f) return "0";
    return fmt::format("{:.2g} (1/{} of the extent)", error,
                       grouped(static_cast<std::uint64_t>(counts.extent / error)));
}

std::string json_texture(std::uint32_t index) {
    return index == mesh_format::kNoTexture ? "null" : std::to_string(index);
}

void list_meshes(const Document& document, std::string& out) {
    for (std::size_t i = 0; i < document.meshes.size(); ++i) {
        const MeshRecord& mesh = document.meshes[i];
        fmt::format_to(
            std::back_inserter(out),
            "mesh {}: {} vertices, {} triangles in {} chunks, material {}, position {}, frame {}, "
            "uv {}\n",
            i, grouped(mesh.vertex_count), grouped(mesh.index_count / 3), mesh.chunk_count,
            mesh.material, name_of(mesh.forms.position), name_of(mesh.forms.frame),
            name_of(mesh.forms.uv));
    }
}

void list_materials(const Document& document, std::string& out) {
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        const MaterialRecord& material = document.materials[i];
        fmt::format_to(std::back_inserter(out),
                       "material {} '{}': base colour {:.3g} {:.3g} {:.3g}, roughness {:.3g}, "
                       "metalness {:.3g}",
                       i, document.text(material.name), material.base_color[0],
                       material.base_color[1], material.base_color[2], material.roughness,
                       material.metalness);
        const auto texture = [&](const char* use, std::uint32_t index) {
            if (index != mesh_format::kNoTexture) {
                fmt::format_to(std::back_inserter(out), ", {} texture {}", use, index);
            }
        };
        if (material.normal_scale != 1.0f) {
            fmt::format_to(std::back_inserter(out), ", normal scale {:.3g}", material.normal_scale);
        }
        if (material.flags & mesh_format::kCullBack) out += ", seen from the front";
        if (material.flags & mesh_format::kFlipBackNormals) out += ", lit on both sides";
        for (std::size_t use = 0; use < mesh_format::kMapUseCount; ++use)
            texture(mesh_format::kMaps.values[use].name, material.textures.values[use]);
        out += '\n';
    }
}

void list_textures(const Document& document, std::string& out) {
    for (std::size_t i = 0; i < document.textures.size(); ++i) {
        const TextureRecord& texture = document.textures[i];
        fmt::format_to(
            std::back_inserter(out), "texture {} '{}': {} x {} {}, {} bytes{}{}\n", i,
            document.text(texture.name), texture.width, texture.height, name_of(texture.format),
            grouped(texture.size), texture.flags & mesh_format::kClampToEdge ? ", clamped" : "",
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

bool in_blocks(const TextureRecord& texture) {
    return mesh_format::block_extent(texture.format) > 1;
}

/// Which textures blocks would have harmed; empty if there is none.
std::string uncompressed(const Document& document) {
    std::string names;
    std::size_t count = 0;
    for (const TextureRecord& texture : document.textures) {
        if (in_blocks(texture) || texture.psnr == 0.0f) continue;
        fmt::format_to(std::back_inserter(names), "{}{} {:.1f} dB", count > 0 ? ", " : "",
                       document.text(texture.name), texture.psnr);
        ++count;
    }
    return count == 0
               ? ""
               : fmt::format("  kept uncompressed, too far off in blocks: {} ({})\n",
                             count == 1 ? "1 texture" : fmt::format("{} textures", count), names);
}

/// A JSON array with one element a record.
template <typename Records, typename Format>
std::string json_array(const Records& records, Format format) {
    std::string out = "[";
    for (const auto& record : records) {
        out += (out.size() > 1 ? ",\n    " : "\n    ") + format(record);
    }
    return out + (out.size() > 1 ? "\n  ]" : "]");
}

}  // namespace

std::string summary(const Document& document, std::uint64_t file_bytes) {
    const Counts counts = count(document);
    const std::uint64_t data_bytes = counts.vertex_bytes + counts.index_bytes + counts.texel_bytes;
    const std::string wide =
        counts.wide_meshes == 0
            ? ""
            : fmt::format("  {} meshes keep UVs of 32 bits: 16 would miss 1/8 texel\n",
                          counts.wide_meshes);
    return fmt::format(
               "  {} vertices, {} triangles, {} meshes of {} chunks, {} materials ({} "
               "alpha-masked), {} "
               "textures\n"
               "  {} bytes: vertices {}, indices {}, texels {}, tables {}\n"
               "  largest errors: position {}; frame {:.4f} degrees (mean {:.4f}); UV {:.3f} "
               "texel\n",
               grouped(counts.vertices), grouped(counts.triangles), document.meshes.size(),
               document.chunks.size(), document.materials.size(), counts.masked_materials,
               document.textures.size(), grouped(file_bytes), grouped(counts.vertex_bytes),
               grouped(counts.index_bytes), grouped(counts.texel_bytes),
               grouped(file_bytes - data_bytes), position_error(document, counts),
               document.scene.frame_error_max, document.scene.frame_error_mean,
               document.scene.uv_error) +
           wide + uncompressed(document);
}

std::string export_summary(const Document& document, std::uint64_t file_bytes) {
    std::uint64_t vertices = 0;
    for (const MeshRecord& mesh : document.meshes) vertices += mesh.vertex_count;
    return fmt::format("  {} vertices, {} triangles, {} materials, {} textures; {} bytes\n",
                       grouped(vertices), grouped(document.scene.index_count / 3),
                       document.materials.size(), document.textures.size(), grouped(file_bytes));
}

std::string inspection(const Document& document, std::uint64_t file_bytes) {
    std::string out = summary(document, file_bytes);
    const auto& scene = document.scene;
    fmt::format_to(std::back_inserter(out), "  box from {} {} {} to {} {} {}, radius {}\n",
                   scene.bounds_min[0], scene.bounds_min[1], scene.bounds_min[2],
                   scene.bounds_max[0], scene.bounds_max[1], scene.bounds_max[2], scene.radius);
    if (!std::ranges::all_of(scene.origin, [](double x) { return x == 0.0; })) {
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
    const std::string meshes = json_array(document.meshes, [](const MeshRecord& mesh) {
        return fmt::format(
            "{{\"vertices\": {}, \"triangles\": {}, \"chunks\": {}, \"material\": {}, "
            "\"position\": \"{}\", "
            "\"frame\": \"{}\", \"uv\": \"{}\"}}",
            mesh.vertex_count, mesh.index_count / 3, mesh.chunk_count, mesh.material,
            name_of(mesh.forms.position), name_of(mesh.forms.frame), name_of(mesh.forms.uv));
    });
    const std::string materials =
        json_array(document.materials, [&](const MaterialRecord& material) {
            return fmt::format(
                "{{\"name\": {}, \"base_color\": [{}, {}, {}], \"roughness\": {}, "
                "\"metalness\": {}, \"normal_scale\": {}, \"culled\": {}, \"alpha_mask\": {}, "
                "\"base_color_texture\": {}, "
                "\"roughness_texture\": {}, \"metalness_texture\": {}, \"normal_texture\": {}, "
                "\"alpha_mask_texture\": {}}}",
                quoted_text(document.text(material.name)), material.base_color[0],
                material.base_color[1], material.base_color[2], material.roughness,
                material.metalness, material.normal_scale,
                (material.flags & mesh_format::kCullBack) != 0,
                (material.flags & mesh_format::kAlphaMask) != 0,
                json_texture(material.textures[MapUse::base_color]),
                json_texture(material.textures[MapUse::roughness]),
                json_texture(material.textures[MapUse::metalness]),
                json_texture(material.textures[MapUse::normal]),
                json_texture(material.textures[MapUse::alpha_mask]));
        });
    const std::string textures = json_array(document.textures, [&](const TextureRecord& texture) {
        return fmt::format(
            "{{\"name\": {}, \"format\": \"{}\", \"width\": {}, \"height\": {}, \"mips\": {}, "
            "\"bytes\": {}, \"psnr\": {:.2f}}}",
            quoted_text(document.text(texture.name)), name_of(texture.format), texture.width,
            texture.height, texture.mip_count, texture.size, texture.psnr);
    });
    const std::string sources = json_array(document.sources, [](const SourceRecord& source) {
        return fmt::format(
            "{{\"key\": \"{}\", \"texture\": {}, \"alpha_mask\": {}, \"holds_factor\": {}}}",
            key_text(source), json_texture(source.texture), json_texture(source.alpha_mask),
            (source.flags & mesh_format::kHoldsFactor) != 0);
    });
    return fmt::format(
        "{{\n  \"format_version\": {},\n  \"bytes\": {},\n  \"vertex_bytes\": {},\n"
        "  \"index_bytes\": {},\n  \"texel_bytes\": {},\n  \"vertices\": {},\n"
        "  \"triangles\": {},\n  \"origin\": [{}, {}, {}],\n  \"bounds_min\": [{}, {}, {}],\n  "
        "\"bounds_max\": [{}, {}, {}],\n"
        "  \"radius\": {},\n  \"position_error\": {},\n  \"frame_error_mean_degrees\": {},\n"
        "  \"frame_error_max_degrees\": {},\n  \"uv_error_texels\": {},\n  \"meshes\": {},\n"
        "  \"materials\": {},\n  \"textures\": {},\n  \"sources\": {}\n}}\n",
        mesh_format::kVersion, file_bytes, counts.vertex_bytes, counts.index_bytes,
        counts.texel_bytes, counts.vertices, counts.triangles, scene.origin[0], scene.origin[1],
        scene.origin[2], scene.bounds_min[0], scene.bounds_min[1], scene.bounds_min[2],
        scene.bounds_max[0], scene.bounds_max[1], scene.bounds_max[2], scene.radius,
        scene.position_error, scene.frame_error_mean, scene.frame_error_max, scene.uv_error, meshes,
        materials, textures, sources);
}

}  // namespace bake
