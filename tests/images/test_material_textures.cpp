// Which textures a material gets from its maps.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "cw2-bake/textures/textures.h"
#include "image_files.h"

namespace {

using mesh_format::MapUse;

using bake::Channel;
using bake::MaterialTextures;
using bake::SourceMaterial;
using bake::Texture;
using bake::TextureSet;
using mesh_format::kNoTexture;

TextureSet bake_quietly(const std::vector<SourceMaterial>& materials) {
    return bake::bake_textures(materials, bake::TextureMode::lossless, {},
                               [](const std::string& line) { ADD_FAILURE() << line; }, {});
}

std::vector<int> first_texels(const Texture& texture, std::size_t count) {
    std::vector<int> values;
    for (std::size_t i = 0; i < count; ++i) {
        values.push_back(
            std::to_integer<int>(texture.payload[i * mesh_format::block_bytes(texture.format)]));
    }
    return values;
}

/// 2 x 1 texels of the channels given.
void write_pair(const std::filesystem::path& path, const std::vector<double>& left,
                const std::vector<double>& right) {
    write_image(path, 2, 1, static_cast<int>(left.size()),
                [&](int x, int) { return x ? right : left; });
}

/// The mask of a material with these maps, level 0; empty if it has none.
std::vector<int> mask_of(const std::optional<bake::TextureMap>& color,
                         const std::optional<bake::TextureMap>& alpha) {
    SourceMaterial material;
    material.maps[MapUse::base_color] = color;
    material.maps[MapUse::alpha_mask] = alpha;
    const TextureSet set = bake_quietly({material});
    const std::uint32_t index = set.materials[0].textures[MapUse::alpha_mask];
    return index == kNoTexture ? std::vector<int>()
                               : first_texels(set.textures[index], set.textures[index].width);
}

TEST(AlphaMasks, ComeFromTheAlphaOfTheirMapElseFromItsRed) {
    const TemporaryFolder folder;
    write_pair(folder / "alpha.png", {1, 1, 1, 0.2}, {0, 0, 0, 1});
    write_pair(folder / "opaque.png", {0.2, 1, 1, 1}, {1, 0, 0, 1});
    write_pair(folder / "rgb.png", {0, 1, 1}, {1, 0, 0});
    write_pair(folder / "grey.png", {0}, {0.8});
    EXPECT_EQ(mask_of({}, map_of(folder / "alpha.png")), (std::vector{51, 255}));
    EXPECT_EQ(mask_of({}, map_of(folder / "opaque.png")), (std::vector{51, 255}));
    EXPECT_EQ(mask_of({}, map_of(folder / "rgb.png")), (std::vector{0, 255}));
    EXPECT_EQ(mask_of({}, map_of(folder / "grey.png")), (std::vector{0, 204}));
    EXPECT_EQ(mask_of({}, map_of(folder / "rgb.png", "", Channel::g)), (std::vector{255, 0}));
    EXPECT_EQ(mask_of({}, map_of(folder / "alpha.png", "", Channel::r)), (std::vector{255, 0}));
}

TEST(AlphaMasks, ComeFromTheAlphaOfTheColourWhereSomeTexelIsBelowHalf) {
    const TemporaryFolder folder;
    write_pair(folder / "low.png", {1, 1, 1, 0.49}, {0, 0, 0, 1});
    write_pair(folder / "high.png", {1, 1, 1, 0.51}, {0, 0, 0, 1});
    write_pair(folder / "white.png", {1, 1, 1}, {1, 1, 1});
    EXPECT_EQ(mask_of(map_of(folder / "low.png"), {}), (std::vector{125, 255}));
    EXPECT_EQ(mask_of(map_of(folder / "high.png"), {}), std::vector<int>());
    EXPECT_EQ(mask_of(map_of(folder / "low.png"), map_of(folder / "white.png")), std::vector<int>())
        << "the map of the mask comes first, and hides nothing";
}

TEST(AlphaMasks, LeaveTheColourOfHiddenTexelsOut) {
    const TemporaryFolder folder;
    write_pair(folder / "leaf.png", {0, 0, 0, 0}, {0.2, 0.8, 0.4, 1});
    SourceMaterial masked;
    masked.maps[MapUse::base_color] = map_of(folder / "leaf.png");
    const TextureSet set = bake_quietly({masked});
    const Texture& color = set.textures[set.materials[0].textures[MapUse::base_color]];
    EXPECT_EQ(color.width, 1u) << "one colour is left";
    EXPECT_EQ(std::to_integer<int>(color.payload[1]), 204);
}

TEST(AlphaMasks, AColourWithAndWithoutAMaskIsTwoTextures) {
    const TemporaryFolder folder;
    write_pair(folder / "color.png", {0, 0, 0}, {0.2, 0.8, 0.4});
    write_pair(folder / "mask.png", {0}, {1});
    SourceMaterial plain;
    plain.maps[MapUse::base_color] = map_of(folder / "color.png");
    SourceMaterial masked = plain;
    masked.maps[MapUse::alpha_mask] = map_of(folder / "mask.png");
    const TextureSet set = bake_quietly({plain, masked, plain});
    EXPECT_EQ(set.textures.size(), 3u);
    EXPECT_EQ(set.materials[0].textures[MapUse::base_color], 0u);
    EXPECT_EQ(set.materials[1].textures[MapUse::base_color], 1u);
    EXPECT_EQ(set.materials[1].textures[MapUse::alpha_mask], 2u);
    EXPECT_EQ(set.materials[2].textures[MapUse::base_color], 0u);
    EXPECT_EQ(first_texels(set.textures[0], 2), (std::vector{0, 51}));
}

TEST(AlphaMasks, WhereNothingIsShownTheColourStaysAsItIs) {
    const TemporaryFolder folder;
    write_pair(folder / "color.png", {0, 0, 0}, {0.2, 0.8, 0.4});
    write_pair(folder / "mask.png", {0.1}, {0.2});
    SourceMaterial material;
    material.maps[MapUse::base_color] = map_of(folder / "color.png");
    material.maps[MapUse::alpha_mask] = map_of(folder / "mask.png");
    std::vector<std::string> warnings;
    const TextureSet set =
        bake::bake_textures({{material}}, bake::TextureMode::lossless, {},
                            [&](const std::string& warning) { warnings.push_back(warning); }, {});
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("is a mask that hides everything"), std::string::npos);
    EXPECT_EQ(first_texels(set.textures[set.materials[0].textures[MapUse::base_color]], 2),
              (std::vector{0, 51}));
    EXPECT_EQ(first_texels(set.textures[set.materials[0].textures[MapUse::alpha_mask]], 2),
              (std::vector{26, 51}));
}

