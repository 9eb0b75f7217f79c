#include "cw2-bake/block_compression.h"

#include <stb/stb_dxt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "cw2-bake/mip_chain.h"
#include "mesh-format/blocks.h"

namespace bake {
namespace {

using mesh_format::TextureFormat;

constexpr float kLeastPsnr = 34.0f;
constexpr float kLeastNormalPsnr = 38.0f;

TextureFormat compressed(TextureFormat format) {
    switch (format) {
        case TextureFormat::r8_unorm:
            return TextureFormat::bc4_unorm;
        case TextureFormat::rgba8_unorm:
            return TextureFormat::bc5_unorm;
        default:
            return TextureFormat::bc1_srgb;
    }
}

/// One channel of 4 x 4 texels.
using Values = std::array<std::uint8_t, 16>;

/// As stb_compress_bc4_block, with both ends in use and loops that become vectors: 3 x as fast.
/// A value at or above `limit` gets one that is so, too, and one below it one below.
void compress_bc4(const Values& values, std::uint32_t limit, std::byte* out) {
    int least = 255;
    int most = 0;
    for (const std::uint8_t value : values) {
        least = std::min<int>(least, value);
        most = std::max<int>(most, value);
    }
    std::uint64_t block = static_cast<std::uint64_t>(most | least << 8);
    if (most > least) {
        // Steps down from the largest value, 0 to 7.
        std::array<std::int32_t, 16> steps;
        const float scale = 7.0f / static_cast<float>(most - least);
        for (std::size_t i = 0; i < 16; ++i) {
            steps[i] =
                static_cast<std::int32_t>(static_cast<float>(most - values[i]) * scale + 0.5f);
        }
        const bool crosses = static_cast<int>(limit) > least && static_cast<int>(limit) <= most;
        for (std::size_t i = 0; crosses && i < 16; ++i) {
            const int decoded = ((7 - steps[i]) * most + steps[i] * least + 3) / 7;
            const bool shown = values[i] >= limit;
            if (shown != (decoded >= static_cast<int>(limit))) steps[i] += shown ? -1 : 1;
        }
        // The ends come first, then what lies between them.
        constexpr std::array<std::uint8_t, 8> kIndex{0, 2, 3, 4, 5, 6, 7, 1};
        for (std::size_t i = 0; i < 16; ++i) {
            block |= std::uint64_t{kIndex[static_cast<std::size_t>(steps[i])]} << (16 + 3 * i);
        }
    }
    std::memcpy(out, &block, sizeof block);
}

/// 4 x 4 texels of a level as they are stored uncompressed; beyond its edges those at the edge.
class Tile {
 public:
    Tile(const std::byte* level, std::uint32_t width, std::uint32_t height, std::size_t texel_bytes)
        : level_(level), width_(width), height_(height), texel_bytes_(texel_bytes) {}

    void move_to(std::uint32_t left, std::uint32_t top) {
        for (std::uint32_t y = 0; y < 4; ++y) {
            const std::size_t row = std::size_t{std::min(top + y, height_ - 1)} * width_;
            std::byte* out = texels_.data() + 4 * texel_bytes_ * y;
            if (left + 4 <= width_) {
                std::memcpy(out, level_ + (row + left) * texel_bytes_, 4 * texel_bytes_);
                continue;
            }
            for (std::uint32_t x = 0; x < 4; ++x) {
                const std::size_t at = row + std::min(left + x, width_ - 1);
                std::memcpy(out + x * texel_bytes_, level_ + at * texel_bytes_, texel_bytes_);
            }
        }
    }

    const std::uint8_t* texels() const {
        return reinterpret_cast<const std::uint8_t*>(texels_.data());
    }
    Values channel(std::size_t c) const {
        Values values;
        for (std::size_t i = 0; i < 16; ++i) values[i] = texels()[i * texel_bytes_ + c];
        return values;
    }

