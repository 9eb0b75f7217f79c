// The maps that a fragment reads one by one, in one image: for devices on which every read counts.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mesh-format/file.h"

namespace cw2 {

/// Textures of a material whose texels lie at the same places: indices into the document's, or
/// mesh_format::kNoTexture for one of roughness and metalness.
struct MergedMaps {
    std::uint32_t normal;
    std::uint32_t roughness;
    std::uint32_t metalness;
    auto operator<=>(const MergedMaps&) const = default;
};

/// Nothing where the maps differ in size or in what happens at their borders, where there is
/// nothing to merge, or where the normals are not two-channel ones.
std::optional<MergedMaps> merged_maps(const mesh_format::Document& document,
                                      const mesh_format::MaterialRecord& material);

/// The levels of the merged image, 8 bits a channel: x and y of the normal, roughness, metalness;
/// 255 for what is absent. They lie in `memory`, whose earlier contents are lost.
std::vector<std::span<const std::byte>> merged_levels(const mesh_format::Document& document,
                                                      const MergedMaps& maps,
                                                      std::vector<std::byte>& memory);

}  // namespace cw2
