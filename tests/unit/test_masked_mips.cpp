// Alpha masks keep their coverage, and what they hide colours nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <tuple>

#include "cw2-bake/textures/block_compression.h"
#include "cw2-bake/textures/mip_chain.h"
#include "cw2-bake/textures/srgb.h"
#include "cw2-bake/textures/texels.h"
#include "mesh-format/blocks.h"

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

/// Leaves on thin stalks, with soft edges; sharper ones of a larger slope.
Image leaves(std::uint32_t width, std::uint32_t height, double slope = 4.0) {
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
        return 0.5 + slope * std::max(leaf, 0.25 * stalk);
    });
}

Image noise(std::uint32_t width, std::uint32_t height, double power) {
    std::mt19937 random(11);
    return grey(width, height,
                [&](auto, auto) { return std::pow((random() & 0xFFFF) / 65'535.0, power); });
}

/// One, where every ring of a level of 4 texels a ring is alike, and all texels of smaller ones.
Image rings(std::uint32_t size, std::uint32_t count, double softness = 1.0) {
    return grey(size, size, [=](std::uint32_t x, std::uint32_t y) {
        const std::uint32_t ring = size / count;
        const double radius =
            std::hypot((x % ring + 0.5) / ring - 0.5, (y % ring + 0.5) / ring - 0.5);
        return 0.5 + ring / softness * (0.08 - std::abs(radius - 0.38));
    });
}

/// A level as a sampler reads it.
struct Sampled {
    const std::byte* texels;
    std::uint32_t width;
    std::uint32_t height;
    bool clamp;
    bool is_hidden_beyond = false;

    double at(double u, double v) const {
        const auto place = [this](double at, std::uint32_t extent) {
            const double first = std::floor(at * extent - 0.5);
            const auto inside = [&](double index) -> std::optional<std::uint32_t> {
                const double last = extent - 1.0;
                if (is_hidden_beyond && (index < 0.0 || index > last)) return std::nullopt;
                const double repeated = index < 0.0 ? last : index > last ? 0.0 : index;
                return static_cast<std::uint32_t>(clamp ? std::clamp(index, 0.0, last) : repeated);
            };
            return std::tuple(inside(first), inside(first + 1.0), at * extent - 0.5 - first);
        };
        const auto [x0, x1, fx] = place(u, width);
        const auto [y0, y1, fy] = place(v, height);
        const auto value = [this](const auto& x, const auto& y) {
            return x && y ? std::to_integer<int>(texels[*y * width + *x]) / 255.0 : 0.0;
        };
        return std::lerp(std::lerp(value(x0, y0), value(x1, y0), fx),
                         std::lerp(value(x0, y1), value(x1, y1), fx), fy);
    }
};

/// The share of a mask that is shown `blend` of the way from one level to the next: found at random
/// places.
double shown_share(const Sampled& finer, const Sampled& coarser, double blend, double cutoff) {
    constexpr int kPlaces = 40'000;
    std::mt19937 random(2);
    const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
    int shown = 0;
    for (int i = 0; i < kPlaces; ++i) {
        const double u = number();
        const double v = number();
        shown += std::lerp(finer.at(u, v), coarser.at(u, v), blend) >= cutoff;
    }
    return static_cast<double>(shown) / kPlaces;
}

std::vector<Sampled> levels_of(const std::vector<std::byte>& payload, std::uint32_t width,
                               std::uint32_t height, bool clamp, bool is_hidden_beyond = false) {
    std::vector<Sampled> levels;
    const std::byte* texels = payload.data();
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(width, height); ++i) {
        levels.push_back({texels, mesh_format::mip_extent(width, i),
                          mesh_format::mip_extent(height, i), clamp, is_hidden_beyond});
        texels += mesh_format::mip_bytes(TextureFormat::r8_unorm, width, height, i);
    }
    return levels;
}

/// Expects that all levels of at least 256 texels, and means of two of them, show what the first
/// shows, give or take `tolerance` of it.
void expect_coverage(const std::vector<Sampled>& levels, float cutoff, double tolerance) {
    const double truth = shown_share(levels[0], levels[0], 0.0, cutoff);
    EXPECT_GT(truth, 0.0);
    for (std::size_t i = 1; i < levels.size(); ++i) {
        if (levels[i].width * levels[i].height < 256) continue;
        for (const double blend : {0.1, 0.3, 0.5, 0.7, 0.9, 1.0}) {
            EXPECT_NEAR(shown_share(levels[i - 1], levels[i], blend, cutoff) / truth, 1.0,
                        tolerance)
                << blend << " of the way to level " << i;
        }
    }
}

void expect_coverage(const Image& image, const bake::MaskUse& use, double tolerance) {
    const std::vector<std::byte> payload =
        bake::filter_mask(bake::scalar_texels(image, bake::Channel::r), use);
    ASSERT_TRUE(std::equal(image.samples.begin(), image.samples.end(), payload.begin()))
        << "level 0 is not to change";
    SCOPED_TRACE(testing::Message() << image.width << " texels wide, cutoff " << use.cutoff);
    const bool hidden_beyond =
        use.clamp && bake::hides_its_edges(payload, image.width, image.height, use.cutoff);
    expect_coverage(levels_of(payload, image.width, image.height, use.clamp, hidden_beyond),
                    use.cutoff, tolerance);
}

TEST(AlphaMask, ShowsTheSameShareAtAllLevelsAndBetweenThem) {
    expect_coverage(leaves(512, 512), {.cutoff = 0.5f}, 0.05);
    expect_coverage(leaves(300, 201), {.cutoff = 0.5f}, 0.05);
    expect_coverage(leaves(512, 256), {.cutoff = 0.3f}, 0.05);
    expect_coverage(noise(256, 256, 1.0), {.cutoff = 0.5f}, 0.05);
    expect_coverage(noise(255, 129, 0.15), {.cutoff = 0.5f}, 0.05);  // nearly all
}

TEST(AlphaMask, ShowsSomeOfManyTexelsThatAreAlike) {
    expect_coverage(rings(256, 8), {.cutoff = 0.5f}, 0.05);
    expect_coverage(rings(256, 16), {.cutoff = 0.5f}, 0.05);
}

TEST(AlphaMask, ClampedShowsTheSameShareAtAllLevels) {
    // Shown along one border only, whose other side must not count.
    expect_coverage(grey(256, 256, [](auto x, auto) { return x < 6 ? 1.0 : 0.0; }),
                    {.cutoff = 0.5f, .clamp = true}, 0.1);
}

TEST(AlphaMask, HiddenAllAlongItsEdgesIsHiddenBeyondThem) {
    const auto hides = [](const Image& image) {
        return bake::hides_its_edges(image.samples, image.width, image.height, 0.5f);
    };
    const Image framed = grey(
        64, 48, [](auto x, auto y) { return x > 0 && y > 0 && x < 63 && y < 47 ? 1.0 : 0.49; });
    EXPECT_TRUE(hides(framed));
    for (const std::size_t texel : {0, 63, 20, 47 * 64 + 20, 20 * 64, 20 * 64 + 63}) {
        Image open = framed;
        open.samples[texel] = std::byte{128};
        EXPECT_FALSE(hides(open)) << texel;
    }
    // Though all texels of a small level are at an edge, and one is all of the smallest.
    const Image disc =
        grey(64, 64, [](auto x, auto y) { return 0.5 + 20.0 - std::hypot(x - 31.5, y - 31.5); });
    const std::vector<std::byte> payload = bake::filter_mask(
        bake::scalar_texels(disc, bake::Channel::r), {.cutoff = 0.5f, .clamp = true});
    const auto levels = levels_of(payload, 64, 64, true, true);
    const double truth = shown_share(levels[0], levels[0], 0.0, 0.5);
    for (const Sampled& level : levels) {
        EXPECT_NEAR(shown_share(level, level, 0.0, 0.5) / truth, 1.0, 0.1) << level.width;
    }
}

/// The payload that a mask in blocks stands for.
std::vector<std::byte> decode(const bake::Texture& mask) {
    std::vector<std::byte> payload(
        mesh_format::mip_chain_bytes(TextureFormat::r8_unorm, mask.width, mask.height));
    const std::byte* blocks = mask.payload.data();
    std::byte* texels = payload.data();
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(mask.width, mask.height); ++i) {
        const std::uint32_t width = mesh_format::mip_extent(mask.width, i);
        const std::uint32_t height = mesh_format::mip_extent(mask.height, i);
        for (std::uint32_t y = 0; y < height; y += 4) {
            const std::size_t row =
                y / 4 * std::size_t{mesh_format::block_count(mask.format, width)};
            mesh_format::decode_block_row(
                mask.format, blocks + row * mesh_format::block_bytes(mask.format), width,
                std::min(4u, height - y), texels + std::size_t{y} * width);
        }
        blocks += mesh_format::mip_bytes(mask.format, mask.width, mask.height, i);
        texels += mesh_format::mip_bytes(TextureFormat::r8_unorm, mask.width, mask.height, i);
    }
    return payload;
}

TEST(AlphaMask, ShowsTheSameShareInBlocksAndWhereThoseAreTooFarOff) {
    const auto check = [](const Image& image, TextureFormat expected) {
        SCOPED_TRACE(testing::Message() << image.width << " texels wide");
        const bake::MaskUse use{.cutoff = 0.5f, .blocks = true};
        bake::Texture mask{
            .name = "mask",
            .format = TextureFormat::r8_unorm,
            .width = image.width,
            .height = image.height,
            .payload = bake::filter_mask(bake::scalar_texels(image, bake::Channel::r), use)};
        bake::compress_to_blocks(mask, use.cutoff);
        EXPECT_EQ(mask.format, expected) << mask.psnr << " dB";
        const bool plain = mask.format == TextureFormat::r8_unorm;
        const std::vector<std::byte> payload = plain ? mask.payload : decode(mask);
        expect_coverage(levels_of(payload, mask.width, mask.height, false), use.cutoff, 0.05);
    };
    check(leaves(256, 256, 12.0), TextureFormat::bc4_unorm);
    check(leaves(600, 401, 30.0), TextureFormat::bc4_unorm);
    check(rings(256, 8, 0.4), TextureFormat::bc4_unorm);
    check(leaves(256, 256), TextureFormat::r8_unorm);
    check(leaves(300, 201), TextureFormat::r8_unorm);
    check(rings(256, 8), TextureFormat::r8_unorm);
}

TEST(AlphaMask, OneThatBlocksMissIsMadeAsIfThereWereNone) {
    const Image image = leaves(256, 256);
    const bake::TexelSource mask = bake::scalar_texels(image, bake::Channel::r);
    EXPECT_EQ(bake::filter_mask(mask, {.cutoff = 0.5f, .blocks = true}),
              bake::filter_mask(mask, {.cutoff = 0.5f}));
    const Image sharp = leaves(256, 256, 12.0);
    const bake::TexelSource other = bake::scalar_texels(sharp, bake::Channel::r);
    EXPECT_NE(bake::filter_mask(other, {.cutoff = 0.5f, .blocks = true}),
              bake::filter_mask(other, {.cutoff = 0.5f}));
}

TEST(AlphaMask, AveragesWhereTheCoverageIsRightAlready) {
    // Halves of 0 and 1 with borders on even columns: nothing is to be scaled.
    const Image image = grey(64, 64, [](auto x, auto) { return x < 32 ? 1.0 : 0.0; });
    const std::vector<std::byte> payload =
        bake::filter_mask(bake::scalar_texels(image, bake::Channel::r), {.cutoff = 0.5f});
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
