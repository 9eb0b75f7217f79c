// What images mean: channels, heights, greys.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "cw2-bake/textures/texels.h"

namespace {

using bake::Channel;
using bake::Image;

Image float_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                  const std::vector<float>& samples) {
    Image image{.width = width,
                .height = height,
                .channels = channels,
                .type = bake::SampleType::f32,
                .samples = {}};
    image.samples.resize(samples.size() * sizeof(float));
    std::memcpy(image.samples.data(), samples.data(), image.samples.size());
    return image;
}

Image byte_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                 const std::vector<int>& samples) {
    Image image{.width = width, .height = height, .channels = channels, .samples = {}};
    for (const int sample : samples) {
        image.samples.push_back(static_cast<std::byte>(sample));
    }
    return image;
}

std::vector<float> row(const bake::TexelSource& source, std::uint32_t y) {
    std::vector<float> texels(std::size_t{source.width} * source.channels);
    source.read_row(y, texels);
    return texels;
}

TEST(Texels, ReadTheChannelThatIsAskedFor) {
    Image image = byte_image(1, 1, 4, {51, 102, 153, 204});
    image.has_alpha = true;
    const auto value = [&](Channel channel) {
        return row(bake::scalar_texels(image, channel), 0)[0];
    };
    EXPECT_FLOAT_EQ(value(Channel::standard), 0.2f);
    EXPECT_FLOAT_EQ(value(Channel::r), 0.2f);
    EXPECT_FLOAT_EQ(value(Channel::g), 0.4f);
    EXPECT_FLOAT_EQ(value(Channel::b), 0.6f);
    EXPECT_FLOAT_EQ(value(Channel::alpha), 0.8f);
    EXPECT_FLOAT_EQ(value(Channel::luminance), 0.2126f * 0.2f + 0.7152f * 0.4f + 0.0722f * 0.6f);
    image.has_alpha = false;
    EXPECT_FLOAT_EQ(value(Channel::alpha), 1.0f) << "a fourth channel that is not alpha";
    Image grey = byte_image(1, 1, 2, {51, 102});
    grey.has_alpha = true;
    EXPECT_FLOAT_EQ(row(bake::scalar_texels(grey, Channel::b), 0)[0], 0.2f);
    EXPECT_FLOAT_EQ(row(bake::scalar_texels(grey, Channel::alpha), 0)[0], 0.4f);
}

TEST(Texels, FloatsAreLinearLightWithinTheUnitRange) {
    const Image image = float_image(2, 1, 3,
                                    {0.5f, -3.0f, std::numeric_limits<float>::quiet_NaN(),
                                     std::numeric_limits<float>::infinity(), 40.0f, 1.0f});
    EXPECT_EQ(row(bake::color_texels(image), 0), (std::vector{0.5f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}));
    EXPECT_EQ(row(bake::scalar_texels(image, Channel::g), 0), (std::vector{0.0f, 1.0f}));
}

/// Heights rise by `dx` a column and by `dy` a row upwards.
Image ramp(std::uint32_t width, std::uint32_t height, float dx, float dy) {
    std::vector<float> samples;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            samples.push_back(dx * static_cast<float>(x) + dy * static_cast<float>(height - 1 - y));
        }
    }
    return float_image(width, height, 1, samples);
}

TEST(Heights, ASlopeGivesItsNormalWithGreenUp) {
    const Image image = ramp(9, 7, 0.02f, 0.03f);
    const bake::TexelSource normals =
        bake::normal_texels_of_heights(image, Channel::standard, 10.0f, false);
    const double length = std::sqrt(0.2 * 0.2 + 0.3 * 0.3 + 1.0);
    for (std::uint32_t y = 1; y < 6; ++y) {
        const std::vector<float> texels = row(normals, y);
        for (std::size_t x = 1; x < 8; ++x) {
            // It faces away from where the ground rises: right and up.
            EXPECT_NEAR(texels[3 * x], -0.2 / length, 1e-5);
            EXPECT_NEAR(texels[3 * x + 1], -0.3 / length, 1e-5);
            EXPECT_NEAR(texels[3 * x + 2], 1.0 / length, 1e-5);
        }
    }
}

