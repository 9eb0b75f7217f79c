// Finished textures to blocks that the GPU samples as they are.
#pragma once

#include <optional>

#include "cw2-bake/textures/block_encoders.h"
#include "cw2-bake/textures/texture.h"

namespace bake {

/// Turns rgba8_srgb into bc1_srgb or else bc7_srgb, r8_unorm into bc4_unorm, and rg8_unorm, a
/// normal map, into bc5_unorm, and sets Texture::psnr: of the stored bytes of level 0; of normals
/// over the three components of 0.5 n + 0.5 with z rebuilt, so that 43 dB are 1.4 degrees (root
/// mean square). Colours are in BC1 from 37 dB on. Below 34 dB, or 43 for normals and masks, the
/// texture stays as it is but for psnr, as does one of a single texel. A mask has a `cutoff`, and
/// each of its texels stays on its side of that. `for_zstd`: bc4_unorm of others is made to take
/// less once compressed, by reuse_blocks().
void compress_to_blocks(Texture& texture, std::optional<float> cutoff = std::nullopt,
                        bool for_zstd = false);

/// Whether compress_to_blocks() will turn a mask with this level 0 into blocks, unless it is of a
/// single texel.
bool fits_blocks(const PlainLevel& mask, float cutoff);

}  // namespace bake