/// Heights that rise to the right and, faster, upwards.
void write_hill(const std::filesystem::path& path, int channels) {
    write_image(
        path, 8, 8, channels,
        [=](int x, int y) {
            return std::vector<double>(static_cast<std::size_t>(channels),
                                       (5 * x + 10 * (7 - y)) / 255.0);
        },
        OIIO::TypeDesc::UINT16);
}

std::vector<double> normal_at(const Texture& texture, std::size_t x, std::size_t y) {
    const std::byte* texel = texture.payload.data() + 2 * (y * texture.width + x);
    return {std::to_integer<int>(texel[0]) / 127.5 - 1.0,
            std::to_integer<int>(texel[1]) / 127.5 - 1.0};
}

TEST(Bumps, AreHeightsWhereTheImageIsGreyAndNormalsWhereItIsNot) {
    const TemporaryFolder folder;
    write_hill(folder / "one.png", 1);
    write_hill(folder / "three.png", 3);
    const double length = std::sqrt(0.4 * 0.4 + 0.8 * 0.8 + 1.0);
    for (const char* name : {"one.png", "three.png"}) {
        SourceMaterial material;
        material.bump_map = bake::BumpMap{map_of(folder / name), 0.08f * 255.0f};
        const TextureSet set = bake_quietly({material});
        const std::vector<double> normal = normal_at(set.textures.at(0), 4, 4);
        EXPECT_NEAR(normal[0], -0.4 / length, 0.005);
        EXPECT_NEAR(normal[1], -0.8 / length, 0.005);
    }
    write_image(folder / "normals.png", 2, 1, 3, [](int x, int) {
        return std::vector{x ? 0.5 : 1.0, 0.5, x ? 1.0 : 0.5};
    });
    SourceMaterial material;
    material.bump_map = bake::BumpMap{map_of(folder / "normals.png"), 1.0f};
    const TextureSet set = bake_quietly({material});
    EXPECT_EQ(first_texels(set.textures.at(0), 2), (std::vector{255, 128}));
}

