// The mip chains of alpha masks and of the base colours under them.
#include <algorithm>
#include <array>

#include "cw2-bake/textures/block_compression.h"
#include "cw2-bake/textures/mask_coverage.h"
#include "cw2-bake/textures/mip_chain.h"
#include "cw2-bake/textures/row_ring.h"

namespace bake {
namespace {

using mesh_format::TextureFormat;

/// Divides by the weight in the fourth channel, which becomes 1, or 0 where nothing counts.
void undo_weights(Level& level) {
    for (std::size_t i = 0; i < level.texels.size(); i += 4) {
        float* texel = level.texels.data() + i;
        const float scale = texel[3] > 0.0f ? 1.0f / texel[3] : 0.0f;
        for (int c = 0; c < 3; ++c) {
            texel[c] *= scale;
        }
        texel[3] = texel[3] > 0.0f ? 1.0f : 0.0f;
    }
}

/// The colours alone.
void drop_weights(const std::vector<float>& texels, std::vector<float>& colors) {
    colors.resize(texels.size() / 4 * 3);
    for (std::size_t i = 0; i < texels.size() / 4; ++i) {
        std::copy_n(texels.data() + 4 * i, 3, colors.data() + 3 * i);
    }
}

/// Three neighbouring rows of 4-channel texels, the middle one to be filled.
using RowTriple = std::array<const float*, 3>;

/// The mean of the texels that count among the eight around x; false if there are none.
bool mean_of_neighbours(const RowTriple& rows, std::uint32_t x, std::uint32_t width, bool clamp,
                        float* out) {
    const std::uint32_t left = x > 0 ? x - 1 : clamp ? x : width - 1;
    const std::uint32_t right = x + 1 < width ? x + 1 : clamp ? x : 0;
    std::array<float, 4> sum{};
    for (const float* row : rows) {
        for (const std::uint32_t column : {left, x, right}) {
            const float* texel = row + std::size_t{4} * column;
            for (int c = 0; c < 4; ++c) {
                sum[c] += texel[3] * texel[c];
            }
        }
    }
    if (sum[3] == 0.0f) {
        return false;
    }
    for (int c = 0; c < 3; ++c) {
        out[c] = sum[c] / sum[3];
    }
    return true;
}

/// Writes the middle row's colours to `out` (3 channels): its own where they count, else those of
/// the neighbours, else those of `coarser`, the row of the next level that covers it.
void fill_row(const RowTriple& rows, std::uint32_t width, bool clamp,
              std::span<const float> coarser, std::span<float> out) {
    const std::size_t last = coarser.size() / 4 - 1;
    for (std::uint32_t x = 0; x < width; ++x) {
        const float* texel = rows[1] + std::size_t{4} * x;
        float* color = out.data() + std::size_t{3} * x;
        if (texel[3] > 0.0f) {
            std::copy_n(texel, 3, color);
        } else if (!mean_of_neighbours(rows, x, width, clamp, color)) {
            std::copy_n(coarser.data() + 4 * std::min<std::size_t>(x / 2, last), 3, color);
        }
    }
}

/// Fills what does not count in `level` from itself and from `coarser`, which is filled.
void fill_level(Level& level, Level& coarser, bool clamp) {
    std::vector<float> colors(std::size_t{3} * level.width);
    for (std::uint32_t y = 0; y < level.height; ++y) {
        const RowTriple rows{level.row(neighbour(y, -1, level.height, clamp)).data(),
                             level.row(y).data(),
                             level.row(neighbour(y, 1, level.height, clamp)).data()};
        fill_row(rows, level.width, clamp, coarser.row(std::min(y / 2, coarser.height - 1)),
                 colors);
        // The weight stays, so that a filled texel does not count for its neighbours.
        for (std::uint32_t x = 0; x < level.width; ++x) {
            std::copy_n(colors.data() + std::size_t{3} * x, 3,
                        level.row(y).data() + std::size_t{4} * x);
        }
    }
}

/// All levels but the first.
std::vector<Level> smaller_levels(const TexelSource& source) {
    std::vector<Level> levels;
    const std::uint32_t count = mesh_format::full_mip_count(source.width, source.height);
    levels.reserve(count);  // sources refer to the levels
    while (levels.size() + 1 < count) {
        levels.push_back(halve(levels.empty() ? source : source_of(levels.back())));
    }
    return levels;
}

std::byte* level_bytes(std::vector<std::byte>& payload, TextureFormat format,
                       const TexelSource& source, std::uint32_t level) {
    std::size_t offset = 0;
    for (std::uint32_t i = 0; i < level; ++i) {
        offset += mesh_format::mip_bytes(format, source.width, source.height, i);
    }
    return payload.data() + offset;
}

}  // namespace

std::uint32_t cutoff_byte(float cutoff) {
    std::uint32_t byte = 0;
    while (byte < 255 && static_cast<float>(byte) / 255.0f < cutoff) {
        ++byte;
    }
    return byte;
}

float shown_from(float cutoff) {
    return (static_cast<float>(cutoff_byte(cutoff)) - 0.5f) / 255.0f;
}

bool hides_its_edges(std::span<const std::byte> texels, std::uint32_t width, std::uint32_t height,
                     float cutoff) {
    const auto limit = static_cast<std::byte>(cutoff_byte(cutoff));
    const auto hides = [&](std::size_t texel) { return texels[texel] < limit; };
    const std::size_t row = width;
    for (std::size_t x = 0; x < row; ++x)
        if (!hides(x) || !hides((height - 1) * row + x)) return false;
    for (std::size_t y = 0; y < height; ++y)
        if (!hides(y * row) || !hides(y * row + row - 1)) return false;
    return true;
}

std::vector<std::byte> filter_mask(const TexelSource& source, const MaskUse& use) {
    constexpr TextureFormat kFormat = TextureFormat::r8_unorm;
    std::vector<std::byte> payload(
        mesh_format::mip_chain_bytes(kFormat, source.width, source.height));
    TexelSource encoding = source;
    encoding.read_row = [&](std::uint32_t y, std::span<float> texels) {
        source.read_row(y, texels);
        encode_unorm8(texels, payload.data() + std::size_t{y} * source.width);
    };
    std::vector<Level> levels = smaller_levels(encoding);
    const std::span<const std::byte> first(payload.data(),
                                           std::size_t{source.width} * source.height);
    MaskUse stored = use;
    stored.blocks &= fits_blocks({first.data(), source.width, source.height}, use.cutoff);
    MaskCoverage coverage(first, source.width, source.height, stored);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const auto number = static_cast<std::uint32_t>(i + 1);
        coverage.store_next(levels[i], level_bytes(payload, kFormat, source, number));
    }
    return payload;
}

