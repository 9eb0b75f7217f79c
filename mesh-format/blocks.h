// Texture blocks to texels.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh-format/layout.h"

namespace mesh_format {

/// Bytes of a texel that decode_block_row() makes of `format`, one with blocks: bc1_srgb and
/// bc7_srgb become red, green, blue and 255; bc4_unorm red; bc5_unorm red and green; 8 bits each.
constexpr std::uint32_t decoded_texel_bytes(TextureFormat format) {
    switch (format) {
        case TextureFormat::bc4_unorm:
            return 1;
        case TextureFormat::bc5_unorm:
            return 2;
        default:
            return 4;
    }
}

/// Decodes a row of block_count(format, width) blocks to `rows` rows (at most 4) of `width` texels,
/// each `pitch` bytes after the one before. Values between the two that a block states are rounded
/// to 8 bits. Blocks of BC7 that no file has become black.
void decode_block_row(TextureFormat format, const std::byte* blocks, std::uint32_t width,
                      std::uint32_t rows, std::byte* out, std::size_t pitch);
/// The same, tightly packed.
inline void decode_block_row(TextureFormat format, const std::byte* blocks, std::uint32_t width,
                             std::uint32_t rows, std::byte* out) {
    decode_block_row(format, blocks, width, rows, out,
                     std::size_t{decoded_texel_bytes(format)} * width);
}

}  // namespace mesh_format
