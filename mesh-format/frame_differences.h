// By how much a code of quat32 differs from an expected one, digit by digit, see FrameModel in
// layout.h.
#pragma once

#include <array>
#include <cstdint>

namespace mesh_format {

/// Digits of base 811, -405 to 405, lowest first, as numbers modulo 2^16; the top one, what is left
/// of the code, is of a few bits.
struct CodeDigits {
    std::array<std::uint16_t, 3> digits;
    std::uint8_t top;
};
inline constexpr std::int32_t kCodeBase = 811;

/// Of a difference modulo 2^32.
inline CodeDigits digits_of(std::uint32_t difference) {
    CodeDigits result{};
    auto rest = static_cast<std::int32_t>(difference);
    for (std::uint16_t& digit : result.digits) {
        int value = rest % kCodeBase;
        if (value > kCodeBase / 2) value -= kCodeBase;
        if (value < -(kCodeBase / 2)) value += kCodeBase;
        digit = static_cast<std::uint16_t>(value);
        rest = (rest - value) / kCodeBase;
    }
    result.top = static_cast<std::uint8_t>(rest);
    return result;
}

/// Of any digits.
inline std::uint32_t code_difference(const CodeDigits& of) {
    auto code = static_cast<std::uint32_t>(static_cast<std::int8_t>(of.top));
    for (std::size_t k = 3; k-- > 0;)
        code =
            code * kCodeBase + static_cast<std::uint32_t>(static_cast<std::int16_t>(of.digits[k]));
    return code;
}

}  // namespace mesh_format
