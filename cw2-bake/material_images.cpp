#include "cw2-bake/material_images.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "cw2-bake/block_compression.h"
#include "cw2-bake/mip_chain.h"
#include "cw2-bake/texels.h"

namespace bake {
namespace {

using mesh_format::TextureFormat;

void warn(const TextureMap& map, const std::string& cause, ImageResult& result) {
    result.warnings.push_back({map.file, map.stated_in + ": " + map.file.string() + ": " + cause});
}

/// Null, and a warning, where there is no such map or image.
const Image* load(const std::optional<TextureMap>& map, ImageCache& images, ImageResult& result) {
    if (!map) {
        return nullptr;
    }
    try {
        return &images.get(map->file);
    } catch (const ImageError& error) {
        warn(*map, error.what(), result);
        return nullptr;
    }
}

/// Shrinks a texture all of whose texels are equal to one of them.
void collapse_constant(Texture& texture) {
    const std::size_t step = mesh_format::block_bytes(texture.format);
    const std::size_t bytes = std::size_t{texture.width} * texture.height * step;
    const std::byte* level = texture.payload.data();
    if (std::memcmp(level, level + step, bytes - step) != 0) {
        return;
    }
    texture.width = 1;
    texture.height = 1;
    texture.clamp = false;
    texture.payload.resize(mesh_format::mip_chain_bytes(texture.format, 1, 1));
    std::fill(texture.payload.begin() + static_cast<std::ptrdiff_t>(step), texture.payload.end(),
              std::byte{0});
    texture.payload.shrink_to_fit();
}

Texture finish(const TextureMap& map, TextureFormat format, const TexelSource& source,
               std::vector<std::byte> payload) {
    Texture texture{.name = map.file.filename().string(),
                    .format = format,
                    .clamp = map.clamp,
                    .width = source.width,
                    .height = source.height,
                    .payload = std::move(payload)};
    collapse_constant(texture);
    return texture;
}

/// A mask as a material states it, and where.
struct Mask {
    TexelSource texels;
    const TextureMap* map;
    Range range;
};

std::optional<Mask> find_mask(const ImageRequest& request, const Image* color, const Image* alpha) {
    const auto mask_of = [](const Image& image, Channel channel, const TextureMap& map) {
        const TexelSource texels = scalar_texels(image, channel);
        return Mask{texels, &map, range_of(texels)};
    };
    std::optional<Mask> mask;
    if (alpha) {
        Channel channel = request.alpha_map->channel;
        const bool choose = channel == Channel::standard;
        mask = mask_of(*alpha, choose ? Channel::alpha : channel, *request.alpha_map);
        if (choose && mask->range.smallest >= 1.0f) {
            mask = mask_of(*alpha, Channel::r, *request.alpha_map);
        }
    } else if (color && color->has_alpha) {
        mask = mask_of(*color, Channel::alpha, *request.map);
    }
    const bool hides = mask && mask->range.smallest < shown_from(request.alpha_cutoff);
    return hides ? mask : std::nullopt;
}

void make_surface(const ImageRequest& request, ImageCache& images, ImageResult& result) {
    const Image* color = load(request.map, images, result);
    const Image* alpha = load(request.alpha_map, images, result);
    const std::optional<Mask> mask = find_mask(request, color, alpha);
    if (mask) {
        result.alpha_mask = finish(*mask->map, TextureFormat::r8_unorm, mask->texels,
                                   filter_mask(mask->texels, request.alpha_cutoff));
    }
    if (!color) {
        return;
    }
    constexpr TextureFormat kFormat = TextureFormat::rgba8_srgb;
    if (mask && mask->range.largest >= shown_from(request.alpha_cutoff)) {
        const TexelSource texels = masked_color_texels(*color, mask->texels, request.alpha_cutoff);
        result.texture =
            finish(*request.map, kFormat, texels, filter_masked_color(texels, request.map->clamp));
    } else {
        const TexelSource texels = color_texels(*color);
        result.texture =
            finish(*request.map, kFormat, texels, filter_chain(kFormat, texels, encode_srgb8));
    }
}

void make_scalar(const ImageRequest& request, ImageCache& images, ImageResult& result) {
    if (const Image* image = load(request.map, images, result)) {
        constexpr TextureFormat kFormat = TextureFormat::r8_unorm;
        const TexelSource texels = scalar_texels(*image, request.map->channel);
        result.texture =
            finish(*request.map, kFormat, texels, filter_chain(kFormat, texels, encode_unorm8));
    }
}

/// Whether the texture is one texel that points straight up, within what 8 bits can say.
bool is_flat(const Texture& texture) {
    const auto near_zero = [](std::byte value) {
        return value == std::byte{127} || value == std::byte{128};
    };
    return texture.width == 1 && texture.height == 1 && near_zero(texture.payload[0]) &&
           near_zero(texture.payload[1]) && texture.payload[2] == std::byte{255};
}

void make_normals(const ImageRequest& request, ImageCache& images, ImageResult& result) {
    const Image* image = load(request.map, images, result);
    if (!image) {
        return;
    }
    const TextureMap& map = *request.map;
    const bool grey = is_grey(*image);
    const bool bump = request.kind == ImageRequest::Kind::bump;
    if (!bump && grey) {
        warn(map, "is grey, so it is no normal map", result);
        return;
    }
    const bool heights = bump && (grey || map.channel != Channel::standard);
    constexpr TextureFormat kFormat = TextureFormat::rgba8_unorm;
    const TexelSource texels =
        heights ? normal_texels_of_heights(*image, map.channel, request.bump_scale, map.clamp)
                : normal_texels(*image);
    Texture texture = finish(map, kFormat, texels, filter_chain(kFormat, texels, encode_normal8));
    if (!is_flat(texture)) {
        result.texture = std::move(texture);
    }
}

}  // namespace

const std::filesystem::path& first_file(const ImageRequest& request) {
    return request.map ? request.map->file : request.alpha_map->file;
}

const Image& ImageCache::get(const std::filesystem::path& file) {
    const auto known = images_.find(file);
    return known != images_.end() ? known->second
                                  : images_.emplace(file, read_image(file)).first->second;
}

ImageResult make_textures(const ImageRequest& request, TextureMode mode, ImageCache& images) {
    ImageResult result;
    switch (request.kind) {
        case ImageRequest::Kind::surface:
            make_surface(request, images, result);
            break;
        case ImageRequest::Kind::scalar:
            make_scalar(request, images, result);
            break;
        case ImageRequest::Kind::normal:
        case ImageRequest::Kind::bump:
            make_normals(request, images, result);
            break;
    }
    if (mode == TextureMode::bc) {
        if (result.texture) compress_to_blocks(*result.texture);
        if (result.alpha_mask) compress_to_blocks(*result.alpha_mask, request.alpha_cutoff);
    }
    return result;
}

}  // namespace bake
