// Vertices of the commonest forms as rows of eight numbers of 16 bits, which registers of all
// processors hold as one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace mesh_format {

using Row = std::uint16_t __attribute__((vector_size(16)));

inline constexpr std::size_t kRowNumbers = 8;

/// Eight rows, of which each is given the first number of all, the second, ...
inline void transpose(std::array<Row, kRowNumbers>& rows) {
    std::array<Row, kRowNumbers> half;
    // Thrice each row is put between those of the one four further.
    for (int round = 0; round < 3; ++round) {
        for (std::size_t i = 0; i < 4; ++i) {
            half[2 * i] = __builtin_shufflevector(rows[i], rows[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
            half[2 * i + 1] =
                __builtin_shufflevector(rows[i], rows[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
        }
        rows = half;
    }
}

}  // namespace mesh_format
