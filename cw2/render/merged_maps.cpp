#include "cw2/render/merged_maps.h"

#include <tbb/parallel_for.h>

#include "cw2/render/decode_textures.h"

namespace cw2 {

using mesh_format::kNoTexture;
using mesh_format::MapUse;
using mesh_format::TextureFormat;
using mesh_format::TextureRecord;

std::optional<MergedMaps> merged_maps(const mesh_format::Document& document,
                                      const mesh_format::MaterialRecord& material) {
    const MergedMaps maps{material.textures[MapUse::normal], material.textures[MapUse::roughness],
                          material.textures[MapUse::metalness]};
    if (maps.normal == kNoTexture || (maps.roughness == kNoTexture && maps.metalness == kNoTexture))
        return std::nullopt;
    const TextureRecord& normal = document.textures[maps.normal];
    if (normal.format != TextureFormat::bc5_unorm) return std::nullopt;
    for (const std::uint32_t other : {maps.roughness, maps.metalness}) {
        if (other == kNoTexture) continue;
        const TextureRecord& record = document.textures[other];
        if (record.width != normal.width || record.height != normal.height ||
            record.flags != normal.flags)
            return std::nullopt;
    }
    return maps;
}

std::vector<std::span<const std::byte>> merged_levels(const mesh_format::Document& document,
                                                      const MergedMaps& maps,
                                                      std::vector<std::byte>& memory) {
    std::vector<std::byte> normal_memory, roughness_memory, metalness_memory;
    const auto levels = [&](std::uint32_t index, std::vector<std::byte>& decoded) {
        return index == kNoTexture ? std::vector<std::span<const std::byte>>{}
                                   : texel_levels(document, index, decoded);
    };
    const auto normals = levels(maps.normal, normal_memory);
    const auto roughness = levels(maps.roughness, roughness_memory);
    const auto metalness = levels(maps.metalness, metalness_memory);
    const TextureRecord& record = document.textures[maps.normal];
    std::vector<std::size_t> offsets{0};
    for (std::uint32_t i = 0; i < record.mip_count; ++i) {
        offsets.push_back(offsets.back() + std::size_t{4} *
                                               mesh_format::mip_extent(record.width, i) *
                                               mesh_format::mip_extent(record.height, i));
    }
    memory.resize(offsets.back());
    std::vector<std::span<const std::byte>> merged;
    for (std::uint32_t i = 0; i < record.mip_count; ++i) {
        const std::size_t width = mesh_format::mip_extent(record.width, i);
        tbb::parallel_for(std::size_t{0}, std::size_t{mesh_format::mip_extent(record.height, i)},
                          [&](std::size_t y) {
                              std::byte* out = memory.data() + offsets[i] + 4 * width * y;
                              for (std::size_t t = width * y; t < width * (y + 1); ++t, out += 4) {
                                  constexpr std::byte kOne{255};
                                  out[0] = normals[i][2 * t];
                                  out[1] = normals[i][2 * t + 1];
                                  out[2] = roughness.empty() ? kOne : roughness[i][t];
                                  out[3] = metalness.empty() ? kOne : metalness[i][t];
                              }
                          });
        merged.push_back(std::span(memory).subspan(offsets[i], offsets[i + 1] - offsets[i]));
    }
    return merged;
}

}  // namespace cw2
