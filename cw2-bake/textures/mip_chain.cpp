#include "cw2-bake/textures/mip_chain.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

#include "common/every_cpu.h"
#include "cw2-bake/textures/srgb.h"

namespace bake {
namespace {

/// How a texel of a row or column is shared out: `first` of the next level takes `share` of its
/// value and the one after that `rest`.
struct Tap {
    std::uint32_t first;
    float share;
    float rest;
};

/// In units in which a texel of the source is `to` long and one of the next level `from`.
std::vector<Tap> area_taps(std::uint32_t from, std::uint32_t to) {
    std::vector<Tap> taps(from);
    for (std::uint64_t i = 0; i < from; ++i) {
        const std::uint64_t first = i * to / from;
        const std::uint64_t inside = std::min<std::uint64_t>(to, (first + 1) * from - i * to);
        taps[i] = {static_cast<std::uint32_t>(first),
                   static_cast<float>(static_cast<double>(inside) / from),
                   static_cast<float>(static_cast<double>(to - inside) / from)};
    }
    return taps;
}

/// Averages pairs of neighbours.
template <std::size_t kChannels>
void halve_row(std::span<const float> row, std::span<float> out) {
    const std::size_t count = out.size() / kChannels;
    const float* in = row.data();
    for (std::size_t x = 0; x < count; ++x, in += 2 * kChannels) {
        for (std::size_t c = 0; c < kChannels; ++c) {
            out[x * kChannels + c] = 0.5f * (in[c] + in[kChannels + c]);
        }
    }
}

template <std::size_t kChannels>
void shrink_row(std::span<const float> row, const std::vector<Tap>& taps, std::span<float> out) {
    std::fill(out.begin(), out.end(), 0.0f);
    for (std::size_t x = 0; x < taps.size(); ++x) {
        const Tap& tap = taps[x];
        for (std::size_t c = 0; c < kChannels; ++c) {
            const float value = row[x * kChannels + c];
            out[tap.first * kChannels + c] += tap.share * value;
            if (tap.rest > 0.0f) {
                out[(tap.first + 1) * kChannels + c] += tap.rest * value;
            }
        }
    }
}

template <std::size_t kChannels>
Level halve_channels(const TexelSource& source) {
    Level next{mesh_format::mip_extent(source.width, 1),
               mesh_format::mip_extent(source.height, 1),
               source.channels,
               {}};
    next.texels.resize(std::size_t{next.width} * next.height * kChannels);
    const std::vector<Tap> across = area_taps(source.width, next.width);
    const std::vector<Tap> down = area_taps(source.height, next.height);
    const bool pairs = source.width == 2 * next.width;

    std::vector<float> row(std::size_t{source.width} * kChannels);
    std::vector<float> narrow(std::size_t{next.width} * kChannels);
    const auto add = [&](std::uint32_t y, float share) {
        const std::span<float> out = next.row(y);
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] += share * narrow[i];
        }
    };
    for (std::uint32_t y = 0; y < source.height; ++y) {
        source.read_row(y, row);
        if (pairs) {
            halve_row<kChannels>(row, narrow);
        } else {
            shrink_row<kChannels>(row, across, narrow);
        }
        add(down[y].first, down[y].share);
        if (down[y].rest > 0.0f) {
            add(down[y].first + 1, down[y].rest);
        }
    }
    return next;
}

std::int32_t unorm8(float value) {
    return static_cast<std::int32_t>(std::min(std::max(value, 0.0f), 1.0f) * 255.0f + 0.5f);
}

/// The texel (r, g, b, 255).
std::uint32_t rgb_word(std::int32_t r, std::int32_t g, std::int32_t b) {
    return static_cast<std::uint32_t>(r | g << 8 | b << 16) | 0xFF00'0000u;
}

/// Squared length of a vector that has no direction.
constexpr float kSmallestSquare = 1e-12f;

}  // namespace

Level halve(const TexelSource& source) {
    switch (source.channels) {
        case 1:
            return halve_channels<1>(source);
        case 3:
            return halve_channels<3>(source);
        default:
            assert(source.channels == 4);
            return halve_channels<4>(source);
    }
}

TexelSource source_of(Level& level) {
    return {level.width, level.height, level.channels,
            [&level](std::uint32_t y, std::span<float> texels) {
                std::ranges::copy(level.row(y), texels.begin());
            }};
}

std::vector<std::byte> filter_chain(mesh_format::TextureFormat format, const TexelSource& source,
                                    const RowEncoder& encode) {
    std::vector<std::byte> payload(
        mesh_format::mip_chain_bytes(format, source.width, source.height));
    const std::uint32_t count = mesh_format::full_mip_count(source.width, source.height);
    std::byte* out = payload.data();
    TexelSource rows = source;
    Level level;
    for (std::uint32_t i = 0;; ++i) {
        const std::size_t row_bytes = std::size_t{rows.width} * mesh_format::block_bytes(format);
        TexelSource encoding = rows;
        encoding.read_row = [&](std::uint32_t y, std::span<float> texels) {
            rows.read_row(y, texels);
            if (rows.read_stored_row) {
                rows.read_stored_row(y, out + y * row_bytes);
            } else {
                encode(texels, out + y * row_bytes);
            }
        };
        // The last level's average is its one texel, and is not needed.
        Level next = halve(encoding);
        if (i + 1 == count) {
            return payload;
        }
        out += mesh_format::mip_bytes(format, source.width, source.height, i);
        level = std::move(next);
        rows = source_of(level);
    }
}

CW2_EVERY_CPU void encode_unorm8(std::span<const float> texels, std::byte* out) {
    for (std::size_t i = 0; i < texels.size(); ++i) {
        out[i] = static_cast<std::byte>(unorm8(texels[i]));
    }
}

void encode_srgb8(std::span<const float> texels, std::byte* out) {
    const SrgbTables& tables = srgb();
    for (std::size_t i = 0; i < texels.size() / 3; ++i) {
        const std::uint32_t word =
            rgb_word(tables.to_srgb8(texels[3 * i]), tables.to_srgb8(texels[3 * i + 1]),
                     tables.to_srgb8(texels[3 * i + 2]));
        std::memcpy(out + 4 * i, &word, sizeof word);
    }
}

CW2_EVERY_CPU void encode_normal8(std::span<const float> texels, std::byte* out) {
    // Blocks with the components apart: twice as fast, since SSE2 has no loads with a stride of 3.
    constexpr std::size_t kBlock = 64;
    std::array<float, kBlock> x{};
    std::array<float, kBlock> y{};
    std::array<float, kBlock> z{};
    std::array<std::uint16_t, kBlock> words{};
    for (std::size_t begin = 0; begin < texels.size() / 3; begin += kBlock) {
        const std::size_t count = std::min(kBlock, texels.size() / 3 - begin);
        for (std::size_t i = 0; i < count; ++i) {
            x[i] = texels[3 * (begin + i)];
            y[i] = texels[3 * (begin + i) + 1];
            z[i] = texels[3 * (begin + i) + 2];
        }
        for (std::size_t i = 0; i < kBlock; ++i) {
            const float square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
            const float scale = 0.5f / std::sqrt(std::max(square, kSmallestSquare));
            words[i] = static_cast<std::uint16_t>(unorm8(x[i] * scale + 0.5f) |
                                                  unorm8(y[i] * scale + 0.5f) << 8);
        }
        std::memcpy(out + 2 * begin, words.data(), 2 * count);
    }
}

}  // namespace bake
