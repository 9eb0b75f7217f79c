// Texels to a PNG file in memory. It needs zlib.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace common {

/// A picture of 8 bits a channel.
struct PngPicture {
    /// Channels of a texel, in memory and in the file.
    enum class Channels {
        grey,
        rgb,
        rgba,
        rgb_of_rgba,  ///< four in memory, of which the file leaves out alpha
    };

    std::uint32_t width;
    std::uint32_t height;
    Channels channels;
    bool says_srgb;                     ///< the file tells programs that show it that it is sRGB
    std::span<const std::byte> texels;  ///< rows from the top, tightly packed
    bool on_threads = false;            ///< encoded on threads of its own; the same bytes
};

/// The same picture gives the same bytes.
std::vector<std::byte> encode_png(const PngPicture& picture);

}  // namespace common
