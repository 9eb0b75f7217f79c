#include "mesh-format/blocks.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "mesh-format/bc7.h"

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

/// The 16 colours of a BC7 block: eight of subset 0, then those of subset 1.
std::array<std::uint32_t, 16> bc7_colors_of(std::uint64_t low, std::uint64_t high) {
    const auto bits = [=](std::uint32_t at) {
        return at >= 64 ? high >> (at - 64) : low >> at | high << (64 - at);
    };
    std::array<std::uint32_t, 16> colors;
    colors.fill(0xFF00'0000u);
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::uint32_t subset = 0; subset < 2; ++subset) {
            const std::uint32_t lowest = bits(kBc7LowBits + subset) & 1;
            const auto end = [&](std::uint32_t i) {
                const std::uint32_t at = kBc7Ends + 6 * (4 * c + 2 * subset + i);
                return expand_bc7(static_cast<std::uint32_t>(bits(at) & 63), lowest);
            };
            const std::uint32_t first = end(0);
            const std::uint32_t second = end(1);
            for (std::uint32_t step = 0; step < 8; ++step) {
                const auto weight = static_cast<std::uint32_t>(kBc7Weights[step]);
                colors[8 * subset + step] |=
                    ((64 - weight) * first + weight * second + 32) >> 6 << 8 * c;
            }
        }
    }
    return colors;
}

/// As decode_bc1().
void decode_bc7(const std::byte* block, std::byte* out, std::size_t stride) {
    const auto low = load<std::uint64_t>(block);
    const auto high = load<std::uint64_t>(block + 8);
    const std::uint64_t partition = low >> 2 & 63;
    std::array<std::uint32_t, 16> colors;
    colors.fill(0xFF00'0000u);
    std::uint32_t subsets = 0;
    if ((low & 3) == 2 && partition < kBc7Partitions) {
        colors = bc7_colors_of(low, high);
        subsets = kBc7Subsets[partition];
    }
    // The first texel's step gets a third bit.
    const std::uint64_t stored = high >> (kBc7Steps - 64);
    std::uint64_t steps = (stored & ~std::uint64_t{3}) << 1 | (stored & 3);
    for (int y = 0; y < 4; ++y, out += stride) {
        for (std::size_t x = 0; x < 4; ++x, steps >>= 3, subsets >>= 1) {
            std::memcpy(out + 4 * x, &colors[(subsets & 1) << 3 | (steps & 7)], 4);
        }
    }
}

void decode_block(TextureFormat format, const std::byte* block, std::byte* out,
                  std::size_t stride) {
    switch (format) {
        case TextureFormat::bc1_srgb:
            return decode_bc1(block, out, stride);
        case TextureFormat::bc7_srgb:
            return decode_bc7(block, out, stride);
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
