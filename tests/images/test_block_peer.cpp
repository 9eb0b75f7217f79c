// BC7 blocks as another library reads them.
#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <string>

#include "cw2-bake/textures/block_compression.h"
#include "image_files.h"
#include "mesh-format/bc7.h"
#include "mesh-format/blocks.h"

namespace {

constexpr std::uint32_t kSize = 64;

/// A DDS file of blocks in BC7, with the header of Direct3D 10.
std::string dds_of(std::span<const std::byte> blocks) {
    std::uint32_t words[32 + 5] = {};
    std::memcpy(words, "DDS ", 4);
    words[1] = 124;
    words[2] = 0x81007;  // size, format and bytes are stated
    words[3] = kSize;
    words[4] = kSize;
    words[5] = static_cast<std::uint32_t>(blocks.size());
    words[19] = 32;
    words[20] = 4;
    std::memcpy(words + 21, "DX10", 4);
    words[27] = 0x1000;
    words[32] = 98;  // BC7, not sRGB
    words[33] = 3;
    words[35] = 1;
    std::string file(reinterpret_cast<const char*>(words), sizeof words);
    return file.append(reinterpret_cast<const char*>(blocks.data()), blocks.size());
}

TEST(BlockPeer, Bc7IsWhatOpenImageIoReads) {
    bake::Texture texture{
        .format = mesh_format::TextureFormat::rgba8_srgb, .width = kSize, .height = kSize};
    texture.payload.resize(mesh_format::mip_chain_bytes(texture.format, kSize, kSize));
    for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
        const std::uint32_t x = i % kSize, y = i / kSize;
        const std::uint32_t partition = (x / 4 + 3 * (y / 4)) % mesh_format::kBc7Partitions;
        const bool second = mesh_format::kBc7Subsets[partition] >> (4 * (y % 4) + x % 4) & 1;
        const std::uint32_t along = i * 7919 % 5 + 25 * ((x + y) % 4) + x / 4;
        const std::uint32_t colors[2][4] = {{170, 170, 250 - along, 255}, {60 + along, 40, y, 255}};
        for (std::uint32_t c = 0; c < 4; ++c)
            texture.payload[4 * i + c] = static_cast<std::byte>(colors[second][c]);
    }
    bake::compress_to_blocks(texture);
    ASSERT_EQ(texture.format, mesh_format::TextureFormat::bc7_srgb);
    const auto blocks = std::span<const std::byte>(texture.payload).first(kSize * kSize);

    const TemporaryFolder folder;
    write_bytes(folder / "a.dds", dds_of(blocks));
    const auto input = OIIO::ImageInput::open((folder / "a.dds").string());
    ASSERT_TRUE(input) << OIIO::geterror();
    std::vector<std::uint8_t> theirs(std::size_t{4} * kSize * kSize);
    ASSERT_EQ(input->spec().nchannels, 4);
    ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, theirs.data()));
    for (std::uint32_t y = 0; y < kSize; y += 4) {
        std::vector<std::byte> ours(std::size_t{16} * kSize);
        mesh_format::decode_block_row(texture.format, blocks.data() + y * kSize, kSize, 4,
                                      ours.data());
        for (std::size_t i = 0; i < ours.size(); ++i) {
            ASSERT_EQ(std::to_integer<int>(ours[i]), theirs[std::size_t{4} * y * kSize + i])
                << i / 4 % kSize << ' ' << y + i / 4 / kSize << ' ' << i % 4;
        }
    }
}

}  // namespace
