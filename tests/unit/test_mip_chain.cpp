// Mip chains against plain double-precision averages.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "cw2-bake/textures/mip_chain.h"
#include "cw2-bake/textures/srgb.h"
#include "cw2-bake/textures/texels.h"
#include "tests/support/srgb_truth.h"

namespace {

using bake::Image;
using mesh_format::TextureFormat;
using Payload = std::vector<std::byte>;

Image byte_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                 const std::function<int(std::uint32_t, std::uint32_t, std::uint32_t)>& value) {
    Image image{.width = width, .height = height, .channels = channels, .samples = {}};
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            for (std::uint32_t c = 0; c < channels; ++c) {
                image.samples.push_back(static_cast<std::byte>(value(x, y, c)));
            }
        }
    }
    return image;
}

Image noise_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                  std::uint32_t seed) {
    std::mt19937 random(seed);
    return byte_image(width, height, channels, [&](auto...) { return random() & 255; });
}

/// The bytes of one level without padding.
std::vector<int> level_of(const Payload& payload, TextureFormat format, std::uint32_t width,
                          std::uint32_t height, std::uint32_t level) {
    std::size_t offset = 0;
    for (std::uint32_t i = 0; i < level; ++i) {
        offset += mesh_format::mip_bytes(format, width, height, i);
    }
    const std::size_t count = std::size_t{mesh_format::mip_extent(width, level)} *
                              mesh_format::mip_extent(height, level) *
                              mesh_format::block_bytes(format);
    std::vector<int> bytes;
    for (std::size_t i = 0; i < count; ++i) {
        bytes.push_back(std::to_integer<int>(payload[offset + i]));
    }
    return bytes;
}

/// One channel in double precision: the integral of each texel's area over the level above.
struct Reference {
    std::uint32_t width;
    std::uint32_t height;
    std::vector<double> texels;

    static double overlap(double a0, double a1, double b0, double b1) {
        return std::max(0.0, std::min(a1, b1) - std::max(a0, b0));
    }

    Reference next() const {
        Reference out{std::max(1u, width / 2), std::max(1u, height / 2), {}};
        const double sx = static_cast<double>(width) / out.width;
        const double sy = static_cast<double>(height) / out.height;
        for (std::uint32_t oy = 0; oy < out.height; ++oy) {
            for (std::uint32_t ox = 0; ox < out.width; ++ox) {
                double sum = 0.0;
                for (auto y = static_cast<std::uint32_t>(oy * sy); y < height && y < (oy + 1) * sy;
                     ++y) {
                    for (auto x = static_cast<std::uint32_t>(ox * sx);
                         x < width && x < (ox + 1) * sx; ++x) {
                        sum += overlap(x, x + 1, ox * sx, (ox + 1) * sx) *
                               overlap(y, y + 1, oy * sy, (oy + 1) * sy) *
                               texels[std::size_t{y} * width + x];
                    }
                }
                out.texels.push_back(sum / (sx * sy));
            }
        }
        return out;
    }

    double mean() const {
        double sum = 0.0;
        for (const double texel : texels) {
            sum += texel;
        }
        return sum / static_cast<double>(texels.size());
    }
};

