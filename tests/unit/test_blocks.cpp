// Blocks of texels: decoded by the rules of their format, and compressed within stated errors.
#include <gtest/gtest.h>
#include <stb/stb_dxt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "cw2-bake/textures/block_compression.h"
#include "mesh-format/bc7.h"
#include "mesh-format/blocks.h"

namespace {

using bake::Texture;
using mesh_format::TextureFormat;

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

/// One block, decoded whole.
std::vector<int> decode(TextureFormat format, const Bytes& block) {
    Bytes out(std::size_t{16} * mesh_format::decoded_texel_bytes(format));
    mesh_format::decode_block_row(format, block.data(), 4, 4, out.data());
    std::vector<int> values;
    for (const std::byte value : out) values.push_back(std::to_integer<int>(value));
    return values;
}

std::vector<int> first(std::vector<int> values, std::size_t count) {
    values.resize(count);
    return values;
}

TEST(Blocks, FourColoursWhereTheFirstIsLarger) {
    // Pure red and pure blue; the first row has the indices 0 to 3.
    const Bytes block = bytes_of({0x00, 0xF8, 0x1F, 0x00, 0b11100100, 0, 0, 0});
    EXPECT_EQ(first(decode(TextureFormat::bc1_srgb, block), 16),
              (std::vector{255, 0, 0, 255, 0, 0, 255, 255, 170, 0, 85, 255, 85, 0, 170, 255}));
}

TEST(Blocks, ThreeColoursAndBlackWhereTheFirstIsNotLarger) {
    const Bytes block = bytes_of({0x1F, 0x00, 0x00, 0xF8, 0b11100100, 0, 0, 0});
    EXPECT_EQ(first(decode(TextureFormat::bc1_srgb, block), 16),
              (std::vector{0, 0, 255, 255, 255, 0, 0, 255, 128, 0, 128, 255, 0, 0, 0, 255}));
}

TEST(Blocks, SixBitsOfGreenAndRowsFromTheTop) {
    // 0x0400: green 32 of 63, 130 of 255. The third row has index 1, black.
    const Bytes block = bytes_of({0x00, 0x04, 0x00, 0x00, 0, 0, 0b01010101, 0});
    const std::vector<int> texels = decode(TextureFormat::bc1_srgb, block);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(texels[4 * i + 1], i / 4 == 2 ? 0 : 130);
}

/// A BC4 block whose texel i has index i mod 8.
Bytes ramp_block(int a, int b) {
    std::uint64_t bits = static_cast<std::uint64_t>(a | b << 8);
    for (int i = 0; i < 16; ++i) bits |= static_cast<std::uint64_t>(i % 8) << (16 + 3 * i);
    Bytes block(8);
    std::memcpy(block.data(), &bits, 8);
    return block;
}

TEST(Blocks, EightValuesOrSixWithTheExtremes) {
    EXPECT_EQ(first(decode(TextureFormat::bc4_unorm, ramp_block(210, 0)), 8),
              (std::vector{210, 0, 180, 150, 120, 90, 60, 30}));
    EXPECT_EQ(first(decode(TextureFormat::bc4_unorm, ramp_block(50, 200)), 8),
              (std::vector{50, 200, 80, 110, 140, 170, 0, 255}));
}

TEST(Blocks, TwoChannelsAreTwoBlocks) {
    Bytes block = ramp_block(210, 0);
    const Bytes second = ramp_block(50, 200);
    block.insert(block.end(), second.begin(), second.end());
    EXPECT_EQ(first(decode(TextureFormat::bc5_unorm, block), 6),
              (std::vector{210, 50, 0, 200, 180, 80}));
}

/// A texture whose levels all are painted by `paint`(x, y, channel).
template <typename Paint>
Texture make_texture(TextureFormat format, std::uint32_t width, std::uint32_t height, Paint paint) {
    Texture texture{.name = "t", .format = format, .width = width, .height = height};
    const std::size_t texel = mesh_format::block_bytes(format);
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(width, height); ++i) {
        Bytes level(mesh_format::mip_bytes(format, width, height, i));
        const std::uint32_t row = mesh_format::mip_extent(width, i);
        for (std::uint32_t y = 0; y < mesh_format::mip_extent(height, i); ++y) {
            for (std::size_t j = 0; j < texel * row; ++j) {
                level[y * texel * row + j] = static_cast<std::byte>(
                    paint(static_cast<int>(j / texel), static_cast<int>(y), j % texel));
            }
        }
        texture.payload.insert(texture.payload.end(), level.begin(), level.end());
    }
    return texture;
}

