// Numbers of both signs as numbers without one, small where those are near 0.
#pragma once

namespace mesh_format {

/// 0, -1, 1, -2 to 0, 1, 2, 3; a word below 0 has its highest bit set.
template <typename Word>
constexpr Word zigzag(Word value) {
    const bool negative = value >> (8 * sizeof value - 1) != 0;
    return static_cast<Word>(value << 1 ^ (negative ? ~0u : 0u));
}
template <typename Word>
constexpr Word unzigzag(Word value) {
    return static_cast<Word>(value >> 1 ^ (value & 1 ? ~0u : 0u));
}

}  // namespace mesh_format
