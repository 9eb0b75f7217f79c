// The sRGB transfer function of IEC 61966-2-1.
#pragma once

#include <cstdint>

namespace bake {

/// Linear light in [0, 1]; 255 encodes 1.
float srgb8_to_linear(std::uint8_t encoded);

/// Linear light in [0, 1]; 65535 encodes 1.
float srgb16_to_linear(std::uint16_t encoded);

/// The encoded byte nearest to linear light `linear`, which is clamped to [0, 1].
std::uint8_t linear_to_srgb8(float linear);

}  // namespace bake