TEST(NormalMaps, ThatAreGreyAreNamedAndIgnored) {
    const TemporaryFolder folder;
    write_hill(folder / "grey.png", 1);
    SourceMaterial material;
    material.maps[MapUse::normal] = map_of(folder / "grey.png", "b.mtl:9");
    std::vector<std::string> warnings;
    const TextureSet set =
        bake::bake_textures(std::vector{material}, bake::TextureMode::lossless, {},
                            [&](const std::string& line) { warnings.push_back(line); }, {});
    EXPECT_EQ(set.materials[0].textures[MapUse::normal], kNoTexture);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].find("b.mtl:9: "), 0u);
    EXPECT_NE(warnings[0].find("grey"), std::string::npos);
}

TEST(NormalMaps, ThatAreFlatAreNone) {
    const TemporaryFolder folder;
    write_image(folder / "flat.png", 4, 4, 3, [](int, int) {
        return std::vector{128 / 255.0, 127 / 255.0, 1.0};
    });
    write_image(folder / "level.png", 4, 4, 1, [](int, int) { return std::vector{0.7}; });
    SourceMaterial normals;
    normals.maps[MapUse::normal] = map_of(folder / "flat.png");
    SourceMaterial bumps;
    bumps.bump_map = bake::BumpMap{map_of(folder / "level.png"), 3.0f};
    const TextureSet set = bake_quietly({normals, bumps});
    EXPECT_TRUE(set.textures.empty());
    EXPECT_EQ(set.materials[1].textures[MapUse::normal], kNoTexture);
}

TEST(TextureSets, HoldEqualTexturesOnceInOrderOfFirstUse) {
    const TemporaryFolder folder;
    write_pair(folder / "z.png", {0.25}, {0.5});
    write_pair(folder / "copy.tif", {0.25}, {0.5});
    write_pair(folder / "a.png", {0.5}, {0.25});
    SourceMaterial material;
    material.maps[MapUse::roughness] = map_of(folder / "z.png");
    material.maps[MapUse::metalness] = map_of(folder / "copy.tif");
    SourceMaterial other;
    other.maps[MapUse::roughness] = map_of(folder / "a.png");
    other.maps[MapUse::metalness] = map_of(folder / "z.png");
    other.maps[MapUse::metalness]->clamp = true;
    const TextureSet set = bake_quietly({material, other});
    ASSERT_EQ(set.textures.size(), 3u) << "one that is clamped is another texture";
    EXPECT_EQ(set.textures[0].name, "z.png");
    EXPECT_EQ(set.materials[0].textures[MapUse::roughness], 0u);
    EXPECT_EQ(set.materials[0].textures[MapUse::metalness], 0u);
    EXPECT_EQ(set.materials[1].textures[MapUse::roughness], 1u);
    EXPECT_EQ(set.materials[1].textures[MapUse::metalness], 2u);
    EXPECT_EQ(set.textures[2].flags, mesh_format::kClampToEdge);
    EXPECT_EQ(set.materials[0].textures[MapUse::base_color], kNoTexture);
}