/// The texels of every level of a texture with blocks, one level after the other.
std::vector<int> decode_all(const Texture& texture) {
    const std::size_t texel = mesh_format::decoded_texel_bytes(texture.format);
    std::vector<int> values;
    const std::byte* blocks = texture.payload.data();
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(texture.width, texture.height); ++i) {
        const std::uint32_t width = mesh_format::mip_extent(texture.width, i);
        const std::uint32_t height = mesh_format::mip_extent(texture.height, i);
        const std::byte* row = blocks;
        for (std::uint32_t y = 0; y < height; y += 4) {
            const std::uint32_t rows = std::min(4u, height - y);
            Bytes out(texel * width * rows);
            mesh_format::decode_block_row(texture.format, row, width, rows, out.data());
            row += std::size_t{mesh_format::block_count(texture.format, width)} *
                   mesh_format::block_bytes(texture.format);
            for (const std::byte value : out) values.push_back(std::to_integer<int>(value));
        }
        blocks += mesh_format::mip_bytes(texture.format, texture.width, texture.height, i);
    }
    return values;
}

/// The texels of every level without blocks, without padding.
std::vector<int> texels_of(const Texture& texture) {
    std::vector<int> values;
    const std::byte* level = texture.payload.data();
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(texture.width, texture.height); ++i) {
        const std::size_t bytes = std::size_t{mesh_format::mip_extent(texture.width, i)} *
                                  mesh_format::mip_extent(texture.height, i) *
                                  mesh_format::block_bytes(texture.format);
        for (std::size_t j = 0; j < bytes; ++j) values.push_back(std::to_integer<int>(level[j]));
        level += mesh_format::mip_bytes(texture.format, texture.width, texture.height, i);
    }
    return values;
}

double mean_square(const std::vector<int>& a, const std::vector<int>& b, std::size_t count) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum / static_cast<double>(count);
}

double wave(int x, int y, double shift) {
    return 0.5 + 0.5 * std::sin(0.11 * x + shift) * std::cos(0.07 * y - shift);
}

TEST(Blocks, ScalarsOfAnySizeAreWithinAFourteenthOfTheirBlocksRange) {
    std::mt19937 random(3);
    for (const auto& [width, height] : {std::pair{64u, 64u}, {7u, 5u}, {1u, 9u}, {30u, 2u}}) {
        SCOPED_TRACE(testing::Message() << width << " x " << height);
        const Texture plain = make_texture(
            TextureFormat::r8_unorm, width, height,
            [&](int, int, std::size_t) { return 90 + static_cast<int>(random() % 43); });
        Texture texture = plain;
        bake::compress_to_blocks(texture);
        ASSERT_EQ(texture.format, TextureFormat::bc4_unorm);
        ASSERT_EQ(texture.payload.size(),
                  mesh_format::mip_chain_bytes(texture.format, width, height));
        const std::vector<int> before = texels_of(plain);
        const std::vector<int> after = decode_all(texture);
        ASSERT_EQ(after.size(), before.size());
        for (std::size_t i = 0; i < before.size(); ++i) {
            ASSERT_NEAR(after[i], before[i], 42.0 / 14.0 + 0.5) << i;
        }
    }
}

