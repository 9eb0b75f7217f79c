// PNG files: another decoder finds in them what was put in.
#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/encode_png.h"

namespace {

using common::encode_png;
using common::PngPicture;
using Channels = PngPicture::Channels;

constexpr std::uint32_t kWidth = 7, kHeight = 5;

std::vector<std::byte> noise(std::size_t channels, std::uint32_t width = kWidth,
                             std::uint32_t height = kHeight) {
    std::vector<std::byte> texels;
    std::uint32_t state = 1;
    for (std::size_t i = 0; i < std::size_t{width} * height * channels; ++i) {
        state = state * 1664525 + 1013904223;
        texels.push_back(static_cast<std::byte>(state >> 24));
    }
    return texels;
}

struct Form {
    Channels channels;
    std::size_t in_memory, in_file;
};

class EncodePng : public testing::TestWithParam<Form> {};

TEST_P(EncodePng, KeepsEveryTexelAndOnlyTheChannelsNamed) {
    const auto [channels, in_memory, in_file] = GetParam();
    // One strip, a few, as many as there are rows, and as many as there can be.
    for (const auto& [width, height] :
         {std::pair{7u, 5u}, {211u, 499u}, {70'000u, 3u}, {1500u, 1201u}}) {
        const std::vector<std::byte> texels = noise(in_memory, width, height);
        const std::vector<std::byte> file = encode_png({width, height, channels, false, texels});
        int stored_width = 0, stored_height = 0, stored = 0;
        const std::unique_ptr<unsigned char, void (*)(void*)> decoded(
            stbi_load_from_memory(reinterpret_cast<const unsigned char*>(file.data()),
                                  static_cast<int>(file.size()), &stored_width, &stored_height,
                                  &stored, 0),
            stbi_image_free);
        ASSERT_NE(decoded, nullptr);
        ASSERT_EQ(stored_width, static_cast<int>(width));
        ASSERT_EQ(stored_height, static_cast<int>(height));
        ASSERT_EQ(stored, static_cast<int>(in_file));
        std::size_t wrong = 0;
        for (std::size_t texel = 0; texel < std::size_t{width} * height; ++texel) {
            for (std::size_t channel = 0; channel < in_file; ++channel) {
                wrong += std::to_integer<int>(texels[texel * in_memory + channel]) !=
                         decoded.get()[texel * in_file + channel];
            }
        }
        EXPECT_EQ(wrong, 0u) << width;
    }
}

INSTANTIATE_TEST_SUITE_P(Channels, EncodePng,
                         testing::Values(Form{Channels::grey, 1, 1}, Form{Channels::rgb, 3, 3},
                                         Form{Channels::rgba, 4, 4},
                                         Form{Channels::rgb_of_rgba, 4, 3}));

TEST(EncodePng, SaysThatItIsSrgbWhereItIsTold) {
    const std::vector<std::byte> texels = noise(3);
    for (const bool says_srgb : {false, true}) {
        const auto file = encode_png({kWidth, kHeight, Channels::rgb, says_srgb, texels});
        const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
        EXPECT_EQ(text.find("sRGB") != std::string::npos, says_srgb);
    }
}

}  // namespace