TEST(TextureSets, ShrinkImagesOfOneValueToOneTexel) {
    const TemporaryFolder folder;
    write_image(folder / "white.png", 32, 16, 3, [](int, int) { return std::vector(3, 1.0); });
    write_image(folder / "almost.png", 32, 16, 3,
                [](int x, int y) { return std::vector(3, x == 31 && y == 15 ? 0.99 : 1.0); });
    SourceMaterial material;
    material.maps[MapUse::base_color] = map_of(folder / "white.png");
    material.maps[MapUse::roughness] = map_of(folder / "almost.png");
    const TextureSet set = bake_quietly({material});
    EXPECT_EQ(set.textures[0].width, 1u);
    EXPECT_EQ(set.textures[0].height, 1u);
    EXPECT_EQ(first_texels(set.textures[0], 1), (std::vector{255}));
    EXPECT_EQ(set.textures[1].width, 32u);
}

TEST(TextureSets, AreTheSameForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    std::vector<SourceMaterial> materials;
    for (int i = 0; i < 12; ++i) {
        const auto path = folder / (std::to_string(i) + ".png");
        write_image(path, 60 + i, 50, 4, [=](int x, int y) {
            return std::vector{(x * 7 + i) % 90 / 90.0, y / 50.0, (x ^ y) % 50 / 50.0,
                               (x * y) % 11 / 11.0};
        });
        SourceMaterial material;
        material.maps[MapUse::base_color] = map_of(path);
        material.maps[MapUse::roughness] = map_of(path);
        material.bump_map = bake::BumpMap{map_of(path, "", Channel::luminance), 2.0f};
        materials.push_back(material);
    }
    const auto bake_with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return bake_quietly(materials);
    };
    const TextureSet one = bake_with(1);
    const TextureSet four = bake_with(4);
    ASSERT_EQ(one.textures.size(), 4u * 12u);
    ASSERT_EQ(four.textures.size(), one.textures.size());
    for (std::size_t i = 0; i < one.textures.size(); ++i) {
        EXPECT_EQ(one.textures[i].name, four.textures[i].name);
        EXPECT_EQ(one.textures[i].payload, four.textures[i].payload);
    }
}

TEST(Progress, RisesToOneAndNamesTheImages) {
    const TemporaryFolder folder;
    write_pair(folder / "a.png", {0.25}, {0.5});
    write_pair(folder / "b.png", {0.5}, {0.25});
    SourceMaterial material;
    material.maps[MapUse::roughness] = map_of(folder / "a.png");
    material.maps[MapUse::metalness] = map_of(folder / "b.png");
    double last = 0.0;
    std::vector<std::string> names;
    bake::bake_textures(
        std::vector{material}, bake::TextureMode::lossless, {}, [](const std::string&) {},
        [&](double done, std::string_view name) {
            EXPECT_GE(done, last);
            last = done;
            names.emplace_back(name);
        });
    EXPECT_DOUBLE_EQ(last, 1.0);
    EXPECT_NE(std::ranges::find(names, "a.png"), names.end());
    EXPECT_NE(std::ranges::find(names, "b.png"), names.end());
}

/// A normal map of ridges along y, 8 x 8.
void write_ridges(const std::filesystem::path& path) {
    write_image(path, 8, 8, 3, [](int x, int) {
        return std::vector{0.5 + (x % 2 ? 0.2 : -0.2), 0.5, 0.5 + 0.4583};
    });
}

