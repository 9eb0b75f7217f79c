// Roughness that takes over the bumps which a smaller level of the normal map averages away.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cw2-bake/textures/roughness_mips.h"

namespace {

using bake::TexelSource;

TexelSource constant(std::uint32_t width, std::uint32_t height, float value) {
    return {width, height, 1,
            [value](std::uint32_t, std::span<float> texels) { std::ranges::fill(texels, value); }};
}

/// Ridges: columns tilted left and right in turns, by `angle`.
TexelSource ridges(std::uint32_t size, double angle) {
    return {size, size, 3, [angle](std::uint32_t, std::span<float> texels) {
                for (std::size_t i = 0; i < texels.size(); i += 3) {
                    texels[i] = static_cast<float>(std::sin(angle) * (i % 2 == 0 ? 1.0 : -1.0));
                    texels[i + 1] = 0.0f;
                    texels[i + 2] = static_cast<float>(std::cos(angle));
                }
            }};
}

double exponent_of(double alpha) {
    return 2.0 / std::pow(alpha, 4.0) - 2.0;
}

TEST(RoughnessMips, NormalsThatAgreeChangeNothing) {
    bake::MeanLengths lengths = bake::mean_lengths(ridges(16, 0.0));
    const auto chain = bake::filter_roughness(constant(16, 16, 0.5f), 0.6f, lengths);
    EXPECT_FALSE(chain.widened);
    EXPECT_EQ(chain.payload[0], std::byte{77}) << "0.5 times 0.6";
    EXPECT_EQ(chain.payload[256], std::byte{77});
}

TEST(RoughnessMips, TheMeanOfTwoTiltsIsAsLongAsTheirCosine) {
    const bake::MeanLengths lengths = bake::mean_lengths(ridges(8, 0.3));
    ASSERT_EQ(lengths.levels.size(), 3u);
    for (const bake::Level& level : lengths.levels) {
        for (const float length : level.texels) EXPECT_NEAR(length, std::cos(0.3), 1e-6);
    }
}

TEST(RoughnessMips, LevelZeroStaysAndTheSmallerOnesFollowToksvig) {
    constexpr double kAngle = 0.3;
    bake::MeanLengths lengths = bake::mean_lengths(ridges(16, kAngle));
    const auto chain = bake::filter_roughness(constant(16, 16, 0.2f), 1.0f, lengths);
    EXPECT_TRUE(chain.widened);
    EXPECT_EQ(chain.payload[0], std::byte{51});
    const double length = 0.5 + 0.5 * std::cos(kAngle);  // half is counted
    const double s = exponent_of(0.2);
    const double toksvig = length / (length + s * (1.0 - length));
    const double expected = std::pow(2.0 / (toksvig * s + 2.0), 0.25);
    EXPECT_GT(expected, 0.4);
    for (const std::size_t at : {256u, 256u + 64u, 256u + 64u + 16u}) {
        EXPECT_NEAR(std::to_integer<int>(chain.payload[at]), 255.0 * expected, 0.51);
    }
}

TEST(RoughnessMips, AWidenedHighlightIsAboutAsWideAsThoseItStandsFor) {
    // Mean cosine to the middle of a lobe of exponent s over the hemisphere: (s + 1) / (s + 2).
    // That of lobes which are themselves tilted by `angle` is that times the cosine of the tilt.
    for (const double alpha : {0.2, 0.35, 0.5}) {
        for (const double angle : {0.1, 0.25, 0.4}) {
            const double s = exponent_of(alpha);
            const double wanted = std::cos(angle) * (s + 1.0) / (s + 2.0);
            const double widened = exponent_of(bake::widened_roughness(
                static_cast<float>(alpha), static_cast<float>(std::cos(angle))));
            const double got = (widened + 1.0) / (widened + 2.0);
            EXPECT_NEAR(1.0 - got, 1.0 - wanted, 0.12 * (1.0 - wanted)) << alpha << ' ' << angle;
        }
    }
}

TEST(RoughnessMips, FullRoughnessStaysAndMoreSpreadIsNeverSmoother) {
    for (float length = 1.0f; length > 0.05f; length -= 0.05f) {
        EXPECT_NEAR(bake::widened_roughness(1.0f, length), 1.0f, 1e-6f);
        for (float alpha = 0.05f; alpha < 1.0f; alpha += 0.05f) {
            EXPECT_GE(bake::widened_roughness(alpha, length), alpha * 0.99999f);
            EXPECT_LE(bake::widened_roughness(alpha, length), 1.0f);
            EXPECT_LE(bake::widened_roughness(alpha, length),
                      bake::widened_roughness(alpha, length - 0.04f) * 1.00001f);
        }
    }
}

TEST(RoughnessMips, LevelsLargerThanTheNormalMapCoverNoBumps) {
    bake::MeanLengths lengths = bake::mean_lengths(ridges(8, 0.5));
    const auto chain = bake::filter_roughness(constant(32, 32, 0.2f), 1.0f, lengths);
    const std::array<std::size_t, 4> starts{0, 1024, 1024 + 256, 1024 + 256 + 64};
    EXPECT_EQ(chain.payload[starts[0]], std::byte{51});
    EXPECT_EQ(chain.payload[starts[1]], std::byte{51});
    EXPECT_EQ(chain.payload[starts[2]], std::byte{51});
    EXPECT_GT(chain.payload[starts[3]], std::byte{90});
}

}  // namespace
