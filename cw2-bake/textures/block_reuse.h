// Blocks that Zstandard stores in fewer bytes, for a little error.
#pragma once

#include "cw2-bake/textures/block_encoders.h"

namespace bake {

/// Squared differences of bytes that a bit is worth.
inline constexpr float kErrorPerBit = 2.0f;
/// The most bits that a block is taken to save.
inline constexpr float kMostBitsSaved = 42.0f;

/// Lets blocks of BC4 be equal to one of the last different ones, or have its indices between ends
/// of their own, where Zstandard's match saves more than the added error is worth: no block's sum
/// of squared differences grows by more than kErrorPerBit * kMostBitsSaved. `level` has one byte a
/// texel, `blocks` are what encode_bc4_row() made of it, without a limit. Blocks that reach over
/// its edges stay. Returns what is added to the sum over its texels. The result is the same on
/// every processor.
double reuse_blocks(const PlainLevel& level, std::byte* blocks);

}  // namespace bake
