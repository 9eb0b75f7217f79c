// The sRGB transfer function of IEC 61966-2-1.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bake {

/// Tables that are exact for every value that is asked; see srgb().
class SrgbTables {
 public:
    SrgbTables();

    /// Linear light in [0, 1]; 255 encodes 1.
    float to_linear(std::uint8_t encoded) const { return linear8_[encoded]; }
    /// Linear light in [0, 1]; 65535 encodes 1.
    float to_linear(std::uint16_t encoded) const { return linear16_[encoded]; }

    /// The encoded byte nearest to linear light `linear`, which is clamped to [0, 1].
    std::uint8_t to_srgb8(float linear) const {
        const float value = std::clamp(linear, 0.0f, 1.0f);
        const std::uint32_t byte = guess_[static_cast<std::size_t>(value * kGuesses)];
        return static_cast<std::uint8_t>(byte + (value >= upper_[byte] ? 1 : 0));
    }

 private:
    /// A guess is for an interval of linear light shorter than that of any byte, so it is the byte
    /// or the one before it.
    static constexpr std::size_t kGuesses = 4096;

    std::array<float, 256> linear8_{};
    std::array<float, 256> upper_{};  ///< linear light from which on the next byte is nearer
    std::array<std::uint8_t, kGuesses + 1> guess_{};
    std::vector<float> linear16_;
};

/// The one instance, made when first asked for.
const SrgbTables& srgb();

}  // namespace bake
