// Finished textures to blocks that the GPU samples as they are.
#pragma once

#include <optional>

#include "cw2-bake/textures/texture.h"

namespace bake {

/// Turns rgba8_srgb into bc1_srgb or else bc7_srgb, r8_unorm into bc4_unorm, and rg8_unorm, a
/// normal map, into bc5_unorm, and sets Texture::psnr: of the stored bytes of level 0; of normals
/// over the three components of 0.5 n + 0.5 with z rebuilt, so that 38 dB are 2.5 degrees (root
/// mean square). Below 34 dB, or 38 for normals, the texture stays as it is but for psnr, as does
/// one of a single texel. With a `cutoff` each texel of a mask stays on its side of it.
void compress_to_blocks(Texture& texture, std::optional<float> cutoff = std::nullopt);

}  // namespace bake