std::vector<std::byte> filter_masked_color(const TexelSource& source, bool clamp) {
    constexpr TextureFormat kFormat = TextureFormat::rgba8_srgb;
    std::vector<std::byte> payload(
        mesh_format::mip_chain_bytes(kFormat, source.width, source.height));
    std::vector<Level> levels = smaller_levels(source);
    for (Level& level : levels) {
        undo_weights(level);
    }
    // The last level has one texel, which counts; so every level finds a coarser one to fill from.
    for (std::size_t i = levels.size(); i-- > 1;) {
        fill_level(levels[i - 1], levels[i], clamp);
    }
    std::vector<float> colors;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        std::byte* out = level_bytes(payload, kFormat, source, static_cast<std::uint32_t>(i + 1));
        drop_weights(levels[i].texels, colors);
        encode_srgb8(colors, out);
    }
    RowRing ring(source, clamp);
    const std::array<float, 4> none{};
    for (std::uint32_t y = 0; y < source.height; ++y) {
        colors.resize(std::size_t{3} * source.width);
        const std::span<const float> coarser =
            levels.empty() ? std::span<const float>(none)
                           : levels[0].row(std::min(y / 2, levels[0].height - 1));
        fill_row({ring.row(y, -1), ring.row(y, 0), ring.row(y, 1)}, source.width, clamp, coarser,
                 colors);
        encode_srgb8(colors, payload.data() + std::size_t{4} * source.width * y);
    }
    return payload;
}

}  // namespace bake
