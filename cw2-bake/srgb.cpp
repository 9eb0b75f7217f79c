#include "cw2-bake/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace bake {
namespace {

double decode(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// Where an evenly spaced guess starts the search; one step of it is less than one byte's step.
constexpr std::size_t kGuesses = 4096;

struct EncodeTable {
    std::array<float, 256> upper{};  ///< linear light from which on the next byte is nearer
    std::array<std::uint8_t, kGuesses + 1> guess{};

    EncodeTable() {
        for (std::size_t i = 0; i < 255; ++i) {
            upper[i] = static_cast<float>(decode((static_cast<double>(i) + 0.5) / 255.0));
        }
        upper[255] = 2.0f;
        std::size_t byte = 0;
        for (std::size_t i = 0; i <= kGuesses; ++i) {
            while (static_cast<float>(i) / kGuesses >= upper[byte]) {
                ++byte;
            }
            guess[i] = static_cast<std::uint8_t>(byte);
        }
    }
};

}  // namespace

float srgb8_to_linear(std::uint8_t encoded) {
    static const auto table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<float>(decode(static_cast<double>(i) / 255.0));
        }
        return values;
    }();
    return table[encoded];
}

float srgb16_to_linear(std::uint16_t encoded) {
    static const auto table = [] {
        std::vector<float> values(65'536);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<float>(decode(static_cast<double>(i) / 65'535.0));
        }
        return values;
    }();
    return table[encoded];
}

std::uint8_t linear_to_srgb8(float linear) {
    static const EncodeTable table;
    const float value = std::clamp(linear, 0.0f, 1.0f);
    std::uint8_t byte = table.guess[static_cast<std::size_t>(value * kGuesses)];
    while (value >= table.upper[byte]) {
        ++byte;
    }
    return byte;
}

}  // namespace bake
