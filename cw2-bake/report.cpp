#include "cw2-bake/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace bake {

namespace {

using mesh_format::Document;
using mesh_format::MaterialRecord;
using mesh_format::MeshRecord;
using mesh_format::PositionForm;
using mesh_format::TextureRecord;
using mesh_format::UvForm;

std::string position_error(const Document& document, const Counts& counts) {
    const float error = document.scene.position_error;
    if (error == 0.0f) return "0";
    // Of a scene that is all but a point for floats, or of a forged file, anything.
    constexpr double kMostParts = 1e15;
    // Unlike std::clamp(), these take 0 for what is no number.
    const double parts =
        std::fmin(std::fmax(double{counts.extent} / double{error}, 0.0), kMostParts);
    return fmt::format("{:.2g} (1/{} of the extent)", error,
                       grouped(static_cast<std::uint64_t>(parts)));
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

}  // namespace

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

std::string grouped(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
        text.insert(static_cast<std::size_t>(at), 1, ',');
    }
    return text;
}

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

}  // namespace bake