/// Scalars are between the least and the largest value of a block: the same values as normals are
/// nearer, in every block.
TEST(Blocks, NormalsAreNearerThanBetweenTheirExtremes) {
    std::mt19937 random(3);
    constexpr std::uint32_t kSize = 64;
    const Texture scalars =
        make_texture(TextureFormat::r8_unorm, kSize, kSize, [&](int, int, std::size_t) {
            return 98 + static_cast<int>(random() % 20 + random() % 20 + random() % 20);
        });
    const std::vector<int> wanted = texels_of(scalars);
    Texture normals =
        make_texture(TextureFormat::rg8_unorm, kSize, kSize, [&](int x, int y, std::size_t c) {
            return c == 1 ? 128 : wanted[static_cast<std::size_t>(y) * kSize + x];
        });
    Texture blocks = scalars;
    bake::compress_to_blocks(blocks);
    bake::compress_to_blocks(normals);
    ASSERT_EQ(normals.format, TextureFormat::bc5_unorm);
    const std::vector<int> scalars_shown = decode_all(blocks);
    const std::vector<int> normals_shown = decode_all(normals);
    const auto square = [&](std::size_t texel, int shown) {
        return (shown - wanted[texel]) * (shown - wanted[texel]);
    };
    double of_scalars = 0.0;
    double of_normals = 0.0;
    for (std::size_t block = 0; block < kSize * kSize / 16; ++block) {
        int scalar = 0;
        int normal = 0;
        for (std::size_t i = 0; i < 16; ++i) {
            const std::size_t texel =
                (block / (kSize / 4) * 4 + i / 4) * kSize + block % (kSize / 4) * 4 + i % 4;
            scalar += square(texel, scalars_shown[texel]);
            normal += square(texel, normals_shown[2 * texel]);
        }
        ASSERT_LE(normal, scalar) << block;
        of_scalars += scalar;
        of_normals += normal;
    }
    EXPECT_LT(of_normals, 0.8 * of_scalars);
}

TEST(Blocks, AMasksTexelsStayOnTheirSideOfTheCutoffAtEveryLevel) {
    for (const float cutoff : {0.5f, 0.3f, 0.9f}) {
        const Texture plain =
            make_texture(TextureFormat::r8_unorm, 61, 47, [](int x, int y, std::size_t) {
                return std::clamp(static_cast<int>(600.0 * wave(x, y, 1.0)) - 150, 0, 255);
            });
        Texture texture = plain;
        bake::compress_to_blocks(texture, cutoff);
        ASSERT_EQ(texture.format, TextureFormat::bc4_unorm);
        EXPECT_TRUE(bake::fits_blocks({plain.payload.data(), 61, 47}, cutoff));
        const std::vector<int> before = texels_of(plain);
        const std::vector<int> after = decode_all(texture);
        for (std::size_t i = 0; i < before.size(); ++i) {
            ASSERT_EQ(static_cast<float>(before[i]) / 255.0f >= cutoff,
                      static_cast<float>(after[i]) / 255.0f >= cutoff)
                << i << ": " << before[i] << " became " << after[i];
        }
    }
}

TEST(Blocks, SmoothColoursAreCompressedAndTheirPsnrIsWhatItSays) {
    const Texture plain =
        make_texture(TextureFormat::rgba8_srgb, 50, 34, [](int x, int y, std::size_t c) {
            return c == 3 ? 255 : static_cast<int>(255.0 * wave(x, y, 0.3));
        });
    Texture texture = plain;
    bake::compress_to_blocks(texture);
    ASSERT_EQ(texture.format, TextureFormat::bc1_srgb);
    const double with_alpha =
        mean_square(texels_of(plain), decode_all(texture), std::size_t{50} * 34 * 4);
    EXPECT_NEAR(texture.psnr, 10.0 * std::log10(255.0 * 255.0 / (with_alpha * 4.0 / 3.0)), 0.01);
    EXPECT_GT(texture.psnr, 34.0f);
}

/// The mean square over red, green and blue of what stb_dxt makes of the first level.
double mean_square_of_stb(const Texture& plain) {
    Texture theirs = plain;
    theirs.format = TextureFormat::bc1_srgb;
    theirs.payload.clear();
    for (std::size_t y = 0; y < plain.height; y += 4) {
        for (std::size_t x = 0; x < plain.width; x += 4) {
            std::array<unsigned char, 64> texels;
            for (std::size_t row = 0; row < 4; ++row) {
                std::memcpy(texels.data() + 16 * row,
                            plain.payload.data() + 4 * ((y + row) * plain.width + x), 16);
            }
            std::array<unsigned char, 8> block;
            stb_compress_dxt_block(block.data(), texels.data(), 0, STB_DXT_NORMAL);
            for (const unsigned char byte : block) theirs.payload.push_back(std::byte{byte});
        }
    }
    theirs.payload.resize(mesh_format::mip_chain_bytes(theirs.format, plain.width, plain.height));
    const std::size_t count = std::size_t{4} * plain.width * plain.height;
    return mean_square(texels_of(plain), decode_all(theirs), count) * 4.0 / 3.0;
}

