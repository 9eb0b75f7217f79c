// Images of every kind, sound and broken, as materials meet them.
#include <gtest/gtest.h>
#include <png.h>
#include <sys/stat.h>

#include <cmath>

#include "cw2-bake/textures/read_image.h"
#include "cw2-bake/textures/textures.h"
#include "image_files.h"
#include "mesh-format/blocks.h"

namespace {

using mesh_format::MapUse;

using bake::SourceMaterial;
using bake::Texture;
using mesh_format::kNoTexture;
using mesh_format::TextureFormat;

struct Baked {
    bake::TextureSet set;
    std::vector<std::string> warnings;

    const Texture& texture(std::uint32_t index) const { return set.textures.at(index); }
    /// Byte `channel` of texel (x, y) of level 0.
    int byte(std::uint32_t index, std::uint32_t x, std::uint32_t y, std::size_t channel = 0) const {
        const Texture& in = texture(index);
        const std::size_t texel = std::size_t{y} * in.width + x;
        return std::to_integer<int>(
            in.payload.at(texel * mesh_format::block_bytes(in.format) + channel));
    }
};

Baked bake_all(const std::vector<SourceMaterial>& materials) {
    Baked baked;
    baked.set =
        bake::bake_textures(materials, bake::TextureMode::lossless, {},
                            [&](const std::string& line) { baked.warnings.push_back(line); }, {});
    EXPECT_EQ(baked.set.materials.size(), materials.size());
    for (const Texture& texture : baked.set.textures) {
        EXPECT_EQ(texture.payload.size(),
                  mesh_format::mip_chain_bytes(texture.format, texture.width, texture.height));
    }
    return baked;
}

SourceMaterial with_color(const bake::TextureMap& map) {
    SourceMaterial material;
    material.maps[MapUse::base_color] = map;
    return material;
}

SourceMaterial with_roughness(const bake::TextureMap& map) {
    SourceMaterial material;
    material.maps[MapUse::roughness] = map;
    return material;
}

/// Channels that can be told apart, and that differ from texel to texel.
std::vector<double> rgba(int x, int y) {
    return {(10 + x) / 255.0, (100 + y) / 255.0, (200 + x) / 255.0, (x + y) % 2 ? 1.0 : 0.2};
}
std::vector<double> rgb(int x, int y) {
    std::vector<double> texel = rgba(x, y);
    texel.pop_back();
    return texel;
}
std::vector<double> grey(int x, int y) {
    return {(20 + 10 * x + y) / 255.0};
}

TEST(ImageFiles, BytesOfLosslessFormatsArriveUnchanged) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.tif", "a.tga", "a.bmp", "a.ppm"}) {
        SCOPED_TRACE(name);
        write_image(folder / name, 8, 6, 3, rgb);
        const Baked baked = bake_all({with_color(map_of(folder / name))});
        ASSERT_TRUE(baked.warnings.empty()) << baked.warnings[0];
        const std::uint32_t index = baked.set.materials[0].textures[MapUse::base_color];
        EXPECT_EQ(baked.texture(index).name, name);
        EXPECT_EQ(baked.texture(index).format, TextureFormat::rgba8_srgb);
        EXPECT_EQ(baked.texture(index).width, 8u);
        EXPECT_EQ(baked.texture(index).height, 6u);
        for (const auto& [x, y] : {std::pair{0u, 0u}, {7u, 0u}, {3u, 5u}}) {
            EXPECT_EQ(baked.byte(index, x, y, 0), static_cast<int>(10 + x));
            EXPECT_EQ(baked.byte(index, x, y, 1), static_cast<int>(100 + y));
            EXPECT_EQ(baked.byte(index, x, y, 2), static_cast<int>(200 + x));
            EXPECT_EQ(baked.byte(index, x, y, 3), 255);
        }
    }
}

