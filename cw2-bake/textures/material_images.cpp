#include "cw2-bake/textures/material_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <new>
#include <span>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/textures/block_compression.h"
#include "cw2-bake/textures/mip_chain.h"
#include "cw2-bake/textures/payload_compression.h"
#include "cw2-bake/textures/read_image.h"
#include "cw2-bake/textures/relief.h"
#include "cw2-bake/textures/roughness_mips.h"
#include "cw2-bake/textures/texels.h"

namespace bake {
namespace {

using mesh_format::TextureFormat;

void warn(const TextureMap& map, const std::string& cause, ImageResult& result) {
    result.warnings.push_back({map.stated_in, map.file.string() + ": " + cause});
}

/// Null, and a warning, where there is no such map or image.
const Image* load(const std::optional<TextureMap>& map, ImageCache& images, ImageResult& result) {
    if (!map) {
        return nullptr;
    }
    try {
        return &images.get(*map);
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
    texture.flags = 0;
    texture.payload.resize(mesh_format::mip_chain_bytes(texture.format, 1, 1));
    std::fill(texture.payload.begin() + static_cast<std::ptrdiff_t>(step), texture.payload.end(),
              std::byte{0});
    texture.payload.shrink_to_fit();
}

Texture finish(const TextureMap& map, TextureFormat format, const TexelSource& source,
               std::vector<std::byte> payload) {
    Texture texture{.name = map.file.filename().string(),
                    .format = format,
                    .flags = map.clamp ? mesh_format::kClampToEdge : 0u,
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

/// The share of the texels that are at or above `limit`.
double share_shown(const TexelSource& mask, float limit) {
    std::vector<float> row(mask.width);
    std::uint64_t shown = 0;
    for (std::uint32_t y = 0; y < mask.height; ++y) {
        mask.read_row(y, row);
        shown += static_cast<std::uint64_t>(
            std::ranges::count_if(row, [limit](float value) { return value >= limit; }));
    }
    return static_cast<double>(shown) / (static_cast<double>(mask.width) * mask.height);
}

std::optional<Mask> find_mask(const ImageRequest& request, const Image* color, const Image* alpha,
                              ImageResult& result) {
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
    } else if (color && color->has_alpha && request.color_alpha_is_mask) {
        mask = mask_of(*color, Channel::alpha, *request.map);
    }
    const float limit = shown_from(request.alpha_cutoff);
    const bool hides = mask && mask->range.smallest < limit;
    if (!hides) {
        if (mask && request.color_is_blended && mask->range.smallest < 1.0f)
            warn(*mask->map, "its alpha is nowhere below 0.5: drawn opaque, not blended", result);
        return std::nullopt;
    }
    // Alpha of a colour that leaves nothing is gloss, or height, or a mistake.
    constexpr double kLeastShare = 0.005;
    if (!alpha && share_shown(mask->texels, limit) < kLeastShare) {
        warn(*mask->map,
             fmt::format("its alpha is below {:.3g} (nearly) everywhere; it is ignored, and hides "
                         "nothing",
                         request.alpha_cutoff),
             result);
        return std::nullopt;
    }
    if (mask->range.largest < limit) warn(*mask->map, "is a mask that hides everything", result);
    return mask;
}

void make_surface(const ImageRequest& request, TextureMode mode, ImageCache& images,
                  ImageResult& result) {
    const Image* color = load(request.map, images, result);
    const Image* alpha = load(request.alpha_map, images, result);
    const std::optional<Mask> mask = find_mask(request, color, alpha, result);
    if (mask) {
        const MaskUse use{.cutoff = request.alpha_cutoff,
                          .clamp = mask->map->clamp,
                          .blocks = mode == TextureMode::bc};
        result.alpha_mask = finish(*mask->map, TextureFormat::r8_unorm, mask->texels,
                                   filter_mask(mask->texels, use));
        Texture& texture = *result.alpha_mask;
        if (texture.flags != 0 &&
            hides_its_edges(texture.payload, texture.width, texture.height, use.cutoff))
            texture.flags |= mesh_format::kHiddenBeyond;
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
           near_zero(texture.payload[1]);
}

/// The normals of a normal map or a bump map, if it can be used.
std::optional<TexelSource> find_normals(const std::optional<TextureMap>& map, bool bump,
                                        float bump_scale, ImageCache& images, ImageResult& result) {
    const Image* image = load(map, images, result);
    if (!image) {
        return std::nullopt;
    }
    const bool stated = bump && map->channel != Channel::standard;
    const Relief relief = stated ? Relief::heights
                          : bump ? relief_of_bump(*image)
                                 : relief_of_normals(*image);
    if (!bump && relief == Relief::heights) {
        warn(*map, "is grey, so it is no normal map", result);
        return std::nullopt;
    }
    if (relief == Relief::normals_xy)
        warn(*map, "is a normal map of two channels: blue says nothing; z is made from x and y",
             result);
    if (relief == Relief::vectors)
        warn(*map, "holds vectors of other lengths than 1: they are normalised", result);
    if (relief == Relief::normals || relief == Relief::normals_xy || relief == Relief::vectors)
        return normal_texels(*image, relief == Relief::normals_xy);
    if (relief == Relief::colors)
        warn(*map, "is coloured, and no normal map: its luminance is taken as height", result);
    const bool grey = stated || is_grey(*image);
    return normal_texels_of_heights(*image, grey ? map->channel : Channel::luminance, bump_scale,
                                    map->clamp);
}

MapSettings settings_of(const std::optional<TextureMap>& map) {
    return map ? MapSettings(true, map->channel, map->clamp)
               : MapSettings(false, Channel::standard, false);
}

ImageCache::NormalsKey normals_key(const std::optional<TextureMap>& map, bool bump, float scale) {
    return {map->file, settings_of(map), bump, bump ? scale : 0.0f};
}

void make_normals(const ImageRequest& request, ImageCache& images, ImageResult& result) {
    const bool bump = request.kind == ImageRequest::Kind::bump;
    const auto texels = find_normals(request.map, bump, request.bump_scale, images, result);
    if (!texels) {
        return;
    }
    constexpr TextureFormat kFormat = TextureFormat::rg8_unorm;
    MeanLengths lengths{texels->width, texels->height, {}};
    Texture texture = finish(*request.map, kFormat, *texels,
                             filter_chain(kFormat, *texels, measuring(encode_normal8, lengths)));
    images.lengths.emplace(normals_key(request.map, bump, request.bump_scale), std::move(lengths));
    if (!is_flat(texture)) {
        result.texture = std::move(texture);
    }
}

/// `source` with each of its texels repeated to cover a larger image.
TexelSource enlarged(const TexelSource& source, std::uint32_t width, std::uint32_t height) {
    if (source.width == width && source.height == height) return source;
    return {width, height, 1,
            [=, row = std::vector<float>(source.width)](std::uint32_t y,
                                                        std::span<float> texels) mutable {
                source.read_row(
                    static_cast<std::uint32_t>(std::uint64_t{y} * source.height / height), row);
                for (std::size_t x = 0; x < width; ++x) texels[x] = row[x * row.size() / width];
            }};
}

/// The normals as a material with this scale shades with them.
TexelSource scaled_normals(const TexelSource& source, float scale) {
    if (scale == 1.0f) return source;
    return {source.width, source.height, 3,
            [source, scale](std::uint32_t y, std::span<float> texels) {
                source.read_row(y, texels);
                for (std::size_t i = 0; i < texels.size(); i += 3) {
                    const glm::vec3 n(scale * texels[i], scale * texels[i + 1], texels[i + 2]);
                    const float length = glm::length(n);
                    if (!(length > 0.0f)) continue;
                    for (int axis = 0; axis < 3; ++axis) texels[i + axis] = n[axis] / length;
                }
            }};
}

void make_roughness(const ImageRequest& request, ImageCache& images, ImageResult& result) {
    const auto normals =
        find_normals(request.relief, request.relief_is_bump, request.bump_scale, images, result);
    const Image* image = load(request.map, images, result);
    const TexelSource constant{1, 1, 1,
                               [](std::uint32_t, std::span<float> texels) { texels[0] = 1.0f; }};
    if (normals && (image || !request.map)) {
        const TexelSource own = image ? scalar_texels(*image, request.map->channel) : constant;
        const TexelSource alphas = enlarged(own, std::max(own.width, normals->width),
                                            std::max(own.height, normals->height));
        const auto known = images.lengths.find(
            normals_key(request.relief, request.relief_is_bump, request.bump_scale));
        MeanLengths lengths = known != images.lengths.end() && request.normal_scale == 1.0f
                                  ? known->second
                                  : mean_lengths(scaled_normals(*normals, request.normal_scale));
        RoughnessChain chain = filter_roughness(alphas, request.factor, lengths);
        if (chain.widened) {
            const TextureMap& map = image ? *request.map : *request.relief;
            result.texture = Texture{.name = map.file.filename().string(),
                                     .format = TextureFormat::r8_unorm,
                                     .flags = map.clamp ? mesh_format::kClampToEdge : 0u,
                                     .width = alphas.width,
                                     .height = alphas.height,
                                     .payload = std::move(chain.payload)};
            result.holds_factor = true;
            return;
        }
    }
    make_scalar(request, images, result);
}

}  // namespace

RequestSettings settings_of(const ImageRequest& request) {
    return {request.kind,
            settings_of(request.map),
            settings_of(request.alpha_map),
            settings_of(request.relief),
            request.alpha_cutoff,
            request.color_alpha_is_mask,
            request.color_is_blended,
            request.bump_scale,
            request.relief_is_bump,
            request.normal_scale,
            request.factor};
}

const TextureMap& first_map(const ImageRequest& request) {
    // That of the relief, so that a batch decodes it once.
    return *(request.relief ? request.relief : request.map ? request.map : request.alpha_map);
}

std::string texture_name(const ImageRequest& request) {
    return (request.map ? request.map : request.relief)->file.filename().string();
}

std::string mask_name(const ImageRequest& request) {
    return (request.alpha_map ? request.alpha_map : request.map)->file.filename().string();
}

const Image& ImageCache::get(const TextureMap& map) {
    const auto known = images_.find(map.file);
    if (known != images_.end()) return known->second;
    Image image = map.embedded ? read_image(*map.embedded) : read_image(map.file);
    return images_.emplace(map.file, std::move(image)).first->second;
}

ImageResult make_textures(const ImageRequest& request, TextureForm form, ImageCache& images) try {
    ImageResult result;
    switch (request.kind) {
        case ImageRequest::Kind::surface:
            make_surface(request, form.mode, images, result);
            break;
        case ImageRequest::Kind::scalar:
            make_scalar(request, images, result);
            break;
        case ImageRequest::Kind::roughness:
            make_roughness(request, images, result);
            break;
        case ImageRequest::Kind::normal:
        case ImageRequest::Kind::bump:
            make_normals(request, images, result);
            break;
    }
    if (form.mode == TextureMode::bc) {
        if (result.texture) compress_to_blocks(*result.texture, std::nullopt, form.compressed);
        if (result.alpha_mask) compress_to_blocks(*result.alpha_mask, request.alpha_cutoff);
    }
    if (form.compressed) {
        if (result.texture) compress_payload(*result.texture);
        if (result.alpha_mask) compress_payload(*result.alpha_mask);
    }
    return result;
} catch (const std::bad_alloc&) {
    const TextureMap& map = first_map(request);
    throw BakeError(map.stated_in + ": " + map.file.string() +
                    ": there is not enough memory to make its texture");
}

}  // namespace bake
