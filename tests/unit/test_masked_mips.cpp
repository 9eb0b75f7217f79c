// Alpha masks keep their coverage, and what they hide colours nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>

#include "cw2-bake/mip_chain.h"
#include "cw2-bake/srgb.h"
#include "cw2-bake/texels.h"

namespace {

using bake::Image;
using mesh_format::TextureFormat;

Image grey(std::uint32_t width, std::uint32_t height,
           const std::function<double(std::uint32_t, std::uint32_t)>& value) {
    Image image{.width = width, .height = height, .channels = 1, .samples = {}};
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            image.samples.push_back(
                static_cast<std::byte>(std::clamp(value(x, y), 0.0, 1.0) * 255.0 + 0.5));
        }
    }
    return image;
}

/// Leaves on thin stalks, with soft edges.
Image leaves(std::uint32_t width, std::uint32_t height) {
    return grey(width, height, [=](std::uint32_t x, std::uint32_t y) {
        const double u = 6.0 * x / width;
        const double v = 5.0 * y / height;
        const double fu = u - std::floor(u) - 0.5;
        const double fv = v - std::floor(v) - 0.5;
        const double tilt = 1.3 * std::floor(u) + 2.1 * std::floor(v);
        const double a = std::cos(tilt) * fu + std::sin(tilt) * fv;
        const double b = -std::sin(tilt) * fu + std::cos(tilt) * fv;
        const double leaf = 1.0 - std::hypot(a / 0.4, b / 0.13);
        const double stalk = 1.0 - std::abs(fu) / 0.02;
        return 0.5 + 4.0 * std::max(leaf, 0.25 * stalk);
    });
}

Image noise(std::uint32_t width, std::uint32_t height, double power) {
    std::mt19937 random(11);
    return grey(width, height,
                [&](auto, auto) { return std::pow((random() & 0xFFFF) / 65'535.0, power); });
}

/// The share of a level that is shown where it is filtered linearly and repeats: found at random
/// places.
double shown_share(const std::byte* level, std::uint32_t width, std::uint32_t height,
                   double cutoff) {
    std::mt19937 random(2);
    const auto place = [&](std::uint32_t extent) {
        const double at = static_cast<double>(random()) / 4294967296.0 * extent;
        const auto first = static_cast<std::uint32_t>(at);
        return std::tuple(first, (first + 1) % extent, at - first);
    };
    constexpr int kPlaces = 40'000;
    int shown = 0;
    for (int i = 0; i < kPlaces; ++i) {
        const auto [x0, x1, fx] = place(width);
        const auto [y0, y1, fy] = place(height);
        const auto value = [&](std::uint32_t x, std::uint32_t y) {
            return std::to_integer<int>(level[y * width + x]) / 255.0;
        };
        const double above = value(x0, y0) + (value(x1, y0) - value(x0, y0)) * fx;
        const double below = value(x0, y1) + (value(x1, y1) - value(x0, y1)) * fx;
        shown += above + (below - above) * fy >= cutoff;
    }
    return static_cast<double>(shown) / kPlaces;
}

void expect_coverage(const Image& image, float cutoff) {
    const int limit = static_cast<int>(std::ceil(cutoff * 255.0));
    const std::vector<std::byte> payload =
        bake::filter_mask(bake::scalar_texels(image, bake::Channel::r), cutoff);
    const auto shown = std::ranges::count_if(
        image.samples, [&](std::byte value) { return std::to_integer<int>(value) >= limit; });
    const double share = static_cast<double>(shown) / static_cast<double>(image.samples.size());
    ASSERT_TRUE(std::equal(image.samples.begin(), image.samples.end(), payload.begin()))
        << "level 0 is not to change";
    std::size_t offset = 0;
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(image.width, image.height); ++i) {
        const std::uint32_t width = mesh_format::mip_extent(image.width, i);
        const std::uint32_t height = mesh_format::mip_extent(image.height, i);
        if (i > 0 && width * height >= 64) {
            EXPECT_NEAR(shown_share(payload.data() + offset, width, height, cutoff), share, 0.02)
                << "level " << i;
        }
        offset += mesh_format::mip_bytes(TextureFormat::r8_unorm, image.width, image.height, i);
    }
}

TEST(AlphaMask, KeepsItsCoverageAtEveryLevel) {
    expect_coverage(leaves(512, 512), 0.5f);
    expect_coverage(leaves(300, 201), 0.5f);
    expect_coverage(leaves(512, 256), 0.3f);
    expect_coverage(noise(256, 256, 1.0), 0.5f);
    expect_coverage(noise(256, 256, 6.0), 0.5f);   // one in ten
    expect_coverage(noise(255, 129, 0.15), 0.5f);  // ninety-nine in a hundred
    expect_coverage(noise(128, 128, 1.0), 0.9f);
}

TEST(AlphaMask, AveragesWhereTheCoverageIsRightAlready) {
    // Halves of 0 and 1 with borders on even columns: nothing is to be scaled.
    const Image image = grey(64, 64, [](auto x, auto) { return x < 32 ? 1.0 : 0.0; });
    const std::vector<std::byte> payload =
        bake::filter_mask(bake::scalar_texels(image, bake::Channel::r), 0.5f);
    const std::byte* level = payload.data() + 64 * 64;
    for (std::size_t i = 0; i < 32 * 32; ++i) {
        EXPECT_EQ(level[i], i % 32 < 16 ? std::byte{255} : std::byte{0});
    }
}

struct ColorAndMask {
    Image color;
    Image mask;
};

std::vector<std::byte> masked(const ColorAndMask& images, bool clamp = false) {
    const bake::TexelSource mask = bake::scalar_texels(images.mask, bake::Channel::r);
    return bake::filter_masked_color(bake::masked_color_texels(images.color, mask, 0.5f), clamp);
}

bool is_shown(const Image& mask, std::size_t texel) {
    return std::to_integer<int>(mask.samples[texel]) >= 128;
}

/// `shown` where the mask shows, black elsewhere.
ColorAndMask paint(Image mask, const std::function<int(std::uint32_t, std::uint32_t, int)>& shown) {
    Image color{.width = mask.width, .height = mask.height, .channels = 3, .samples = {}};
    for (std::uint32_t y = 0; y < mask.height; ++y) {
        for (std::uint32_t x = 0; x < mask.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const bool hidden = !is_shown(mask, std::size_t{y} * mask.width + x);
                color.samples.push_back(static_cast<std::byte>(hidden ? 0 : shown(x, y, c)));
            }
        }
    }
    return {std::move(color), std::move(mask)};
}

TEST(MaskedColour, HiddenBlackDarkensNothingAtAnyLevel) {
    constexpr int kColor[3] = {40, 180, 60};
    for (const auto& [width, height] : {std::pair{128u, 128u}, {77u, 130u}, {3u, 1u}, {1u, 1u}}) {
        const ColorAndMask images =
            paint(width > 3 ? leaves(width, height)
                            : grey(width, height, [](auto x, auto) { return x == 0; }),
                  [&](auto, auto, int c) { return kColor[c]; });
        const std::vector<std::byte> payload = masked(images);
        std::size_t offset = 0;
        for (std::uint32_t i = 0; i < mesh_format::full_mip_count(width, height); ++i) {
            const std::size_t count =
                std::size_t{mesh_format::mip_extent(width, i)} * mesh_format::mip_extent(height, i);
            for (std::size_t t = 0; t < 4 * count; ++t) {
                ASSERT_EQ(std::to_integer<int>(payload[offset + t]),
                          t % 4 == 3 ? 255 : kColor[t % 4])
                    << "level " << i;
            }
            offset += mesh_format::mip_bytes(TextureFormat::rgba8_srgb, width, height, i);
        }
    }
}

TEST(MaskedColour, LevelsAreTheMeanOfWhatIsShown) {
    std::mt19937 random(3);
    const ColorAndMask images = paint(
        noise(64, 64, 2.0), [&](auto, auto, auto) { return static_cast<int>(random() & 255); });
    const std::vector<std::byte> payload = masked(images);
    for (std::size_t t = 0; t < 64 * 64; ++t) {
        if (is_shown(images.mask, t)) {
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_EQ(payload[4 * t + c], images.color.samples[3 * t + c]);
            }
        }
    }
    std::size_t offset = 0;
    for (std::uint32_t i = 1; i < 7; ++i) {
        offset += mesh_format::mip_bytes(TextureFormat::rgba8_srgb, 64, 64, i - 1);
        const std::size_t size = 64 >> i;
        for (std::size_t t = 0; t < size * size; ++t) {
            for (std::size_t c = 0; c < 3; ++c) {
                double sum = 0.0;
                double weight = 0.0;
                for (std::size_t y = t / size << i; y < (t / size + 1) << i; ++y) {
                    for (std::size_t x = t % size << i; x < (t % size + 1) << i; ++x) {
                        if (is_shown(images.mask, y * 64 + x)) {
                            const auto byte = images.color.samples[3 * (y * 64 + x) + c];
                            sum += bake::srgb().to_linear(std::to_integer<std::uint8_t>(byte));
                            weight += 1.0;
                        }
                    }
                }
                if (weight > 0.0) {
                    const int expected = bake::srgb().to_srgb8(static_cast<float>(sum / weight));
                    EXPECT_NEAR(std::to_integer<int>(payload[offset + 4 * t + c]), expected, 1);
                }
            }
        }
    }
}