TEST(Blocks, BumpsBecomeRoughnessAtSmallerLevelsWithTheFactorInIt) {
    const TemporaryFolder folder;
    write_ridges(folder / "ridges.png");
    SourceMaterial smooth;
    smooth.roughness = 0.2f;
    smooth.maps[MapUse::normal] = map_of(folder / "ridges.png");
    SourceMaterial rough = smooth;
    rough.roughness = 1.0f;
    const auto bake_as = [&](bake::TextureMode mode) {
        return bake::bake_textures({{smooth, rough}}, mode, {},
                                   [](const std::string& line) { ADD_FAILURE() << line; }, {});
    };
    const TextureSet blocks = bake_as(bake::TextureMode::bc);
    ASSERT_NE(blocks.materials[0].textures[MapUse::roughness], kNoTexture);
    EXPECT_TRUE(blocks.materials[0].roughness_holds_factor);
    const Texture& texture = blocks.textures[blocks.materials[0].textures[MapUse::roughness]];
    EXPECT_EQ(texture.format, mesh_format::TextureFormat::bc4_unorm);
    EXPECT_EQ(texture.width, 8u);
    EXPECT_EQ(texture.payload[0], std::byte{51}) << "nothing is averaged at level 0";
    EXPECT_GT(texture.payload[4 * 8], std::byte{100}) << "level 1";
    EXPECT_EQ(blocks.materials[1].textures[MapUse::roughness], kNoTexture)
        << "no bump makes it rougher";
    EXPECT_FALSE(blocks.materials[1].roughness_holds_factor);
    const TextureSet lossless = bake_as(bake::TextureMode::lossless);
    EXPECT_EQ(lossless.materials[0].textures[MapUse::roughness], kNoTexture);
    EXPECT_FALSE(lossless.materials[0].roughness_holds_factor);
}

TEST(Blocks, LowerBumpsMakeLessRoughness) {
    const TemporaryFolder folder;
    write_image(folder / "bumps.png", 32, 32, 3, [](int x, int y) {
        return std::vector{0.5 + 0.3 * std::sin(2.0 * x), 0.5 + 0.3 * std::sin(1.7 * y), 0.9};
    });
    const auto last_roughness = [&](float scale) {
        SourceMaterial material;
        material.roughness = 0.3f;
        material.maps[MapUse::normal] = map_of(folder / "bumps.png");
        material.normal_scale = scale;
        const TextureSet set =
            bake::bake_textures({{material}}, bake::TextureMode::bc, {},
                                [](const std::string& line) { ADD_FAILURE() << line; }, {});
        const Texture& texture = set.textures.at(set.materials[0].textures[MapUse::roughness]);
        return std::to_integer<int>(texture.payload[texture.payload.size() - 16]);
    };
    EXPECT_LT(last_roughness(0.5f), last_roughness(1.0f));
    EXPECT_LT(last_roughness(1.0f), last_roughness(2.0f));
}

TEST(Blocks, EveryUseHasItsFormat) {
    const TemporaryFolder folder;
    // Of colours on a line, as BC1 has them.
    const auto ramp = [](int x, int) {
        return std::vector{x / 32.0, x / 64.0, 0.3, x < 9 ? 0.0 : 1.0};
    };
    write_image(folder / "color.png", 16, 16, 4, ramp);
    write_image(folder / "grey.png", 16, 16, 1, [](int x, int) { return std::vector{x / 20.0}; });
    write_ridges(folder / "ridges.png");
    SourceMaterial material;
    material.maps[MapUse::base_color] = map_of(folder / "color.png");
    material.maps[MapUse::roughness] = map_of(folder / "grey.png");
    material.maps[MapUse::metalness] = map_of(folder / "grey.png");
    material.maps[MapUse::normal] = map_of(folder / "ridges.png");
    const TextureSet set =
        bake::bake_textures({{material}}, bake::TextureMode::bc, {},
                            [](const std::string& line) { ADD_FAILURE() << line; }, {});
    const bake::MaterialTextures& uses = set.materials[0];
    const auto format = [&](std::uint32_t index) { return set.textures.at(index).format; };
    EXPECT_EQ(format(uses.textures[MapUse::base_color]), mesh_format::TextureFormat::bc1_srgb);
    EXPECT_EQ(format(uses.textures[MapUse::alpha_mask]), mesh_format::TextureFormat::bc4_unorm);
    EXPECT_EQ(format(uses.textures[MapUse::roughness]), mesh_format::TextureFormat::bc4_unorm);
    EXPECT_EQ(format(uses.textures[MapUse::metalness]), mesh_format::TextureFormat::bc4_unorm);
    EXPECT_EQ(format(uses.textures[MapUse::normal]), mesh_format::TextureFormat::bc5_unorm);
}

}  // namespace
