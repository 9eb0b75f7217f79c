// False colours, and the scale that explains them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <string>
#include <vector>

#include "cw2/render/legend.h"
#include "shaders/false_color.h"

namespace {

using namespace cw2;
using glm::dmat3;
using glm::dvec3;

/// Oklab of a linear sRGB colour, by the matrices of its definition from the colour to the cone
/// responses and from their cube roots to Oklab.
dvec3 oklab_of(const dvec3& rgb) {
    const dmat3 cones_from_rgb(0.4122214708, 0.2119034982, 0.0883024619,  //
                               0.5363325363, 0.6806995451, 0.2817188376,  //
                               0.0514459929, 0.1073969566, 0.6299787005);
    const dmat3 oklab_from_roots(0.2104542553, 1.9779984951, 0.0259040371,   //
                                 0.7936177850, -2.4285922050, 0.7827717662,  //
                                 -0.0040720468, 0.4505937099, -0.8086757660);
    const dvec3 cones = cones_from_rgb * rgb;
    return oklab_from_roots * dvec3(std::cbrt(cones.x), std::cbrt(cones.y), std::cbrt(cones.z));
}

TEST(FalseColor, EqualStepsLookEquallyLargeAndEverLighter) {
    constexpr int kSteps = 200;
    const auto at = [](int i) {
        return oklab_of(dvec3(interop::false_color(static_cast<float>(i) / kSteps)));
    };
    const double first = glm::distance(at(0), at(1));
    for (int i = 0; i < kSteps; ++i) {
        EXPECT_NEAR(glm::distance(at(i), at(i + 1)), first, 0.01 * first) << i;
        EXPECT_GT(at(i + 1).x, at(i).x) << i;
    }
}

TEST(FalseColor, EveryColorCanBeShown) {
    for (int i = 0; i <= 1000; ++i) {
        const glm::vec3 color = interop::false_color(static_cast<float>(i) / 1000.0f);
        for (int c = 0; c < 3; ++c) {
            EXPECT_GE(color[c], 0.0f) << i;
            EXPECT_LE(color[c], 1.0f) << i;
        }
    }
}

TEST(FalseColor, PositionsFollowTheRange) {
    const auto position = interop::false_color_position;
    EXPECT_EQ(position(0.25f, 0.0f, 0.5f), 0.5f);
    EXPECT_EQ(position(-1.0f, -2.0f, 2.0f), 0.25f);
    EXPECT_NEAR(position(1.0f, 0.01f, 100.0f), 0.5f, 1e-6);
    EXPECT_NEAR(position(10.0f, 0.01f, 100.0f), 0.75f, 1e-6);
    for (const float low : {0.0f, 0.01f}) {
        EXPECT_EQ(position(-5.0f, low, 1.0f), 0.0f);
        EXPECT_EQ(position(0.0f, low, 1.0f), 0.0f);
        EXPECT_EQ(position(5.0f, low, 1.0f), 1.0f);
    }
}

std::vector<std::string> labels_of(const ValueRange& range) {
    std::vector<std::string> labels;
    for (const Tick& tick : ticks_of(range)) labels.push_back(tick.label);
    return labels;
}

TEST(Legend, TicksAreRoundNumbers) {
    using Labels = std::vector<std::string>;
    EXPECT_EQ(labels_of({0.01f, 1e4f}), (Labels{"0.01", "1e4", "0.1", "1", "10", "100", "1e3"}));
    EXPECT_EQ(labels_of({0.0f, 0.32f}), (Labels{"0", "0.32", "0.08", "0.16", "0.24"}));
    EXPECT_EQ(labels_of({0.5f, 20.0f}), (Labels{"0.5", "20", "1", "10"}));
    EXPECT_EQ(labels_of({2.0f, 3.0f}), (Labels{"2", "3"}));
    EXPECT_EQ(labels_of({1e-7f, 1e-6f}), (Labels{"1e-7", "1e-6"}));
    EXPECT_EQ(labels_of({-1500.0f, 0.0f}).front(), "-1.5e3");
}

TEST(Legend, EveryTickStandsAtItsValue) {
    for (View view = 0; view < interop::kViewCount; ++view) {
        const ValueRange& range = kViews[view].range;
        for (const Tick& tick : ticks_of(range)) {
            const double value = std::stod(tick.label);
            const double at =
                range.low > 0.0f
                    ? std::log10(value / range.low) / std::log10(range.high / double{range.low})
                    : (value - range.low) / (double{range.high} - range.low);
            EXPECT_NEAR(tick.position, at, 1e-5) << kViews[view].name << ' ' << tick.label;
        }
    }
}

constexpr std::uint32_t kWidth = 640;

/// A grey picture with a legend from the column `left` on.
std::vector<std::byte> picture_with_legend(std::uint32_t height, std::uint32_t left,
                                           std::uint32_t right) {
    std::vector<std::byte> pixels(std::size_t{kWidth} * height * 4, std::byte{128});
    draw_legend(pixels, kWidth, height, left, right, {0.01f, 100.0f});
    return pixels;
}

TEST(Legend, HasEveryColorOfTheScaleInOrder) {
    const auto pixels = picture_with_legend(360, 100, 600);
    std::vector<float> positions;
    // The bar is about two thirds up from the bottom of the legend.
    for (std::uint32_t x = 0; x < kWidth; ++x) {
        const std::byte* const pixel = &pixels[(std::size_t{kWidth} * (360 - 30) + x) * 4];
        const glm::u8vec3 color(std::to_integer<int>(pixel[0]), std::to_integer<int>(pixel[1]),
                                std::to_integer<int>(pixel[2]));
        const float position = static_cast<float>(positions.size()) / 400.0f;
        if (color == false_color_bytes(position + 0.5f / 400.0f)) positions.push_back(position);
    }
    EXPECT_EQ(positions.size(), 400u);
}

TEST(Legend, StaysWithinItsColumnsOrAway) {
    for (const std::uint32_t height : {8u, 20u, 180u, 360u, 1080u}) {
        for (const std::uint32_t left : {0u, 33u, 320u}) {
            for (const std::uint32_t right : {320u, 400u, 600u, 640u}) {
                const auto pixels = picture_with_legend(height, left, right);
                for (std::size_t i = 0; i < pixels.size() / 4; ++i) {
                    if (i % kWidth >= left && i % kWidth < right) continue;
                    ASSERT_EQ(pixels[4 * i], std::byte{128});
                }
            }
        }
    }
    const auto empty = picture_with_legend(20, 0, 640);
    EXPECT_EQ(std::count(empty.begin(), empty.end(), std::byte{128}),
              static_cast<std::ptrdiff_t>(empty.size()));
}

}  // namespace
