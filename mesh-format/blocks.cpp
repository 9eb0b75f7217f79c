#include "mesh-format/blocks.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace mesh_format {
namespace {

/// The word in the little-endian bytes at `bytes`.
template <typename Word>
Word load(const std::byte* bytes) {
    Word word;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

/// Red, green and blue of a 5:6:5 colour, 8 bits each.
std::array<std::uint32_t, 3> expand_565(std::uint32_t color) {
    const std::uint32_t r = color >> 11;
    const std::uint32_t g = color >> 5 & 63;
    const std::uint32_t b = color & 31;
    return {r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2};
}

/// The four colours of a BC1 block.
std::array<std::uint32_t, 4> colors_of(const std::byte* block) {
    const auto first = load<std::uint16_t>(block);
    const auto second = load<std::uint16_t>(block + 2);
    const auto a = expand_565(first);
    const auto b = expand_565(second);
    std::array<std::uint32_t, 4> colors;
    colors.fill(0xFF00'0000u);
    for (std::size_t c = 0; c < 3; ++c) {
        const bool four = first > second;
        const std::uint32_t between = four ? (2 * a[c] + b[c] + 1) / 3 : (a[c] + b[c] + 1) / 2;
        const std::uint32_t last = four ? (a[c] + 2 * b[c] + 1) / 3 : 0;
        colors[0] |= a[c] << 8 * c;
        colors[1] |= b[c] << 8 * c;
        colors[2] |= between << 8 * c;
        colors[3] |= last << 8 * c;
    }
    return colors;
}

/// The eight values of a BC4 block.
std::array<std::uint8_t, 8> values_of(const std::byte* block) {
    const auto a = std::to_integer<std::uint32_t>(block[0]);
    const auto b = std::to_integer<std::uint32_t>(block[1]);
    const std::uint32_t steps = a > b ? 7 : 5;
    std::array<std::uint8_t, 8> values{static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)};
    for (std::uint32_t i = 1; i < steps; ++i) {
        values[i + 1] = static_cast<std::uint8_t>(((steps - i) * a + i * b + steps / 2) / steps);
    }
    if (steps == 5) {
        values[6] = 0;
        values[7] = 255;
    }
    return values;
}

/// Writes 4 x 4 words of colours; a row is `stride` bytes after the one above it.
void decode_bc1(const std::byte* block, std::byte* out, std::size_t stride) {
    const std::array<std::uint32_t, 4> colors = colors_of(block);
    auto indices = load<std::uint32_t>(block + 4);
    for (int y = 0; y < 4; ++y, out += stride) {
        for (std::size_t x = 0; x < 4; ++x, indices >>= 2) {
            std::memcpy(out + 4 * x, &colors[indices & 3], 4);
        }
    }
}

/// As above, one byte a texel, each `step` bytes after the one before it.
void decode_bc4(const std::byte* block, std::byte* out, std::size_t stride, std::size_t step) {
    const std::array<std::uint8_t, 8> values = values_of(block);
    std::uint64_t indices = load<std::uint64_t>(block) >> 16;
    for (int y = 0; y < 4; ++y, out += stride) {
        for (std::size_t x = 0; x < 4; ++x, indices >>= 3) {
            out[step * x] = static_cast<std::byte>(values[indices & 7]);
        }
    }
}

void decode_block(TextureFormat format, const std::byte* block, std::byte* out,
                  std::size_t stride) {
    switch (format) {
        case TextureFormat::bc1_srgb:
            return decode_bc1(block, out, stride);
        case TextureFormat::bc4_unorm:
            return decode_bc4(block, out, stride, 1);
        default:
            assert(format == TextureFormat::bc5_unorm);
            decode_bc4(block, out, stride, 2);
            decode_bc4(block + 8, out + 1, stride, 2);
    }
}

}  // namespace

void decode_block_row(TextureFormat format, const std::byte* blocks, std::uint32_t width,
                      std::uint32_t rows, std::byte* out, std::size_t pitch) {
    const std::size_t texel = decoded_texel_bytes(format);
    for (std::uint32_t x = 0; x < width; x += 4, blocks += block_bytes(format)) {
        const std::uint32_t columns = std::min(width - x, 4u);
        std::byte* const place = out + texel * x;
        if (columns == 4 && rows == 4) {
            decode_block(format, blocks, place, pitch);
            continue;
        }
        std::array<std::byte, 64> whole;
        decode_block(format, blocks, whole.data(), 4 * texel);
        for (std::uint32_t y = 0; y < rows; ++y) {
            std::memcpy(place + y * pitch, whole.data() + y * 4 * texel, columns * texel);
        }
    }
}

}  // namespace mesh_format