 private:
    const std::byte* level_;
    std::uint32_t width_;
    std::uint32_t height_;
    std::size_t texel_bytes_;
    std::array<std::byte, 64> texels_;
};

void compress_level(TextureFormat to, Tile tile, std::uint32_t width, std::uint32_t height,
                    std::uint32_t limit, std::byte* out) {
    for (std::uint32_t y = 0; y < height; y += 4) {
        for (std::uint32_t x = 0; x < width; x += 4, out += mesh_format::block_bytes(to)) {
            tile.move_to(x, y);
            if (to == TextureFormat::bc1_srgb) {
                stb_compress_dxt_block(reinterpret_cast<unsigned char*>(out), tile.texels(), 0,
                                       STB_DXT_NORMAL);
            } else {
                compress_bc4(tile.channel(0), limit, out);
            }
            if (to == TextureFormat::bc5_unorm) compress_bc4(tile.channel(1), limit, out + 8);
        }
    }
}

/// Sum of the squared differences over a row of bytes.
double byte_error(const std::uint8_t* stored, const std::uint8_t* decoded, std::size_t count) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const int difference = stored[i] - decoded[i];
        sum += difference * difference;
    }
    return static_cast<double>(sum);
}

/// The same for normals, of bytes that need not be whole.
double normal_error(const std::uint8_t* stored, const std::uint8_t* decoded, std::size_t count) {
    double sum = 0.0;
    const auto component = [](std::uint8_t byte) {
        return static_cast<float>(byte) * (2.0f / 255.0f) - 1.0f;
    };
    for (std::size_t i = 0; i < count; ++i) {
        const float x = component(decoded[2 * i]);
        const float y = component(decoded[2 * i + 1]);
        const float z = std::sqrt(std::max(1.0f - x * x - y * y, 0.0f));
        const float dx = x - component(stored[4 * i]);
        const float dy = y - component(stored[4 * i + 1]);
        const float dz = z - component(stored[4 * i + 2]);
        sum += dx * dx + dy * dy + dz * dz;
    }
    return sum * (127.5 * 127.5);
}

/// Peak signal-to-noise ratio of level 0, dB.
float psnr_of(const Texture& texture, TextureFormat format, const std::byte* blocks) {
    const std::size_t texel = mesh_format::decoded_texel_bytes(format);
    const std::size_t stored_texel = mesh_format::block_bytes(texture.format);
    const std::size_t block_row = std::size_t{mesh_format::block_count(format, texture.width)} *
                                  mesh_format::block_bytes(format);
    std::vector<std::byte> decoded(4 * texel * texture.width);
    double sum = 0.0;
    for (std::uint32_t y = 0; y < texture.height; y += 4, blocks += block_row) {
        const std::uint32_t rows = std::min(texture.height - y, 4u);
        mesh_format::decode_block_row(format, blocks, texture.width, rows, decoded.data());
        const auto* stored = reinterpret_cast<const std::uint8_t*>(
            texture.payload.data() + std::size_t{y} * texture.width * stored_texel);
        const auto* ours = reinterpret_cast<const std::uint8_t*>(decoded.data());
        const std::size_t texels = std::size_t{rows} * texture.width;
        sum += format == TextureFormat::bc5_unorm ? normal_error(stored, ours, texels)
                                                  : byte_error(stored, ours, texels * texel);
    }
    const int channels = format == TextureFormat::bc4_unorm ? 1 : 3;
    const double mean = sum / (static_cast<double>(texture.width) * texture.height * channels);
    return static_cast<float>(std::clamp(10.0 * std::log10(255.0 * 255.0 / std::max(mean, 1e-9)),
                                         0.0, double{mesh_format::kExactPsnr}));
}

}  // namespace

void compress_to_blocks(Texture& texture, std::optional<float> cutoff) {
    if (texture.width == 1 && texture.height == 1) return;
    const TextureFormat to = compressed(texture.format);
    const std::uint32_t limit = cutoff ? cutoff_byte(*cutoff) : 0;
    std::vector<std::byte> blocks(mesh_format::mip_chain_bytes(to, texture.width, texture.height));
    const std::byte* level = texture.payload.data();
    std::byte* out = blocks.data();
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(texture.width, texture.height); ++i) {
        const std::uint32_t width = mesh_format::mip_extent(texture.width, i);
        const std::uint32_t height = mesh_format::mip_extent(texture.height, i);
        compress_level(to, {level, width, height, mesh_format::block_bytes(texture.format)}, width,
                       height, limit, out);
        level += mesh_format::mip_bytes(texture.format, texture.width, texture.height, i);
        out += mesh_format::mip_bytes(to, texture.width, texture.height, i);
        if (i > 0) continue;
        texture.psnr = psnr_of(texture, to, blocks.data());
        if (texture.psnr < (to == TextureFormat::bc5_unorm ? kLeastNormalPsnr : kLeastPsnr)) return;
    }
    texture.format = to;
    texture.payload = std::move(blocks);
}

}  // namespace bake
