#include "cw2-bake/textures/block_compression.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "cw2-bake/textures/block_encoders.h"
#include "cw2-bake/textures/block_reuse.h"
#include "cw2-bake/textures/mip_chain.h"

namespace bake {
namespace {

using mesh_format::TextureFormat;

/// dB; what is less is too far off. What is stored instead is hardly larger: colours that BC1
/// misses become BC7, and of plain normals and masks Zstandard makes little more than of blocks.
float least_psnr(TextureFormat blocks, bool is_mask) {
    if (is_mask || blocks == TextureFormat::bc5_unorm) return 43.0f;
    return blocks == TextureFormat::bc1_srgb ? 37.0f : 34.0f;
}

/// What a texture of `format` may become, the smallest first.
std::span<const TextureFormat> block_formats(TextureFormat format) {
    static constexpr TextureFormat kScalars[] = {TextureFormat::bc4_unorm};
    static constexpr TextureFormat kNormals[] = {TextureFormat::bc5_unorm};
    static constexpr TextureFormat kColors[] = {TextureFormat::bc1_srgb, TextureFormat::bc7_srgb};
    switch (format) {
        case TextureFormat::r8_unorm:
            return kScalars;
        case TextureFormat::rg8_unorm:
            return kNormals;
        default:
            return kColors;
    }
}

/// The sum of the squared errors; see block_encoders.h.
double compress_level(TextureFormat to, const PlainLevel& level, std::uint32_t limit,
                      std::byte* out) {
    const std::size_t row_bytes =
        std::size_t{mesh_format::block_count(to, level.width)} * mesh_format::block_bytes(to);
    double error = 0.0;
    for (std::uint32_t top = 0; top < level.height; top += 4, out += row_bytes) {
        error += to == TextureFormat::bc1_srgb    ? encode_bc1_row(level, top, out)
                 : to == TextureFormat::bc7_srgb  ? encode_bc7_row(level, top, out)
                 : to == TextureFormat::bc4_unorm ? encode_bc4_row(level, top, limit, out)
                                                  : encode_bc5_row(level, top, out);
    }
    return error;
}

/// dB, of `error` over all texels.
float psnr_of(const PlainLevel& level, TextureFormat format, double error) {
    const int channels = format == TextureFormat::bc4_unorm ? 1 : 3;
    const double mean = error / (static_cast<double>(level.width) * level.height * channels);
    return static_cast<float>(std::clamp(10.0 * std::log10(255.0 * 255.0 / std::max(mean, 1e-9)),
                                         0.0, double{mesh_format::kExactPsnr}));
}

/// How a texture becomes blocks.
struct Way {
    TextureFormat format;
    std::uint32_t limit;  ///< of a mask; else 0
    bool reuse;           ///< by reuse_blocks()
};

/// Whether the texture is in blocks now; they may be too far off.
bool compress(Texture& texture, const Way& way) {
    const TextureFormat to = way.format;
    std::vector<std::byte> blocks(mesh_format::mip_chain_bytes(to, texture.width, texture.height));
    const std::byte* level = texture.payload.data();
    std::byte* out = blocks.data();
    for (std::uint32_t i = 0; i < mesh_format::full_mip_count(texture.width, texture.height); ++i) {
        const PlainLevel plain{level, mesh_format::mip_extent(texture.width, i),
                               mesh_format::mip_extent(texture.height, i)};
        double error = compress_level(to, plain, way.limit, out);
        if (way.reuse) error += reuse_blocks(plain, out);
        level += mesh_format::mip_bytes(texture.format, texture.width, texture.height, i);
        out += mesh_format::mip_bytes(to, texture.width, texture.height, i);
        if (i > 0) continue;
        texture.psnr = psnr_of(plain, to, error);
        if (texture.psnr < least_psnr(to, way.limit > 0)) return false;
    }
    texture.format = to;
    texture.payload = std::move(blocks);
    return true;
}

}  // namespace

bool fits_blocks(const PlainLevel& mask, float cutoff) {
    constexpr TextureFormat kFormat = TextureFormat::bc4_unorm;
    std::vector<std::byte> blocks(mesh_format::mip_bytes(kFormat, mask.width, mask.height, 0));
    const double error = compress_level(kFormat, mask, cutoff_byte(cutoff), blocks.data());
    return psnr_of(mask, kFormat, error) >= least_psnr(kFormat, true);
}

void compress_to_blocks(Texture& texture, std::optional<float> cutoff, bool for_zstd) {
    if (texture.width == 1 && texture.height == 1) return;
    const std::uint32_t limit = cutoff ? cutoff_byte(*cutoff) : 0;
    for (const TextureFormat to : block_formats(texture.format)) {
        const bool reuse = for_zstd && to == TextureFormat::bc4_unorm && limit == 0;
        if (reuse && compress(texture, {to, limit, true})) return;
        if (compress(texture, {to, limit, false})) return;
    }
}

}  // namespace bake