TEST(ImageFiles, GreyServesAsColourAndAsScalar) {
    const TemporaryFolder folder;
    write_image(folder / "grey.png", 4, 4, 1, grey);
    SourceMaterial material = with_color(map_of(folder / "grey.png"));
    material.maps[MapUse::roughness] = map_of(folder / "grey.png");
    const Baked baked = bake_all({material});
    const bake::MaterialTextures& uses = baked.set.materials[0];
    EXPECT_EQ(baked.texture(uses.textures[MapUse::roughness]).format, TextureFormat::r8_unorm);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(baked.byte(uses.textures[MapUse::base_color], 2, 3, c), 43);
    }
    EXPECT_EQ(baked.byte(uses.textures[MapUse::roughness], 2, 3), 43);
}

TEST(ImageFiles, SixteenBitsAreRounded) {
    const TemporaryFolder folder;
    write_image(
        folder / "deep.png", 2, 1, 1,
        [](int x, int) { return std::vector{(x ? 77.4 : 76.6) / 255.0}; }, OIIO::TypeDesc::UINT16);
    const Baked baked = bake_all({with_roughness(map_of(folder / "deep.png"))});
    ASSERT_TRUE(baked.warnings.empty());
    EXPECT_EQ(baked.set.textures[0].width, 1u) << "both round to 77";
    EXPECT_EQ(baked.byte(0, 0, 0), 77);
    const Baked colors = bake_all({with_color(map_of(folder / "deep.png"))});
    EXPECT_EQ(colors.byte(0, 0, 0), 77) << "16 bits are sRGB as 8 are";
}

TEST(ImageFiles, FloatsHoldLinearLight) {
    const TemporaryFolder folder;
    write_image(
        folder / "light.exr", 2, 1, 3, [](int x, int) { return std::vector(3, x ? 0.5 : 4.0); },
        OIIO::TypeDesc::FLOAT);
    const Baked baked = bake_all({with_color(map_of(folder / "light.exr"))});
    ASSERT_TRUE(baked.warnings.empty());
    EXPECT_EQ(baked.byte(0, 0, 0), 255);
    EXPECT_EQ(baked.byte(0, 1, 0), 188);
}

TEST(ImageFiles, PalettesAreLookedUp) {
    const TemporaryFolder folder;
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = 2;
    image.height = 1;
    image.format = PNG_FORMAT_RGB_COLORMAP;
    image.colormap_entries = 2;
    const png_byte indices[] = {1, 0};
    const png_byte colors[] = {10, 20, 30, 200, 210, 220};
    ASSERT_TRUE(png_image_write_to_file(&image, (folder / "p.png").c_str(), 0, indices, 0, colors));
    const Baked baked = bake_all({with_color(map_of(folder / "p.png"))});
    ASSERT_TRUE(baked.warnings.empty());
    EXPECT_EQ(baked.byte(0, 0, 0, 1), 210);
    EXPECT_EQ(baked.byte(0, 1, 0, 2), 30);
}

TEST(ImageFiles, CmykBecomesRgb) {
    const TemporaryFolder folder;
    write_image(folder / "cmyk.tif", 8, 6, 3, rgb, OIIO::TypeDesc::UINT8, "tiff:ColorSpace",
                "CMYK");
    const auto input = OIIO::ImageInput::open((folder / "cmyk.tif").string());
    ASSERT_TRUE(input);
    const Baked baked = bake_all({with_color(map_of(folder / "cmyk.tif"))});
    ASSERT_TRUE(baked.warnings.empty());
    EXPECT_NEAR(baked.byte(0, 7, 5, 0), 17, 2);
    EXPECT_NEAR(baked.byte(0, 7, 5, 1), 105, 2);
    EXPECT_NEAR(baked.byte(0, 7, 5, 2), 207, 2);
}

TEST(ImageFiles, ContentDecidesWhereTheExtensionMisleads) {
    const TemporaryFolder folder;
    write_image(folder / "a.png", 8, 6, 3, rgb);
    for (const char* name : {"a.jpg", "a.tga", "a", "a.weird"}) {
        SCOPED_TRACE(name);
        std::filesystem::copy_file(folder / "a.png", folder / name);
        const Baked baked = bake_all({with_color(map_of(folder / name))});
        ASSERT_TRUE(baked.warnings.empty()) << baked.warnings[0];
        EXPECT_EQ(baked.byte(0, 3, 5, 1), 105);
    }
}