TEST(MaskedColour, HiddenTexelsContinueTheColourBesideThem) {
    // Red on the left and blue on the right, with a hidden hole in each.
    const auto hole = [](auto x, auto y) {
        return (x % 16 < 5 || x % 16 > 10 || y < 5 || y > 10) ? 1.0 : 0.0;
    };
    const ColorAndMask images = paint(
        grey(32, 16, hole), [](auto x, auto, int c) { return c == (x < 16 ? 0 : 2) ? 200 : 10; });
    const std::vector<std::byte> payload = masked(images);
    for (std::size_t t = 0; t < 32 * 16; ++t) {
        const bool left = t % 32 < 16;
        const std::size_t x = t % 16;
        const std::size_t y = t / 32;
        const bool beside = !is_shown(images.mask, t) && (x == 5 || x == 10 || y == 5 || y == 10);
        if (beside) {
            EXPECT_EQ(std::to_integer<int>(payload[4 * t]), left ? 200 : 10) << t;
            EXPECT_EQ(std::to_integer<int>(payload[4 * t + 2]), left ? 10 : 200) << t;
        }
    }
}

TEST(MaskedColour, ContinuesAcrossTheBorderUnlessClamped) {
    // The last column shows green; the first is hidden and has no other shown neighbour.
    const auto mask = [](auto x, auto) { return x == 7 || x == 3 ? 1.0 : 0.0; };
    const ColorAndMask images = paint(
        grey(8, 8, mask), [](auto x, auto, int c) { return c == (x == 7 ? 1 : 0) ? 250 : 0; });
    EXPECT_EQ(std::to_integer<int>(masked(images, false)[1]), 250);
    EXPECT_LT(std::to_integer<int>(masked(images, true)[1]), 250);
}

}  // namespace
