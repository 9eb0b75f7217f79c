// The mip chains of alpha masks and of the base colours under them.
#include <algorithm>
#include <array>
#include <cmath>

#include "cw2-bake/mip_chain.h"
#include "cw2-bake/row_ring.h"
#include "mesh-format/every_cpu.h"

namespace bake {
namespace {

using mesh_format::TextureFormat;

/// How many of the values between a row's texels and those at their right are at or above
/// `threshold`, `share` of the way from the one to the other. `row` has one texel more.
CW2_EVERY_CPU std::uint32_t count_shown(const float* row, std::uint32_t width, float share,
                                        float threshold) {
    std::uint32_t count = 0;
    for (std::uint32_t x = 0; x < width; ++x) {
        count += row[x] + (row[x + 1] - row[x]) * share >= threshold ? 1u : 0u;
    }
    return count;
}

CW2_EVERY_CPU void mix_rows(const float* above, const float* below, float share, float scale,
                            std::span<float> out) {
    for (std::size_t x = 0; x < out.size(); ++x) {
        const float a = std::min(above[x] * scale, 1.0f);
        const float b = std::min(below[x] * scale, 1.0f);
        out[x] = a + (b - a) * share;
    }
}

/// What a renderer shows of a mask: the share of its area at or above `threshold` where its texels,
/// times `scale` and at most 1, are filtered linearly and repeat.
double shown_share(Level& level, float scale, float threshold) {
    // Samples between neighbours, along each axis: more where there are few texels.
    const int samples = level.texels.size() > 4096 ? 2 : 8;
    std::vector<float> mixed(std::size_t{level.width} + 1);
    std::uint64_t count = 0;
    for (std::uint32_t y = 0; y < level.height; ++y) {
        const float* above = level.row(y).data();
        const float* below = level.row(neighbour(y, 1, level.height, false)).data();
        for (int j = 0; j < samples; ++j) {
            const float down = (static_cast<float>(j) + 0.5f) / static_cast<float>(samples);
            mix_rows(above, below, down, scale, std::span(mixed).first(level.width));
            mixed.back() = mixed.front();
            for (int i = 0; i < samples; ++i) {
                const float across = (static_cast<float>(i) + 0.5f) / static_cast<float>(samples);
                count += count_shown(mixed.data(), level.width, across, threshold);
            }
        }
    }
    return static_cast<double>(count) /
           (static_cast<double>(level.texels.size()) * samples * samples);
}

/// The scale that brings what is shown of the level to `share`; 1 where it is there already.
float keep_coverage(Level& level, double share, float threshold) {
    constexpr double kNear = 0.002;
    if (std::abs(shown_share(level, 1.0f, threshold) - share) <= kNear) return 1.0f;
    float low = 1.0f / 16.0f;
    float high = 64.0f;
    for (int step = 0; step < 14; ++step) {
        const float middle = std::sqrt(low * high);
        (shown_share(level, middle, threshold) < share ? low : high) = middle;
    }
    const double too_little = share - shown_share(level, low, threshold);
    const double too_much = shown_share(level, high, threshold) - share;
    return too_little < too_much ? low : high;
}

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

std::vector<std::byte> filter_mask(const TexelSource& source, float cutoff) {
    constexpr TextureFormat kFormat = TextureFormat::r8_unorm;
    std::vector<std::byte> payload(
        mesh_format::mip_chain_bytes(kFormat, source.width, source.height));
    const std::uint32_t limit = cutoff_byte(cutoff);
    const auto shown = [&](std::byte value) {
        return std::to_integer<std::uint32_t>(value) >= limit;
    };
    std::size_t covered = 0;
    TexelSource encoding = source;
    encoding.read_row = [&](std::uint32_t y, std::span<float> texels) {
        source.read_row(y, texels);
        std::byte* out = payload.data() + std::size_t{y} * source.width;
        encode_unorm8(texels, out);
        covered += static_cast<std::size_t>(std::count_if(out, out + source.width, shown));
    };
    std::vector<Level> levels = smaller_levels(encoding);
    const double share =
        static_cast<double>(covered) / (static_cast<double>(source.width) * source.height);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const std::vector<float>& texels = levels[i].texels;
        const float threshold = shown_from(cutoff);
        const float scale = keep_coverage(levels[i], share, threshold);
        std::byte* out = level_bytes(payload, kFormat, source, static_cast<std::uint32_t>(i + 1));
        for (std::size_t t = 0; t < texels.size(); ++t) {
            // Rounding must not move a texel across the cutoff.
            const auto byte =
                static_cast<std::uint32_t>(std::min(texels[t] * scale, 1.0f) * 255.0f + 0.5f);
            out[t] = static_cast<std::byte>(
                texels[t] * scale >= threshold ? std::max(byte, limit) : std::min(byte, limit - 1));
        }
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
