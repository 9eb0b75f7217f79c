// What encoder and decoder of BC7 share: mode 1 of the Khronos Data Format Specification 1.3.
#pragma once

#include <array>
#include <cstdint>

#include "mesh-format/layout.h"

namespace mesh_format {

// A block, from its lowest bit: two bits, 2 for mode 1; six for the partition; red, green and blue
// in turn of the two ends of subset 0 and the two of subset 1, six bits each; a bit for each
// subset that is the lowest of all its numbers; three bits a texel for the step from the first to
// the second end, but two for the first texel and for the last, whose highest is 0.
inline constexpr std::uint32_t kBc7Ends = 8;      ///< bits before the ends
inline constexpr std::uint32_t kBc7LowBits = 80;  ///< bits before the lowest bits
inline constexpr std::uint32_t kBc7Steps = 82;    ///< bits before the steps

/// Bit i says of which subset texel i is. Of these partitions the last texel is of subset 1.
inline constexpr std::array<std::uint16_t, kBc7Partitions> kBc7Subsets{
    0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80,
    0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000};

/// How far each step is, in 64ths.
inline constexpr std::array<std::int32_t, 8> kBc7Weights{0, 9, 18, 27, 37, 46, 55, 64};

/// A number of an end in 8 bits, from its six bits and the lowest.
template <typename Number>
constexpr Number expand_bc7(Number six, Number lowest) {
    const Number seven = six << 1 | lowest;
    return seven << 1 | seven >> 6;
}

}  // namespace mesh_format