TEST(Blocks, ColoursAreNoFartherOffThanThoseOfStb) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise;
    const auto paint = [&](double roughness, double chroma) {
        return make_texture(TextureFormat::rgba8_srgb, 128, 64, [&](int x, int y, std::size_t c) {
            const double value =
                wave(x, y, chroma * static_cast<double>(c)) + roughness * noise(random);
            return c == 3 ? 255 : std::clamp(static_cast<int>(255.0 * value), 0, 255);
        });
    };
    for (const double roughness : {0.0, 0.01, 0.04}) {
        for (const double chroma : {0.0, 0.2, 1.5}) {
            Texture texture = paint(roughness, chroma);
            const double theirs = mean_square_of_stb(texture);
            bake::compress_to_blocks(texture);
            EXPECT_GE(texture.psnr, 10.0 * std::log10(255.0 * 255.0 / theirs))
                << roughness << ' ' << chroma;
        }
    }
}

TEST(Blocks, FlatColoursAreMetWithinTwo) {
    for (int value = 0; value < 256; ++value) {
        Texture texture =
            make_texture(TextureFormat::rgba8_srgb, 4, 4, [&](int, int, std::size_t c) {
                return c == 3 ? 255 : c == 1 ? 255 - value : value;
            });
        bake::compress_to_blocks(texture);
        const std::vector<int> colors = decode_all(texture);
        EXPECT_NEAR(colors[0], value, 2);
        EXPECT_NEAR(colors[1], 255 - value, 1);
    }
}

TEST(Blocks, NoiseStaysAsItIsAndSaysWhy) {
    std::mt19937 random(1);
    const auto noise = [&](int, int, std::size_t) { return static_cast<int>(random() % 256); };
    for (const TextureFormat format :
         {TextureFormat::rgba8_srgb, TextureFormat::rg8_unorm, TextureFormat::r8_unorm}) {
        const Texture plain = make_texture(format, 32, 32, noise);
        Texture texture = plain;
        bake::compress_to_blocks(texture);
        EXPECT_EQ(texture.format, format);
        EXPECT_EQ(texture.payload, plain.payload);
        EXPECT_GT(texture.psnr, 5.0f);
        EXPECT_LT(texture.psnr, 34.0f);
        EXPECT_FALSE(bake::fits_blocks({plain.payload.data(), 32, 32}, 0.5f));
    }
}

TEST(Blocks, NormalsKeepTheirDirectionWithZRebuilt) {
    constexpr int kSize = 64;
    const auto slope = [](int x, int y, int axis) {
        return 0.6 * std::sin(0.2 * x + axis) * std::cos(0.15 * y + 2.0 * axis);
    };
    const Texture plain =
        make_texture(TextureFormat::rg8_unorm, kSize, kSize, [&](int x, int y, std::size_t c) {
            const double n[3] = {slope(x, y, 0), slope(x, y, 1), 1.0};
            const double length = std::hypot(n[0], n[1], n[2]);
            return static_cast<int>(std::lround(127.5 * (n[c] / length + 1.0)));
        });
    Texture texture = plain;
    bake::compress_to_blocks(texture);
    ASSERT_EQ(texture.format, TextureFormat::bc5_unorm);
    const std::vector<int> before = texels_of(plain);
    const std::vector<int> after = decode_all(texture);
    double squares = 0.0;
    for (std::size_t i = 0; i < std::size_t{kSize} * kSize; ++i) {
        const auto normal = [i](const std::vector<int>& texels) {
            const double x = texels[2 * i] / 127.5 - 1.0;
            const double y = texels[2 * i + 1] / 127.5 - 1.0;
            return std::array{x, y, std::sqrt(std::max(0.0, 1.0 - x * x - y * y))};
        };
        const auto [x, y, z] = normal(before);
        const auto [decoded_x, decoded_y, decoded_z] = normal(after);
        const double chord = std::hypot(decoded_x - x, decoded_y - y, decoded_z - z);
        squares += chord * chord;
    }
    const double mean = squares / (kSize * kSize);
    EXPECT_NEAR(texture.psnr, 10.0 * std::log10(4.0 * 3.0 / mean), 0.01)
        << "of 0.5 n + 0.5, so that a chord c is a mean square of c^2 / 12";
    EXPECT_LT(std::sqrt(mean) * 180.0 / std::numbers::pi, 1.0) << "degrees";
}

