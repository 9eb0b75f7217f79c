// What the materials of a scene ask of their images.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cw2-bake/textures/material_images.h"
#include "cw2-bake/textures/texture.h"

namespace bake {

inline constexpr std::size_t kNoRequest = static_cast<std::size_t>(-1);

/// The requests of one material; kNoRequest where it has no such map. That of the base colour makes
/// the alpha mask, too.
using MaterialRequests = mesh_format::PerMap<std::size_t>;

struct TexturePlan {
    std::vector<ImageRequest> requests;  ///< every different one, in order of first use
    std::vector<MaterialRequests> materials;
};

TexturePlan make_plan(std::span<const SourceMaterial> materials, TextureMode mode);

}  // namespace bake
