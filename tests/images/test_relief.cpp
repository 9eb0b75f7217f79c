// Bump maps that are heights or normals, normal maps of two channels, masks that leave nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cw2-bake/textures/textures.h"
#include "image_files.h"

namespace {

using bake::SourceMaterial;
using bake::Texture;
using mesh_format::kNoTexture;
using mesh_format::MapUse;
using Vector = std::array<double, 3>;

struct Made {
    bake::TextureSet set;
    std::vector<std::string> warnings;

    const Texture* texture(MapUse use) const {
        const std::uint32_t index = set.materials.at(0).textures[use];
        return index == kNoTexture ? nullptr : &set.textures[index];
    }
    Vector normal(std::size_t x, std::size_t y) const {
        const Texture& texture = *this->texture(MapUse::normal);
        const std::byte* texel = texture.payload.data() + 2 * (y * texture.width + x);
        Vector n{};
        for (std::size_t i = 0; i < 2; ++i) n[i] = std::to_integer<int>(texel[i]) / 127.5 - 1.0;
        n[2] = std::sqrt(std::max(0.0, 1.0 - n[0] * n[0] - n[1] * n[1]));
        return n;
    }
};

Made make(const SourceMaterial& material) {
    Made made;
    made.set =
        bake::bake_textures({{material}}, bake::TextureMode::lossless, {},
                            [&](const std::string& line) { made.warnings.push_back(line); }, {});
    return made;
}

Made make_bump(const std::filesystem::path& file, float scale = 1.0f) {
    SourceMaterial material;
    material.bump_map = bake::BumpMap{map_of(file, "a.mtl:7"), scale};
    return make(material);
}

Made make_normal(const std::filesystem::path& file) {
    SourceMaterial material;
    material.maps[MapUse::normal] = map_of(file, "a.mtl:7");
    return make(material);
}

constexpr int kSize = 64;

double height(int x, int y) {
    return 0.5 + 0.2 * std::sin(0.3 * x) + 0.15 * std::sin(0.2 * y + 0.1 * x);
}

/// Of strong bumps: up to 50 degrees steep.
Vector bumps(int x, int y) {
    const double dx = 0.8 * std::cos(0.35 * x), dy = 0.8 * std::sin(0.3 * y);
    const double length = std::sqrt(dx * dx + dy * dy + 1.0);
    return {-dx / length, -dy / length, 1.0 / length};
}

std::vector<double> stored(const Vector& n) {
    return {0.5 + 0.5 * n[0], 0.5 + 0.5 * n[1], 0.5 + 0.5 * n[2]};
}

void expect_near(const Vector& a, const Vector& b, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

/// The same at all texels.
void expect_bumps(const Made& made, double tolerance) {
    ASSERT_TRUE(made.texture(MapUse::normal));
    for (int y = 0; y < kSize; y += 5)
        for (int x = 0; x < kSize; x += 5)
            expect_near(made.normal(static_cast<std::size_t>(x), static_cast<std::size_t>(y)),
                        bumps(x, y), tolerance);
}

/// Pseudo-random, in [-1, 1].
double noise(int x, int y, int channel) {
    const auto wrapped = [](int value) { return static_cast<std::uint32_t>(value); };
    std::uint32_t h =
        wrapped(x) * 73856093u ^ wrapped(y) * 19349663u ^ wrapped(channel) * 83492791u;
    h ^= h >> 13;
    h *= 0x5bd1e995;
    h ^= h >> 15;
    return static_cast<double>(h % 2001) / 1000.0 - 1.0;
}

/// The normal that central differences of `height` give, times `scale`.
Vector slope(int x, int y, double scale) {
    const double nx = -0.5 * scale * (height(x + 1, y) - height(x - 1, y));
    const double ny = -0.5 * scale * (height(x, y - 1) - height(x, y + 1));
    const double length = std::sqrt(nx * nx + ny * ny + 1.0);
    return {nx / length, ny / length, 1.0 / length};
}

void expect_slopes(const Made& made, double scale, double tolerance) {
    ASSERT_TRUE(made.texture(MapUse::normal));
    for (int y = 2; y < kSize - 2; y += 6)
        for (int x = 2; x < kSize - 2; x += 6)
            expect_near(made.normal(static_cast<std::size_t>(x), static_cast<std::size_t>(y)),
                        slope(x, y, scale), tolerance);
}

TEST(BumpMaps, OfAnyColourAreHeightsByLuminance) {
    const TemporaryFolder folder;
    // Brown, green and sky blue; each with the luminance of the height.
    for (const Vector& hue :
         {Vector{1.6, 0.9, 0.3}, Vector{0.5, 1.2, 0.2}, Vector{0.5, 1.1, 1.8}}) {
        const double luminance = 0.2126 * hue[0] + 0.7152 * hue[1] + 0.0722 * hue[2];
        write_image(
            folder / "color.png", kSize, kSize, 3,
            [&](int x, int y) {
                const double h = 0.6 * height(x, y) / luminance;
                return std::vector{h * hue[0], h * hue[1], h * hue[2]};
            },
            OIIO::TypeDesc::UINT16);
        const Made made = make_bump(folder / "color.png", 10.0f);
        expect_slopes(made, 6.0, 0.01);
        ASSERT_EQ(made.warnings.size(), 1u);
        EXPECT_EQ(made.warnings[0], "a.mtl:7: " + (folder / "color.png").string() +
                                        ": is coloured, and no normal map: its luminance is taken "
                                        "as height");
    }
}

TEST(BumpMaps, ThatAreGreyButForNoiseAreHeightsWithoutAWord) {
    const TemporaryFolder folder;
    for (const double levels : {3.0, 6.0}) {
        write_image(folder / "grey.png", kSize, kSize, 3, [&](int x, int y) {
            std::vector<double> texel;
            for (int c = 0; c < 3; ++c)
                texel.push_back(height(x, y) + levels / 255.0 * noise(x, y, c));
            return texel;
        });
        const Made made = make_bump(folder / "grey.png", 5.0f);
        expect_slopes(made, 5.0, 0.15);
        EXPECT_EQ(made.warnings, std::vector<std::string>());
    }
}

TEST(BumpMaps, ThatHoldUnitVectorsAreNormals) {
    const TemporaryFolder folder;
    const auto paint = [](int x, int y) { return stored(bumps(x, y)); };
    write_image(folder / "a.png", kSize, kSize, 3, paint);
    write_image(folder / "a.tif", kSize, kSize, 3, paint, OIIO::TypeDesc::UINT16);
    write_image(folder / "a.exr", kSize, kSize, 3, paint, OIIO::TypeDesc::FLOAT);
    write_image(folder / "alpha.png", kSize, kSize, 4, [&](int x, int y) {
        std::vector<double> texel = paint(x, y);
        texel.push_back(height(x, y));
        return texel;
    });
    for (const char* name : {"a.png", "a.tif", "a.exr", "alpha.png"}) {
        const Made made = make_bump(folder / name);
        expect_bumps(made, 0.02);
        EXPECT_EQ(made.warnings, std::vector<std::string>()) << name;
    }
    for (const char* quality : {"jpeg:95", "jpeg:75", "jpeg:50"}) {
        write_image(folder / "a.jpg", kSize, kSize, 3, paint, OIIO::TypeDesc::UINT8, "Compression",
                    quality);
        const Made made = make_bump(folder / "a.jpg");
        expect_bumps(made, 0.35);
        EXPECT_EQ(made.warnings, std::vector<std::string>()) << quality;
    }
    write_image(folder / "flat.png", 8, 8, 3, [](int, int) {
        return std::vector{128 / 255.0, 128 / 255.0, 1.0};
    });
    const Made flat = make_bump(folder / "flat.png");
    EXPECT_FALSE(flat.texture(MapUse::normal));
    EXPECT_EQ(flat.warnings, std::vector<std::string>());
}

TEST(BumpMaps, PhotographsInBlueAreHeights) {
    const TemporaryFolder folder;
    for (const Vector& mean : {Vector{0.45, 0.5, 0.8}, Vector{0.53, 0.8, 0.92},
                               Vector{0.3, 0.5, 0.95}, Vector{0.79, 0.79, 0.82}}) {
        write_image(folder / "sky.png", kSize, kSize, 3, [&](int x, int y) {
            std::vector<double> texel;
            for (std::size_t c = 0; c < 3; ++c)
                texel.push_back(mean[c] + 0.15 * noise(x / 3, y / 3, static_cast<int>(c)));
            return texel;
        });
        const Made made = make_bump(folder / "sky.png");
        EXPECT_EQ(made.warnings.size(), 1u) << mean[2];
        for (std::size_t x = 0; x < kSize; ++x) EXPECT_GT(made.normal(x, 9)[2], 0.5);
    }
}

TEST(NormalMaps, OfTwoChannelsGetTheirZ) {
    const TemporaryFolder folder;
    const auto write_xy = [&](const std::string& name, double blue) {
        write_image(folder / name, kSize, kSize, 3, [&](int x, int y) {
            std::vector<double> texel = stored(bumps(x, y));
            texel[2] = blue;
            return texel;
        });
    };
    write_xy("0.png", 0.0);
    write_xy("128.png", 128 / 255.0);
    write_xy("255.png", 1.0);
    write_image(
        folder / "rg.exr", kSize, kSize, 2,
        [](int x, int y) {
            const std::vector<double> texel = stored(bumps(x, y));
            return std::vector{texel[0], texel[1]};
        },
        OIIO::TypeDesc::FLOAT);
    for (const char* name : {"0.png", "128.png", "255.png", "rg.exr"}) {
        SCOPED_TRACE(name);
        const Made made = make_normal(folder / name);
        expect_bumps(made, 0.02);
        ASSERT_EQ(made.warnings.size(), 1u);
        EXPECT_EQ(made.warnings[0].find("a.mtl:7: " + (folder / name).string()), 0u);
        EXPECT_NE(made.warnings[0].find("two channels"), std::string::npos);
    }
    for (const char* name : {"0.png", "128.png", "255.png"})
        expect_bumps(make_bump(folder / name), 0.02);
}

TEST(NormalMaps, OfOtherLengthsAreNamedAndNormalised) {
    const TemporaryFolder folder;
    for (const double length : {0.4, 0.6, 1.3}) {
        SCOPED_TRACE(length);
        write_image(folder / "n.png", kSize, kSize, 3, [&](int x, int y) {
            Vector n = bumps(x, y);
            for (double& component : n) component *= length;
            return stored(n);
        });
        const Made made = make_normal(folder / "n.png");
        expect_bumps(made, length > 1.0 ? 0.3 : 0.02);  // 8 bits hold no component above 1
        ASSERT_EQ(made.warnings.size(), 1u);
        EXPECT_EQ(made.warnings[0].find("a.mtl:7: " + (folder / "n.png").string()), 0u);
        EXPECT_NE(made.warnings[0].find("normalised"), std::string::npos);
    }
}

TEST(NormalMaps, WithGreyFillersOrAFewVectorsOfOtherLengthsAreNormals) {
    const TemporaryFolder folder;
    for (const double filler : {0.0, 0.5, 1.0}) {
        write_image(folder / "n.png", kSize, kSize, 3, [&](int x, int y) {
            if (x > 20) return std::vector(3, filler);
            return x > 15 ? std::vector{0.5, 0.6, 0.6} : stored(bumps(x, y));
        });
        EXPECT_EQ(make_normal(folder / "n.png").warnings, std::vector<std::string>()) << filler;
    }
}

TEST(NormalMaps, ThatPointIntoTheSurfaceHereAndThereAreTurnedOutOfIt) {
    const TemporaryFolder folder;
    write_image(folder / "n.png", kSize, kSize, 3, [](int x, int y) {
        return (x + y) % 4 == 0 ? std::vector{0.8, 0.5, 0.1} : stored(bumps(x, y));
    });
    const Made made = make_normal(folder / "n.png");
    EXPECT_EQ(made.warnings, std::vector<std::string>());
    expect_near(made.normal(4, 0), {0.6, 0.0, 0.8}, 0.02);
    expect_near(made.normal(5, 0), bumps(5, 0), 0.02);
}

/// RGBA with alpha 1 on one texel of `of`, else `low`.
Made with_alpha(const std::filesystem::path& file, int of, double low) {
    write_image(file, kSize, kSize, 4, [&](int x, int y) {
        const bool shown = of > 0 && (y * kSize + x) % of == 0;
        return std::vector{0.2, 0.4, 0.6, shown ? 1.0 : low};
    });
    SourceMaterial material;
    material.maps[MapUse::base_color] = map_of(file, "a.mtl:7");
    return make(material);
}

TEST(AlphaOfTheColour, ThatLeavesNothingIsNoMask) {
    const TemporaryFolder folder;
    for (const auto& [of, low] : {std::pair{0, 0.0}, std::pair{0, 0.49}, std::pair{1000, 0.2}}) {
        const Made made = with_alpha(folder / "skin.png", of, low);
        EXPECT_FALSE(made.texture(MapUse::alpha_mask));
        ASSERT_EQ(made.warnings.size(), 1u);
        EXPECT_EQ(made.warnings[0], "a.mtl:7: " + (folder / "skin.png").string() +
                                        ": its alpha is below 0.5 (nearly) everywhere; it is "
                                        "ignored, and hides nothing");
        EXPECT_EQ(std::to_integer<int>(made.texture(MapUse::base_color)->payload[1]), 102);
    }
    const Made leaves = with_alpha(folder / "leaves.png", 50, 0.0);
    EXPECT_TRUE(leaves.texture(MapUse::alpha_mask));
    EXPECT_EQ(leaves.warnings, std::vector<std::string>());
}

TEST(AlphaOfTheColour, OfABlendedMaterialIsToldUnlessItIsOne) {
    const TemporaryFolder folder;
    const auto blended = [&](double alpha) {
        write_image(folder / "a.png", kSize, kSize, 4, [&](int x, int) {
            return std::vector{0.2, 0.4, 0.6, x == 3 ? alpha : 1.0};
        });
        SourceMaterial material;
        material.maps[MapUse::base_color] = map_of(folder / "a.png", "a.mtl:7");
        material.blend = true;
        return make(material).warnings;
    };
    EXPECT_EQ(blended(1.0), std::vector<std::string>());
    EXPECT_EQ(blended(0.6),
              std::vector{"a.mtl:7: " + (folder / "a.png").string() +
                          ": its alpha is nowhere below 0.5: drawn opaque, not blended"});
}

TEST(AMapOfTheMask, ThatHidesEverythingIsKeptAndNamed) {
    const TemporaryFolder folder;
    write_image(folder / "mask.png", 4, 4, 1, [](int, int) { return std::vector{0.2}; });
    SourceMaterial material;
    material.maps[MapUse::alpha_mask] = map_of(folder / "mask.png", "a.mtl:7");
    const Made made = make(material);
    EXPECT_TRUE(made.texture(MapUse::alpha_mask));
    ASSERT_EQ(made.warnings.size(), 1u);
    EXPECT_EQ(made.warnings[0],
              "a.mtl:7: " + (folder / "mask.png").string() + ": is a mask that hides everything");
}

}  // namespace
