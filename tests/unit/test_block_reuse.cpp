// Blocks that repeat others: never farther off than the bits are worth that they save.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "cw2-bake/textures/block_compression.h"
#include "cw2-bake/textures/block_reuse.h"
#include "cw2-bake/textures/payload_compression.h"
#include "mesh-format/blocks.h"

namespace {

using bake::PlainLevel;
using mesh_format::TextureFormat;
using Bytes = std::vector<std::byte>;

/// What metalness looks like: slow changes and noise.
Bytes noisy_waves(std::uint32_t width, std::uint32_t height, unsigned noise) {
    std::mt19937 random(7);
    Bytes texels;
    for (std::uint32_t i = 0; i < width * height; ++i) {
        const double wave =
            100.0 + 20.0 * std::sin(0.02 * (i % width)) * std::cos(0.03 * i / width);
        texels.push_back(static_cast<std::byte>(static_cast<unsigned>(wave) + random() % noise));
    }
    return texels;
}

/// A level in blocks, one row after the other.
Bytes encoded(const PlainLevel& level) {
    const std::size_t row = std::size_t{8} * ((level.width + 3) / 4);
    Bytes blocks(row * ((level.height + 3) / 4));
    for (std::uint32_t top = 0; top < level.height; top += 4)
        bake::encode_bc4_row(level, top, 0, blocks.data() + row * (top / 4));
    return blocks;
}

/// The squared differences of each block's texels that lie inside the level.
std::vector<int> errors_of(const PlainLevel& level, const Bytes& blocks) {
    const std::uint32_t columns = (level.width + 3) / 4;
    std::vector<int> errors(blocks.size() / 8);
    for (std::uint32_t top = 0; top < level.height; top += 4) {
        const std::uint32_t rows = std::min(level.height - top, 4u);
        Bytes shown(std::size_t{level.width} * rows);
        mesh_format::decode_block_row(TextureFormat::bc4_unorm,
                                      blocks.data() + std::size_t{8} * columns * (top / 4),
                                      level.width, rows, shown.data());
        for (std::uint32_t i = 0; i < shown.size(); ++i) {
            const int off = std::to_integer<int>(shown[i]) -
                            std::to_integer<int>(level.texels[std::size_t{top} * level.width + i]);
            errors[top / 4 * columns + i % level.width / 4] += off * off;
        }
    }
    return errors;
}

TEST(BlockReuse, AddsNoMoreThanTheBitsAreWorthAndSaysHowMuch) {
    for (const unsigned noise : {3u, 8u, 40u}) {
        for (const auto& [width, height] : {std::pair{256u, 128u}, {61u, 47u}, {3u, 90u}}) {
            SCOPED_TRACE(testing::Message() << noise << ", " << width << " x " << height);
            const Bytes texels = noisy_waves(width, height, noise);
            const PlainLevel level{texels.data(), width, height};
            const Bytes before = encoded(level);
            Bytes after = before;
            const double added = bake::reuse_blocks(level, after.data());
            const std::vector<int> errors_before = errors_of(level, before);
            const std::vector<int> errors_after = errors_of(level, after);
            double sum = 0.0;
            for (std::size_t i = 0; i < errors_before.size(); ++i) {
                sum += errors_after[i] - errors_before[i];
                ASSERT_LE(errors_after[i] - errors_before[i],
                          bake::kErrorPerBit * bake::kMostBitsSaved)
                    << i;
                const std::size_t columns = (width + 3) / 4;
                const bool whole = i % columns < width / 4 && i / columns < height / 4;
                ASSERT_TRUE(whole || std::memcmp(&before[8 * i], &after[8 * i], 8) == 0) << i;
            }
            EXPECT_EQ(sum, added);
            EXPECT_TRUE(width != 256 || noise > 8 || before != after);
        }
    }
}

TEST(BlockReuse, ChangedBlocksRepeatEarlierIndices) {
    const Bytes texels = noisy_waves(256, 128, 4);
    const PlainLevel level{texels.data(), 256, 128};
    const Bytes before = encoded(level);
    Bytes after = before;
    bake::reuse_blocks(level, after.data());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); i += 8) {
        if (std::memcmp(&before[i], &after[i], 8) == 0) continue;
        ++changed;
        bool found = false;
        for (std::size_t j = 0; j < i && !found; j += 8)
            found = std::memcmp(&after[i + 2], &after[j + 2], 6) == 0;
        ASSERT_TRUE(found) << i / 8;
    }
    EXPECT_GT(changed, before.size() / 8 / 4);
}

bake::Texture scalars(std::uint32_t size, unsigned noise) {
    bake::Texture texture{
        .format = TextureFormat::r8_unorm, .width = size, .height = size, .payload = {}};
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(size, size); ++i) {
        Bytes level = noisy_waves(size >> i, size >> i, noise);
        level.resize(mesh_format::mip_bytes(texture.format, size, size, i));
        texture.payload.insert(texture.payload.end(), level.begin(), level.end());
    }
    return texture;
}

TEST(BlockReuse, CompressedTexturesAreSmallerAndSayHowFarOffTheyAre) {
    bake::Texture exact = scalars(256, 4);
    const Bytes texels = exact.payload;
    bake::Texture reused = exact;
    bake::compress_to_blocks(exact);
    bake::compress_to_blocks(reused, std::nullopt, true);
    const std::vector<int> errors = errors_of(
        {texels.data(), 256, 256},
        Bytes(reused.payload.begin(), reused.payload.begin() + std::ptrdiff_t{64} * 64 * 8));
    double mean = 0.0;
    for (const int error : errors) mean += error / (256.0 * 256.0);
    EXPECT_NEAR(reused.psnr, 10.0 * std::log10(255.0 * 255.0 / mean), 0.001);
    bake::compress_payload(exact);
    bake::compress_payload(reused);
    EXPECT_LT(reused.payload.size(), 0.6 * exact.payload.size());
}

/// Where the error that is added would be too much, none is.
TEST(BlockReuse, WhatIsNearlyTooFarOffStaysInBlocks) {
    bool met = false;
    for (unsigned noise = 40; noise < 100; ++noise) {
        bake::Texture exact = scalars(64, noise);
        bake::Texture reused = exact;
        bake::compress_to_blocks(exact);
        bake::compress_to_blocks(reused, std::nullopt, true);
        EXPECT_EQ(reused.format, exact.format);
        met |= exact.format == TextureFormat::bc4_unorm && reused.payload == exact.payload;
    }
    EXPECT_TRUE(met);
}

TEST(BlockReuse, MasksAndOtherFormatsAreLeft) {
    bake::Texture mask = scalars(64, 3);
    bake::Texture other = mask;
    bake::compress_to_blocks(mask, 0.4f);
    bake::compress_to_blocks(other, 0.4f, true);
    EXPECT_EQ(mask.payload, other.payload);
}

}  // namespace
