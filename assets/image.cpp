#include "assets/image.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "assets/noise.h"
#include "common/encode_png.h"
#include "common/io.h"

namespace assets {
namespace {

/// 8-bit texels, top row first.
struct Image {
    int size;
    int channels;
    std::vector<std::uint8_t> bytes;

    Image(int size_, int channels_)
        : size(size_),
          channels(channels_),
          bytes(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_ * channels_)) {}
    /// The texel in column x of row y, counted from the bottom.
    std::uint8_t* at(int x, int y) {
        return &bytes[(static_cast<std::size_t>(size - 1 - y) * static_cast<std::size_t>(size) +
                       static_cast<std::size_t>(x)) *
                      static_cast<std::size_t>(channels)];
    }
};

std::uint8_t to_byte(float value) {
    return static_cast<std::uint8_t>(saturate(value) * 255.0f + 0.5f);
}

/// IEC 61966-2-1.
float srgb_from_linear(float value) {
    return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f;
}

void write_png(const std::filesystem::path& path, const Image& image) {
    using common::PngPicture;
    const auto size = static_cast<std::uint32_t>(image.size);
    common::OutputFile file(path);
    file.write(common::encode_png(
        {.width = size,
         .height = size,
         .channels = image.channels == 1 ? PngPicture::Channels::grey : PngPicture::Channels::rgb,
         .says_srgb = false,
         .texels = std::as_bytes(std::span(image.bytes))}));
    file.commit();
}

}  // namespace

void write_texture_set(const std::filesystem::path& directory, const TextureSet& set) {
    const int size = set.size;
    Image color(size, 3);
    Image roughness(size, 1);
    Image metalness(size, 1);
    Image normal(size, 3);
    Image mask(size, 1);
    std::vector<float> heights(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    const auto height = [&](int x, int y) -> float& {
        return heights[static_cast<std::size_t>(wrap(y, size)) * static_cast<std::size_t>(size) +
                       static_cast<std::size_t>(wrap(x, size))];
    };
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const Texel texel = set.texel((glm::vec2(x, y) + 0.5f) / static_cast<float>(size));
            for (int i = 0; i < 3; ++i) {
                color.at(x, y)[i] = to_byte(srgb_from_linear(saturate(texel.color[i])));
            }
            *roughness.at(x, y) = to_byte(texel.roughness);
            *metalness.at(x, y) = to_byte(texel.metalness);
            *mask.at(x, y) = to_byte(texel.alpha);
            height(x, y) = texel.height;
        }
    }
    const glm::vec2 two_texels = 2.0f * set.extent / static_cast<float>(size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const glm::vec2 slope = glm::vec2(height(x + 1, y) - height(x - 1, y),
                                              height(x, y + 1) - height(x, y - 1)) /
                                    two_texels;
            const glm::vec3 n = glm::normalize(glm::vec3(-slope, 1.0f));
            for (int i = 0; i < 3; ++i) normal.at(x, y)[i] = to_byte(0.5f * n[i] + 0.5f);
        }
    }
    const auto write = [&](bool wanted, const char* suffix, Image& image) {
        if (wanted) write_png(directory / (set.name + suffix), image);
    };
    write(set.color, "_color.png", color);
    write(set.roughness, "_roughness.png", roughness);
    write(set.metalness, "_metalness.png", metalness);
    write(set.normal, "_normal.png", normal);
    write(set.mask, "_mask.png", mask);
}

}  // namespace assets