TEST(ImageFiles, ColourUnderLowAlphaIsNotPremultiplied) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.tif", "a.tga"}) {
        SCOPED_TRACE(name);
        write_image(folder / name, 8, 6, 4, [](int x, int y) {
            std::vector<double> texel = rgba(x, y);
            texel[3] = 0.6;
            return texel;
        });
        const Baked baked = bake_all({with_color(map_of(folder / name))});
        ASSERT_TRUE(baked.warnings.empty()) << baked.warnings[0];
        EXPECT_EQ(baked.set.materials[0].textures[MapUse::alpha_mask], kNoTexture)
            << "nothing is below one half";
        EXPECT_EQ(baked.byte(0, 3, 5, 2), 203);
    }
}

/// The mean over the bytes of level 0, decoded.
double mean_byte(const Texture& texture) {
    const std::size_t texel = mesh_format::block_extent(texture.format) > 1
                                  ? mesh_format::decoded_texel_bytes(texture.format)
                                  : mesh_format::block_bytes(texture.format);
    std::vector<std::byte> row(4 * texel * texture.width);
    double sum = 0.0;
    for (std::uint32_t y = 0; y < texture.height; y += mesh_format::block_extent(texture.format)) {
        const std::size_t stride =
            std::size_t{mesh_format::block_count(texture.format, texture.width)} *
            mesh_format::block_bytes(texture.format);
        const std::byte* stored =
            texture.payload.data() + y / mesh_format::block_extent(texture.format) * stride;
        std::uint32_t rows = 1;
        if (mesh_format::block_extent(texture.format) > 1) {
            rows = std::min(4u, texture.height - y);
            mesh_format::decode_block_row(texture.format, stored, texture.width, rows, row.data());
        } else {
            std::copy_n(stored, stride, row.data());
        }
        for (std::size_t i = 0; i < rows * texel * texture.width; ++i) {
            sum += std::to_integer<int>(row[i]);
        }
    }
    return sum / (static_cast<double>(texel) * texture.width * texture.height);
}