/// Numbers of so many bits each, from the lowest bit.
Bytes block_of(std::initializer_list<std::pair<std::uint32_t, int>> numbers) {
    Bytes block(16);
    std::size_t at = 0;
    for (const auto& [number, bits] : numbers) {
        for (int i = 0; i < bits; ++i, ++at) {
            if (number >> i & 1) block[at / 8] |= std::byte{1} << at % 8;
        }
    }
    EXPECT_EQ(at, 128u);
    return block;
}

TEST(Blocks, TwoLinesOfEightColours) {
    // The upper half between (255, 2, 2) and (2, 255, 2), the lower between 0 and 129.
    const Bytes block =
        block_of({{2, 2}, {13, 6}, {63, 6}, {0, 6}, {0, 6}, {32, 6}, {0, 6}, {63, 6},
                  {0, 6}, {32, 6}, {0, 6},  {0, 6}, {0, 6}, {32, 6}, {1, 1}, {0, 1},
                  {0, 2}, {7, 3},  {3, 3},  {0, 3}, {0, 3}, {0, 3},  {0, 3}, {0, 3},
                  {0, 3}, {7, 3},  {4, 3},  {0, 3}, {0, 3}, {0, 3},  {0, 3}, {3, 2}});
    const std::vector<int> texels = decode(TextureFormat::bc7_srgb, block);
    EXPECT_EQ(first(texels, 12), (std::vector{255, 2, 2, 255, 2, 255, 2, 255, 148, 109, 2, 255}));
    EXPECT_EQ(std::vector(texels.begin() + 32, texels.begin() + 44),
              (std::vector{0, 0, 0, 255, 129, 129, 129, 255, 75, 75, 75, 255}));
    EXPECT_EQ(std::vector(texels.begin() + 60, texels.end()), (std::vector{54, 54, 54, 255}));
}

TEST(Blocks, OfModesAndPartitionsThatNobodyWritesAreBlack) {
    for (const int first_byte : {64, 2 | 16 << 2}) {
        Bytes block(16, std::byte{0xFF});
        block[0] = static_cast<std::byte>(first_byte);
        const std::vector<int> texels = decode(TextureFormat::bc7_srgb, block);
        for (std::size_t i = 0; i < texels.size(); ++i) EXPECT_EQ(texels[i], i % 4 == 3 ? 255 : 0);
    }
}

TEST(Blocks, ColoursThatOneLineMissesAreMetByTwo) {
    std::mt19937 random(4);
    // Odd sizes, and one of the partitions in each block.
    const Texture plain =
        make_texture(TextureFormat::rgba8_srgb, 61, 47, [&](int x, int y, std::size_t c) {
            const std::size_t partition = static_cast<std::size_t>(x / 4 + 3 * (y / 4)) % 16;
            const bool second = mesh_format::kBc7Subsets[partition] >> (4 * (y % 4) + x % 4) & 1;
            const int along = static_cast<int>(random() % 2) + 25 * ((x + y) % 4);
            return c == 3 ? 255 : second ? (c == 0 ? 60 + along : 40) : c == 2 ? 250 - along : 170;
        });
    Texture texture = plain;
    bake::compress_to_blocks(texture);
    ASSERT_EQ(texture.format, TextureFormat::bc7_srgb);
    EXPECT_GT(texture.psnr, 40.0f);
    std::vector<int> wanted = texels_of(plain);
    const std::size_t count = std::size_t{61} * 47 * 4;
    const double mean = mean_square(decode_all(texture), wanted, count) * 4 / 3;  // alpha is exact
    EXPECT_NEAR(texture.psnr, 10.0 * std::log10(255.0 * 255.0 / mean), 0.01);
}

TEST(Blocks, ASingleTexelStaysExact) {
    Texture texture = make_texture(TextureFormat::rgba8_srgb, 1, 1,
                                   [](int, int, std::size_t c) { return static_cast<int>(c); });
    bake::compress_to_blocks(texture);
    EXPECT_EQ(texture.format, TextureFormat::rgba8_srgb);
    EXPECT_EQ(texture.psnr, 0.0f);
}

}  // namespace
