#include "cw2-bake/gltf/images.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/encode_png.h"
#include "cw2-bake/base/text_lines.h"
#include "mesh-format/blocks.h"

namespace bake {
namespace {

using mesh_format::Document;
using mesh_format::kNoTexture;
using mesh_format::MapUse;
using mesh_format::MaterialRecord;
using mesh_format::TextureFormat;
using mesh_format::TextureRecord;

enum class Use : std::uint8_t { color, metallic_roughness, normal, emission };

/// An image of up to two textures, each kNoTexture or one that exists.
struct Key {
    Use use;
    std::uint32_t first;   ///< base colour, roughness, normal, or emission
    std::uint32_t second;  ///< alpha mask, metalness, or none
    auto operator<=>(const Key&) const = default;
};

/// The largest level of a texture, 8 bits a channel.
struct Picture {
    std::uint32_t width = 1;
    std::uint32_t height = 1;
    std::uint32_t channels = 1;
    std::vector<std::byte> texels{std::byte{255}};

    /// The texel that lies where (x, y) of a picture of another size does.
    const std::byte* at(std::uint32_t x, std::uint32_t y, std::uint32_t of_width,
                        std::uint32_t of_height) const {
        const std::uint64_t column = std::uint64_t{x} * width / of_width;
        const std::uint64_t row = std::uint64_t{y} * height / of_height;
        return texels.data() + (row * width + column) * channels;
    }
};

std::uint32_t texel_bytes(TextureFormat format) {
    return mesh_format::block_extent(format) > 1 ? mesh_format::decoded_texel_bytes(format)
                                                 : mesh_format::block_bytes(format);
}

/// White where there is none.
Picture picture_of(const Document& document, TexturePayloads payloads, std::uint32_t index) {
    if (index == kNoTexture) return {};
    const TextureRecord& record = document.textures[index];
    Picture picture{record.width, record.height, texel_bytes(record.format), {}};
    const std::size_t row_bytes = std::size_t{picture.width} * picture.channels;
    picture.texels.resize(row_bytes * picture.height);
    const std::span<const std::byte> payload = payloads[index];
    if (mesh_format::block_extent(record.format) == 1) {
        std::copy_n(payload.begin(), picture.texels.size(), picture.texels.begin());
        return picture;
    }
    const std::size_t block_row_bytes =
        std::size_t{mesh_format::block_count(record.format, record.width)} *
        mesh_format::block_bytes(record.format);
    for (std::uint32_t y = 0; y < record.height; y += 4) {
        mesh_format::decode_block_row(record.format, payload.data() + y / 4 * block_row_bytes,
                                      record.width, std::min(4u, record.height - y),
                                      picture.texels.data() + y * row_bytes);
    }
    return picture;
}

/// z = sqrt(1 - x^2 - y^2) in the encoding 0.5 n + 0.5 of 8 bits.
std::byte rebuilt_z(std::byte x, std::byte y) {
    const auto component = [](std::byte value) {
        return std::to_integer<int>(value) / 127.5 - 1.0;
    };
    const double square = 1.0 - component(x) * component(x) - component(y) * component(y);
    return static_cast<std::byte>(std::lround(127.5 + 127.5 * std::sqrt(std::max(0.0, square))));
}

struct Size {
    std::uint32_t width = 1;
    std::uint32_t height = 1;
    bool is_bounded = false;  ///< would be out of proportion with all texels of both textures
};

Size common_size(const Document& document, const Key& key) {
    const auto size_of = [&](std::uint32_t texture) {
        if (texture == kNoTexture) return Size{};
        return Size{document.textures[texture].width, document.textures[texture].height};
    };
    const auto texels = [](const Size& size) { return std::uint64_t{size.width} * size.height; };
    const Size a = size_of(key.first);
    const Size b = size_of(key.second);
    const Size both{std::max(a.width, b.width), std::max(a.height, b.height)};
    const Size larger = texels(a) >= texels(b) ? a : b;
    constexpr std::uint64_t kMostTimes = 4;
    if (texels(both) <= kMostTimes * texels(larger)) return both;
    return {larger.width, larger.height, true};
}

std::vector<std::byte> encode(const Document& document, TexturePayloads payloads, const Key& key) {
    const Picture first = picture_of(document, payloads, key.first);
    const Picture second = picture_of(document, payloads, key.second);
    const Size size = common_size(document, key);
    const std::uint32_t width = size.width;
    const std::uint32_t height = size.height;
    const bool has_alpha = key.use == Use::color && key.second != kNoTexture;
    const std::uint32_t channels = has_alpha ? 4 : 3;
    std::vector<std::byte> texels(std::size_t{width} * height * channels, std::byte{255});
    std::byte* out = texels.data();
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x, out += channels) {
            const std::byte* a = first.at(x, y, width, height);
            const std::byte* b = second.at(x, y, width, height);
            if (key.use == Use::metallic_roughness) {
                out[1] = a[0];
                out[2] = b[0];
            } else if (first.channels >= 3) {
                std::copy_n(a, 3, out);
            } else if (key.use == Use::normal) {
                std::copy_n(a, 2, out);
                out[2] = rebuilt_z(a[0], a[1]);
            }
            if (has_alpha) out[3] = b[0];
        }
    }
    using common::PngPicture;
    return common::encode_png(
        {.width = width,
         .height = height,
         .channels = has_alpha ? PngPicture::Channels::rgba : PngPicture::Channels::rgb,
         .says_srgb = false,
         .texels = texels});
}

std::string name_of(const Document& document, const Key& key) {
    const auto name = [&](std::uint32_t index) {
        return index == kNoTexture ? std::string()
                                   : std::string(document.text(document.textures[index].name));
    };
    const std::string first = name(key.first);
    std::string second = name(key.second);  // not const: it is moved from
    if (first.empty() || first == second) return second;
    return second.empty() || key.use == Use::color ? first : first + '+' + second;
}

}  // namespace

GltfImages make_gltf_images(const Document& document, TexturePayloads payloads, const Warn& warn) {
    GltfImages result;
    std::map<Key, std::uint32_t> known;
    std::vector<Key> keys;
    const auto add = [&](const Key& key) {
        if (key.first == kNoTexture && key.second == kNoTexture) return kNoImage;
        const auto [entry, fresh] = known.try_emplace(key, static_cast<std::uint32_t>(keys.size()));
        if (fresh) {
            keys.push_back(key);
            if (common_size(document, key).is_bounded) {
                warn(fmt::format("image {}: loses texels of the smaller of its two textures",
                                 in_quotes(name_of(document, key))));
            }
        }
        return entry->second;
    };
    for (const MaterialRecord& material : document.materials) {
        const auto& textures = material.textures;
        const bool masked = material.flags & mesh_format::kAlphaMask;
        const std::uint32_t mask = masked ? textures[MapUse::alpha_mask] : kNoTexture;
        result.materials.push_back({add({Use::color, textures[MapUse::base_color], mask}),
                                    add({Use::metallic_roughness, textures[MapUse::roughness],
                                         textures[MapUse::metalness]}),
                                    add({Use::normal, textures[MapUse::normal], kNoTexture}),
                                    add({Use::emission, textures[MapUse::emission], kNoTexture})});
    }
    result.images.resize(keys.size());
    tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t i) {
        const Key& key = keys[i];
        const auto clamps = [&](std::uint32_t index) {
            return index != kNoTexture &&
                   (document.textures[index].flags & mesh_format::kClampToEdge) != 0;
        };
        result.images[i] = {name_of(document, key), clamps(key.first) || clamps(key.second),
                            encode(document, payloads, key)};
    });
    return result;
}

}  // namespace bake