TEST(Heights, RepeatAtTheBordersUnlessClamped) {
    const Image image = ramp(4, 4, 0.25f, 0.0f);
    const auto slope = [&](bool clamp, std::size_t x) {
        const std::vector<float> texels =
            row(bake::normal_texels_of_heights(image, Channel::standard, 1.0f, clamp), 2);
        return -texels[3 * x] / texels[3 * x + 2];
    };
    EXPECT_NEAR(slope(false, 0), 0.5 * (0.25 - 0.75), 1e-6);
    EXPECT_NEAR(slope(false, 3), 0.5 * (0.0 - 0.5), 1e-6);
    EXPECT_NEAR(slope(true, 0), 0.5 * 0.25, 1e-6);
    EXPECT_NEAR(slope(true, 3), 0.5 * 0.25, 1e-6);
    const Image upright = ramp(4, 4, 0.0f, 0.25f);
    const auto rise = [&](bool clamp, std::uint32_t y) {
        const std::vector<float> texels =
            row(bake::normal_texels_of_heights(upright, Channel::standard, 1.0f, clamp), y);
        return -texels[1] / texels[2];
    };
    EXPECT_NEAR(rise(false, 0), 0.5 * (0.0 - 0.5), 1e-6);
    EXPECT_NEAR(rise(false, 3), 0.5 * (0.25 - 0.75), 1e-6);
    EXPECT_NEAR(rise(true, 0), 0.5 * 0.25, 1e-6);
}

TEST(Heights, AWaveThatRepeatsHasTheSlopesOfItsDerivativeEverywhere) {
    constexpr std::uint32_t kSize = 64;
    const double frequency = 2.0 * std::numbers::pi / kSize;
    std::vector<float> samples;
    for (std::uint32_t y = 0; y < kSize; ++y) {
        for (std::uint32_t x = 0; x < kSize; ++x) {
            samples.push_back(
                static_cast<float>(std::sin(frequency * x) + std::cos(frequency * y)));
        }
    }
    const Image image = float_image(kSize, kSize, 1, samples);
    const bake::TexelSource normals =
        bake::normal_texels_of_heights(image, Channel::r, 5.0f, false);
    for (std::uint32_t y = 0; y < kSize; ++y) {
        const std::vector<float> texels = row(normals, y);
        for (std::uint32_t x = 0; x < kSize; ++x) {
            const float* n = texels.data() + std::size_t{3} * x;
            EXPECT_NEAR(-n[0] / n[2], 5.0 * frequency * std::cos(frequency * x), 2e-3);
            EXPECT_NEAR(-n[1] / n[2], 5.0 * frequency * std::sin(frequency * y), 2e-3);
        }
    }
}

TEST(Grey, IsOneChannelOrThreeEqualButForNoise) {
    EXPECT_TRUE(bake::is_grey(byte_image(1, 1, 1, {7})));
    EXPECT_TRUE(bake::is_grey(byte_image(1, 1, 2, {7, 200})));
    EXPECT_TRUE(bake::is_grey(byte_image(2, 1, 3, {7, 7, 7, 99, 101, 98})));
    EXPECT_TRUE(bake::is_grey(byte_image(1, 1, 4, {7, 7, 7, 200})));
    EXPECT_FALSE(bake::is_grey(byte_image(2, 1, 3, {7, 7, 7, 128, 128, 255})));
}

TEST(MaskedColour, IsShownWhereItCoversAShownTexelOfAMaskOfAnotherSize) {
    const Image color = byte_image(4, 2, 3, std::vector<int>(24, 255));
    const auto shown = [&](const Image& mask) {
        const bake::TexelSource texels =
            bake::masked_color_texels(color, bake::scalar_texels(mask, Channel::r), 0.5f);
        std::string map;
        for (std::uint32_t y = 0; y < 2; ++y) {
            const std::vector<float> texel = row(texels, y);
            for (std::size_t x = 0; x < 4; ++x) {
                EXPECT_EQ(texel[4 * x], texel[4 * x + 3]);
                map += texel[4 * x + 3] > 0.0f ? '#' : '.';
            }
        }
        return map;
    };
    EXPECT_EQ(shown(byte_image(2, 1, 1, {128, 127})), "##..##..");
    EXPECT_EQ(shown(byte_image(8, 2, 1, {0, 0, 0, 128, 0, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0})),
              ".#..#...");
    EXPECT_EQ(shown(byte_image(3, 1, 1, {0, 255, 0})), ".##..##.");
}

}  // namespace
