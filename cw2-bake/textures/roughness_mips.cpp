#include "cw2-bake/textures/roughness_mips.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "common/every_cpu.h"

namespace bake {
namespace {

/// What the shader makes of smaller ones.
constexpr float kSmallestAlpha = 0.045f;
/// In 8 bits; smaller differences are rounding or a JPEG's noise.
constexpr int kInvisible = 2;
/// How much of what a mean lacks in length counts. Measured in Sponza against the same view drawn
/// with nine times the pixels: none 34.47 dB, half 34.74, three quarters 34.62, all 34.44.
constexpr float kShare = 0.5f;

/// The lengths beside row `y` of a level of this size; empty where the normal map is no larger.
std::span<const float> row_beside(MeanLengths& lengths, std::uint32_t y, std::uint32_t width,
                                  std::uint32_t height) {
    if (lengths.width <= width && lengths.height <= height) return {};
    for (Level& level : lengths.levels) {
        if (level.width > width || level.height > height) continue;
        return level.row(static_cast<std::uint32_t>(std::uint64_t{y} * level.height / height));
    }
    return {};
}

/// The lengths of vectors.
CW2_EVERY_CPU void measure(std::span<const float> vectors, std::span<float> lengths) {
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const float* n = vectors.data() + 3 * i;
        lengths[i] = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
}

}  // namespace

MeanLengths mean_lengths(const TexelSource& normals) {
    MeanLengths lengths{normals.width, normals.height, {}};
    TexelSource rows = normals;
    Level means;
    while (rows.width > 1 || rows.height > 1) {
        // What is averaged must not be overwritten while it is read.
        Level next = halve(rows);
        means = std::move(next);
        rows = source_of(means);
        lengths.levels.push_back({means.width, means.height, 1, {}});
        lengths.levels.back().texels.resize(means.texels.size() / 3);
        measure(means.texels, lengths.levels.back().texels);
    }
    return lengths;
}

RowEncoder measuring(RowEncoder encode, MeanLengths& lengths) {
    return [encode = std::move(encode), &lengths, level = 0u, y = 0u](std::span<const float> texels,
                                                                      std::byte* out) mutable {
        encode(texels, out);
        const auto width = static_cast<std::uint32_t>(texels.size() / 3);
        const std::uint32_t height = mesh_format::mip_extent(lengths.height, level);
        if (level > 0) {
            if (y == 0) lengths.levels.push_back({width, height, 1, {}});
            lengths.levels.back().texels.resize(std::size_t{width} * height);
            measure(texels, lengths.levels.back().row(y));
        }
        if (++y == height) {
            y = 0;
            ++level;
        }
    };
}

float widened_roughness(float alpha, float length) {
    if (length >= 1.0f) return alpha;
    const float square = std::max(alpha, kSmallestAlpha) * std::max(alpha, kSmallestAlpha);
    const float exponent = 2.0f / (square * square) - 2.0f;
    const float kept = length / (length + exponent * (1.0f - length));
    return std::sqrt(std::sqrt(2.0f / (kept * exponent + 2.0f)));
}

RoughnessChain filter_roughness(const TexelSource& alphas, float factor, MeanLengths& lengths) {
    const TexelSource source{alphas.width, alphas.height, 1,
                             [&](std::uint32_t y, std::span<float> texels) {
                                 alphas.read_row(y, texels);
                                 for (float& value : texels) value *= factor;
                             }};
    RoughnessChain chain{{}, false};
    std::uint32_t level = 0;
    std::uint32_t y = 0;
    std::vector<float> widened(alphas.width);
    std::vector<std::byte> plain(alphas.width);
    // Rows come in order, level after level.
    const RowEncoder encode = [&](std::span<const float> texels, std::byte* out) {
        encode_unorm8(texels, out);
        const auto width = static_cast<std::uint32_t>(texels.size());
        const std::uint32_t height = mesh_format::mip_extent(alphas.height, level);
        const std::span<const float> beside =
            level > 0 ? row_beside(lengths, y, width, height) : std::span<const float>();
        if (!beside.empty()) {
            for (std::size_t x = 0; x < width; ++x) {
                const float length = 1.0f - kShare * (1.0f - beside[x * beside.size() / width]);
                widened[x] = widened_roughness(texels[x], length);
            }
            std::copy_n(out, width, plain.begin());
            encode_unorm8(std::span(widened).first(width), out);
            for (std::size_t x = 0; x < width && !chain.widened; ++x) {
                chain.widened = std::abs(std::to_integer<int>(out[x]) -
                                         std::to_integer<int>(plain[x])) > kInvisible;
            }
        }
        if (++y == height) {
            y = 0;
            ++level;
        }
    };
    chain.payload = filter_chain(mesh_format::TextureFormat::r8_unorm, source, encode);
    return chain;
}

}  // namespace bake