TEST(ImageFiles, EveryKindServesInBlocksAsItDoesWithout) {
    const TemporaryFolder folder;
    const auto smooth = [](int channels) {
        return [channels](int x, int y) {
            return std::vector(static_cast<std::size_t>(channels),
                               0.5 + 0.4 * std::sin(0.01 * (x + y)));
        };
    };
    write_image(folder / "grey.png", 20, 30, 1, smooth(1));
    write_image(folder / "deep.png", 20, 30, 3, smooth(3), OIIO::TypeDesc::UINT16);
    write_image(folder / "float.exr", 20, 30, 3, smooth(3), OIIO::TypeDesc::HALF);
    write_image(folder / "cmyk.tif", 20, 30, 3, smooth(3), OIIO::TypeDesc::UINT8, "tiff:ColorSpace",
                "CMYK");
    write_image(folder / "huge.png", 16'384, 5, 1, smooth(1));
    write_image(folder / "tall.jpg", 3, 16'384, 3, smooth(3));
    write_image(folder / "misnamed.png", 20, 30, 3, smooth(3));
    std::filesystem::rename(folder / "misnamed.png", folder / "misnamed.jpg");
    for (const char* name : {"grey.png", "deep.png", "float.exr", "cmyk.tif", "huge.png",
                             "tall.jpg", "misnamed.jpg"}) {
        SCOPED_TRACE(name);
        SourceMaterial material = with_color(map_of(folder / name));
        material.maps[MapUse::roughness] = map_of(folder / name);
        const Baked plain = bake_all({material});
        const bake::TextureSet blocks =
            bake::bake_textures({{material}}, bake::TextureMode::bc, {},
                                [](const std::string& line) { ADD_FAILURE() << line; }, {});
        EXPECT_TRUE(plain.warnings.empty());
        ASSERT_EQ(blocks.textures.size(), 2u);
        EXPECT_EQ(blocks.textures[0].format, TextureFormat::bc1_srgb);
        EXPECT_EQ(blocks.textures[1].format, TextureFormat::bc4_unorm);
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(blocks.textures[i].width, plain.texture(0).width);
            EXPECT_EQ(blocks.textures[i].height, plain.texture(0).height);
            EXPECT_NEAR(mean_byte(blocks.textures[i]),
                        mean_byte(plain.texture(static_cast<std::uint32_t>(i))), 1.0);
        }
    }
}

/// Bakes a material that names `path` as its roughness, and expects one warning about it.
void expect_refused(const std::filesystem::path& path, const std::string& cause) {
    SCOPED_TRACE(path.filename().string());
    testing::internal::CaptureStderr();
    std::size_t in_blocks = 0;
    const bake::TextureSet blocks =
        bake::bake_textures({{with_roughness(map_of(path, "lib/x.mtl:42"))}}, bake::TextureMode::bc,
                            {}, [&](const std::string&) { ++in_blocks; }, {});
    EXPECT_EQ(in_blocks, 1u);
    EXPECT_TRUE(blocks.textures.empty());
    const Baked baked = bake_all({with_roughness(map_of(path, "lib/x.mtl:42"))});
    EXPECT_EQ(baked.set.materials[0].textures[MapUse::roughness], kNoTexture);
    EXPECT_TRUE(baked.set.textures.empty());
    ASSERT_EQ(baked.warnings.size(), 1u);
    const std::string& line = baked.warnings[0];
    EXPECT_EQ(line.find("lib/x.mtl:42: " + path.string() + ": "), 0u) << line;
    EXPECT_NE(line.find(cause), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "decoders keep quiet";
    const bake::Warn strict = [](const std::string& text) { throw bake::BakeError(text); };
    EXPECT_THROW(bake::bake_textures({{with_roughness(map_of(path))}}, bake::TextureMode::bc, {},
                                     strict, {}),
                 bake::BakeError);
}

TEST(BadImages, WhatIsNoImageIsAWarningThatNamesItAndItsPlace) {
    const TemporaryFolder folder;
    expect_refused(folder / "missing.png", "no such file");
    std::filesystem::create_directory(folder / "folder.png");
    expect_refused(folder / "folder.png", "directory");
    write_bytes(folder / "zero.png", "");
    expect_refused(folder / "zero.png", "empty");
    write_bytes(folder / "zero.jpg", "");
    expect_refused(folder / "zero.jpg", "empty");
    ASSERT_EQ(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
    expect_refused(folder / "pipe.png", "not a regular file");
    write_bytes(folder / "text.png", "newmtl a\nKd 1 1 1\n");
    expect_refused(folder / "text.png", "");
    write_bytes(folder / "text.mtl", "newmtl a\nKd 1 1 1\n");
    expect_refused(folder / "text.mtl", "");
    write_bytes(folder / "noise.tga", std::string(5000, '\xA5'));
    expect_refused(folder / "noise.tga", "");
}

TEST(BadImages, ImagesThatEndEarlyAreRefused) {
    const TemporaryFolder folder;
    const auto noise = [](int x, int y) {
        const double value =
            std::fmod(std::abs(std::sin(x * 12.9898 + y * 78.233)) * 43'758.5, 1.0);
        return std::vector{value, 1.0 - value, value * value};
    };
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.tga", "a.bmp", "a.exr", "a.ppm"}) {
        for (const double share : {0.01, 0.3, 0.9}) {
            write_image(folder / name, 64, 64, 3, noise);
            truncate(folder / name, share);
            expect_refused(folder / name, "");
        }
    }
}

TEST(BadImages, DamagedBytesNeverCrash) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.tga", "a.bmp", "a.exr"}) {
        write_image(folder / name, 16, 16, 3, rgb);
        std::ifstream in(folder / name, std::ios::binary);
        const std::string sound((std::istreambuf_iterator<char>(in)), {});
        for (std::size_t at = 0; at < sound.size(); at += 1 + sound.size() / 60) {
            std::string bytes = sound;
            bytes[at] = static_cast<char>(bytes[at] ^ 0xFF);
            write_bytes(folder / name, bytes);
            const Baked baked = bake_all({with_roughness(map_of(folder / name))});
            EXPECT_LE(baked.warnings.size(), 1u);
        }
    }
}

TEST(BadImages, SizesBeyondTheLimitAreRefusedBeforeAnythingIsAllocated) {
    const TemporaryFolder folder;
    write_bytes(folder / "huge.ppm", "P6\n2000000 1000000\n255\n");
    expect_refused(folder / "huge.ppm", "2000000");  // by OpenImageIO, where it has a limit
    write_bytes(folder / "large.ppm", "P6\n60000 50000\n255\n");
    expect_refused(folder / "large.ppm", "60000 x 50000");
    write_image(folder / "wide.png", 16'385, 1, 1, [](int, int) { return std::vector{0.5}; });
    expect_refused(folder / "wide.png", "16384");
    write_image(folder / "most.png", 16'384, 1, 1,
                [](int x, int) { return std::vector{x / 16'384.0}; });
    EXPECT_TRUE(bake_all({with_roughness(map_of(folder / "most.png"))}).warnings.empty());
}

TEST(BadImages, OneWarningAnImageInOrderOfFirstUse) {
    const TemporaryFolder folder;
    SourceMaterial first = with_color(map_of(folder / "z.png", "a.mtl:2"));
    first.maps[MapUse::metalness] = map_of(folder / "a.png", "a.mtl:3");
    SourceMaterial second = with_color(map_of(folder / "a.png", "a.mtl:7"));
    second.maps[MapUse::roughness] = map_of(folder / "z.png", "a.mtl:8");
    const Baked baked = bake_all({first, second});
    ASSERT_EQ(baked.warnings.size(), 2u);
    EXPECT_EQ(baked.warnings[0].find("a.mtl:2: "), 0u);
    EXPECT_EQ(baked.warnings[1].find("a.mtl:3: "), 0u);
}

TEST(BadImages, AWarningMayEndTheBake) {
    const std::vector<SourceMaterial> materials{with_color(map_of("/nowhere/a.png"))};
    const bake::Warn strict = [](const std::string& line) { throw bake::BakeError(line); };
    EXPECT_THROW(bake::bake_textures(materials, bake::TextureMode::lossless, {}, strict, {}),
                 bake::BakeError);
}

TEST(ImageFiles, AFileThatIsTooShortForItsSizeIsRefusedBeforeThereIsMemoryForIt) {
    const TemporaryFolder folder;
    const std::string tga{0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x40, 0, 0x40, 32, 8};
    const std::pair<const char*, std::string> table[] = {
        {"a.ppm", "P6 16384 16384 255\n"},
        {"a.pgm", "P2 16384 16384 255\n0 0 0\n"},
        {"a.pfm", "PF\n16384 16384\n-1.0\n"},
        {"a.tga", tga},
        {"a.gif", {'G', 'I', 'F', '8', '9', 'a', 0, 0x40, 0, 0x40, 0, 0, 0, ';'}},
        {"a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n"}};
    for (const auto& [name, bytes] : table) {
        write_bytes(folder / name, bytes);
        try {
            bake::read_image(folder / name);
            FAIL() << name;
        } catch (const bake::ImageError& error) {
            EXPECT_STREQ(error.what(), "is damaged: it is too short for the size that it states");
        }
    }
    // What is as short as can be is read.
    write_image(
        folder / "flat.tga", 512, 512, 4,
        [](int, int) {
            return std::vector{0.0, 0.0, 0.0, 1.0};
        },
        OIIO::TypeDesc::UINT8, "compression", "rle");
    EXPECT_EQ(bake::read_image(folder / "flat.tga").width, 512u);
    write_image(
        folder / "flat.gif", 2048, 2048, 3,
        [](int, int) {
            return std::vector{0.0, 0.0, 0.0};
        },
        OIIO::TypeDesc::UINT8);
    EXPECT_EQ(bake::read_image(folder / "flat.gif").width, 2048u);
}

TEST(ImageFiles, AMovieIsNoImage) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.AVI", "ffconcat version 1.0\nfile 'b.png'\n");
    try {
        bake::read_image(folder / "a.AVI");
        FAIL();
    } catch (const bake::ImageError& error) {
        EXPECT_STREQ(error.what(), "is a movie, not an image");
    }
}

}  // namespace