TEST(Srgb, ReturnsEveryByteAndRoundsToTheNearest) {
    for (int i = 0; i < 256; ++i) {
        const float linear = bake::srgb().to_linear(static_cast<std::uint8_t>(i));
        EXPECT_NEAR(linear, linear_of_srgb(i / 255.0), 1e-7);
        EXPECT_EQ(bake::srgb().to_srgb8(linear), i);
    }
    for (int i = 0; i <= 100'000; ++i) {
        const float linear = static_cast<float>(i) / 100'000.0f;
        const double exact = srgb_of_linear(linear) * 255.0;
        EXPECT_LE(std::abs(bake::srgb().to_srgb8(linear) - exact), 0.5001) << linear;
    }
    EXPECT_EQ(bake::srgb().to_srgb8(-1.0f), 0);
    EXPECT_EQ(bake::srgb().to_srgb8(7.0f), 255);
    for (int i = 0; i < 65'536; i += 17) {
        EXPECT_NEAR(bake::srgb().to_linear(static_cast<std::uint16_t>(i)),
                    linear_of_srgb(i / 65'535.0), 1e-7);
    }
}

TEST(MipChain, AveragesColoursInLinearLight) {
    const Image checker =
        byte_image(16, 16, 3, [](auto x, auto y, auto) { return (x + y) % 2 ? 255 : 0; });
    constexpr auto kFormat = TextureFormat::rgba8_srgb;
    const Payload payload =
        bake::filter_chain(kFormat, bake::color_texels(checker), bake::encode_srgb8);
    const std::vector<int> top = level_of(payload, kFormat, 16, 16, 0);
    EXPECT_EQ(top[0], 0);
    EXPECT_EQ(top[4], 255);
    for (std::uint32_t level = 1; level < 5; ++level) {
        const std::vector<int> bytes = level_of(payload, kFormat, 16, 16, level);
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            EXPECT_EQ(bytes[i], i % 4 == 3 ? 255 : 188) << "level " << level;
        }
    }
}

TEST(MipChain, EveryLevelIsTheAreaAverageOfTheLevelAboveForAnySize) {
    constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {
        {1, 1}, {2, 1}, {1, 7}, {3, 3}, {5, 8}, {6, 7}, {17, 33}, {255, 254}, {511, 3}, {64, 64}};
    for (const auto& [width, height] : kSizes) {
        SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
        const Image image = noise_image(width, height, 1, width * 1000 + height);
        const bake::TexelSource source = bake::scalar_texels(image, bake::Channel::standard);
        const Payload payload =
            bake::filter_chain(TextureFormat::r8_unorm, source, bake::encode_unorm8);
        ASSERT_EQ(payload.size(),
                  mesh_format::mip_chain_bytes(TextureFormat::r8_unorm, width, height));

        Reference reference{width, height, {}};
        for (const std::byte sample : image.samples) {
            reference.texels.push_back(std::to_integer<int>(sample) / 255.0);
        }
        const double mean = reference.mean();
        bake::Level level;
        for (std::uint32_t i = 0; i < mesh_format::full_mip_count(width, height); ++i) {
            const std::vector<int> bytes =
                level_of(payload, TextureFormat::r8_unorm, width, height, i);
            ASSERT_EQ(bytes.size(), reference.texels.size());
            for (std::size_t t = 0; t < bytes.size(); ++t) {
                ASSERT_NEAR(bytes[t], reference.texels[t] * 255.0, 0.51) << "level " << i;
            }
            bake::Level next = bake::halve(i == 0 ? source : bake::source_of(level));
            level = std::move(next);
            reference = reference.next();
            double sum = 0.0;
            for (const float texel : level.texels) {
                sum += texel;
            }
            EXPECT_NEAR(sum / static_cast<double>(level.texels.size()), mean, 1e-5);
        }
    }
}

TEST(MipChain, KeepsThePrecisionOfSixteenBitsUntilTheEnd) {
    // Averages of neighbours that round apart in 8 bits.
    Image image{
        .width = 2, .height = 1, .channels = 1, .type = bake::SampleType::u16, .samples = {}};
    const std::uint16_t samples[] = {100 * 257 + 120, 101 * 257 + 120};
    image.samples.resize(sizeof samples);
    std::memcpy(image.samples.data(), samples, sizeof samples);
    const Payload payload = bake::filter_chain(
        TextureFormat::r8_unorm, bake::scalar_texels(image, bake::Channel::r), bake::encode_unorm8);
    EXPECT_EQ(level_of(payload, TextureFormat::r8_unorm, 2, 1, 0), (std::vector{100, 101}));
    EXPECT_EQ(level_of(payload, TextureFormat::r8_unorm, 2, 1, 1), (std::vector{101}));
}

TEST(MipChain, NormalsHaveTheMeanDirectionAtUnitLength) {
    std::mt19937 random(5);
    const Image image = byte_image(48, 31, 3, [&](auto, auto, auto c) {
        return c == 2 ? 140 + static_cast<int>(random() % 116) : static_cast<int>(random() % 256);
    });
    constexpr auto kFormat = TextureFormat::rg8_unorm;
    const Payload payload =
        bake::filter_chain(kFormat, bake::normal_texels(image), bake::encode_normal8);
    // The last level against the mean of the unit vectors.
    double sum[3] = {};
    for (std::size_t t = 0; t < image.samples.size(); t += 3) {
        double v[3];
        double length = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            v[c] = std::to_integer<int>(image.samples[t + c]) / 127.5 - 1.0;
            length += v[c] * v[c];
        }
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += v[c] / std::sqrt(length);
        }
    }
    const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    const std::vector<int> last = level_of(payload, kFormat, 48, 31, 5);
    for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_NEAR(last[c] / 127.5 - 1.0, sum[c] / length, 0.6 / 127.5);
    }
}

TEST(MipChain, NormalsPointOutOfTheSurface) {
    const Image image = byte_image(2, 1, 3, [&](auto x, auto, auto c) {
        const int texels[2][3] = {{128, 128, 255}, {255, 128, 0}};
        return texels[x][c];
    });
    constexpr auto kFormat = TextureFormat::rg8_unorm;
    const Payload payload =
        bake::filter_chain(kFormat, bake::normal_texels(image), bake::encode_normal8);
    EXPECT_EQ(level_of(payload, kFormat, 2, 1, 0), (std::vector{128, 128, 218, 128}));
    EXPECT_EQ(level_of(payload, kFormat, 2, 1, 1), (std::vector{177, 128}))
        << "the mean of (0, 0, 1) and (1, 0, 1), not (1, 0, -1)";
}

TEST(MipChain, OppositeNormalsAverageToStraightUp) {
    constexpr auto kFormat = TextureFormat::rg8_unorm;
    bake::TexelSource source{2, 1, 3, [](std::uint32_t, std::span<float> texels) {
                                 const float vectors[] = {1, 0, 0, -1, 0, 0};
                                 std::copy_n(vectors, 6, texels.begin());
                             }};
    const Payload payload = bake::filter_chain(kFormat, source, bake::encode_normal8);
    EXPECT_EQ(level_of(payload, kFormat, 2, 1, 1), (std::vector{128, 128}));
}

}  // namespace
