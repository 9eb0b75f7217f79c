// An image in memory, as its file states it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh-format/layout.h"

namespace bake {

enum class SampleType : std::uint8_t {
    u8,   ///< 0..255 stands for 0..1
    u16,  ///< 0..65535 stands for 0..1
    f32,  ///< as it is; may be outside [0, 1] or not finite
};

/// The texels as the file states them: not premultiplied by alpha, in no other colour space than
/// the file's. Rows follow each other from the top, tightly packed, channels interleaved.
struct Image {
    std::uint32_t width = 0;     ///< 1..mesh_format::kMaxTextureSize
    std::uint32_t height = 0;    ///< 1..mesh_format::kMaxTextureSize
    std::uint32_t channels = 0;  ///< 1..4: grey; grey and another; RGB; RGB and another
    bool has_alpha = false;      ///< the last of 2 or 4 channels is alpha
    SampleType type = SampleType::u8;
    std::vector<std::byte> samples;
};

/// An image that cannot be read; what() is the cause, without the image's name.
class ImageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws ImageError unless both are in 1..mesh_format::kMaxTextureSize.
inline void check_extent(std::int64_t width, std::int64_t height) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
    const std::int64_t limit = 32;  // most inputs would state sizes that take seconds
#else
    const std::int64_t limit = mesh_format::kMaxTextureSize;
#endif
    if (width < 1 || height < 1) throw ImageError("has no texels");
    if (width > limit || height > limit) {
        throw ImageError("is " + std::to_string(width) + " x " + std::to_string(height) +
                         " texels, more than " + std::to_string(limit) + " on a side");
    }
}

}  // namespace bake
