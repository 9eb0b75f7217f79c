// The arithmetic of encoding blocks, on several of them at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/every_cpu.h"
#include "cw2-bake/textures/block_encoders.h"

namespace bake {

/// Blocks that are encoded at a time, one a lane.
inline constexpr std::uint32_t kLanes = 8;
using Floats [[gnu::vector_size(4 * kLanes)]] = float;
using Ints [[gnu::vector_size(4 * kLanes)]] = std::int32_t;

/// One value of each of the 16 texels of a block, row by row.
struct Values {
    Floats of[16];
};

CW2_INLINE Floats to_floats(Ints values) {
    return __builtin_convertvector(values, Floats);
}
/// Towards zero.
CW2_INLINE Ints to_ints(Floats values) {
    return __builtin_convertvector(values, Ints);
}
CW2_INLINE Floats smaller(Floats a, Floats b) {
    return a < b ? a : b;
}
CW2_INLINE Floats larger(Floats a, Floats b) {
    return a > b ? a : b;
}
CW2_INLINE Floats all(float value) {
    return value - Floats{};
}

/// Where a group of blocks lies in its level.
struct Place {
    PlainLevel level;
    std::uint32_t left;  ///< texels
    std::uint32_t top;

    bool inside() const { return left + 4 * kLanes <= level.width && top + 4 <= level.height; }
};

/// The texels of a group; Word has the size of a texel.
template <typename Word>
CW2_INLINE void gather(const Place& place, Ints (&texels)[16]) {
    alignas(32) std::int32_t words[16][kLanes];
    for (std::uint32_t y = 0; y < 4; ++y) {
        const std::uint32_t row = std::min(place.top + y, place.level.height - 1);
        const std::byte* begin =
            place.level.texels + std::size_t{row} * place.level.width * sizeof(Word);
        Word line[4 * kLanes];
        if (place.left + 4 * kLanes <= place.level.width) {
            std::memcpy(line, begin + place.left * sizeof(Word), sizeof line);
        } else {
            for (std::uint32_t x = 0; x < 4 * kLanes; ++x) {
                const std::size_t at = std::min(place.left + x, place.level.width - 1);
                std::memcpy(&line[x], begin + at * sizeof(Word), sizeof(Word));
            }
        }
        for (std::uint32_t x = 0; x < 4; ++x) {
            for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
                words[4 * y + x][lane] = static_cast<std::int32_t>(line[4 * lane + x]);
            }
        }
    }
    std::memcpy(texels, words, sizeof words);
}

/// Channel `c` of texels of four bytes.
CW2_INLINE void channel(const Ints (&texels)[16], int c, Values& values) {
    for (int i = 0; i < 16; ++i) values.of[i] = to_floats(texels[i] >> 8 * c & 255);
}

/// Sums the errors of the texels that lie inside the level.
CW2_INLINE double sum_inside(const Values& errors, const Place& place) {
    double sum = 0.0;
    if (place.inside()) {
        Floats sums{};
        for (int i = 0; i < 16; ++i) sums += errors.of[i];
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) sum += sums[lane];
        return sum;
    }
    for (std::uint32_t i = 0; i < 16; ++i) {
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            if (place.left + 4 * lane + i % 4 < place.level.width &&
                place.top + i / 4 < place.level.height) {
                sum += errors.of[i][lane];
            }
        }
    }
    return sum;
}

/// Writes the group's blocks that lie inside the level, each of 8 bytes, `step` bytes apart.
CW2_INLINE void store(const Place& place, Ints low, Ints high, std::byte* out, std::size_t step) {
    const std::uint32_t count = std::min(kLanes, (place.level.width - place.left + 3) / 4);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
        const std::uint64_t block = static_cast<std::uint32_t>(low[lane]) |
                                    std::uint64_t{static_cast<std::uint32_t>(high[lane])} << 32;
        std::memcpy(out + lane * step, &block, sizeof block);
    }
}

/// Encodes a row of a level's blocks, each of kBytes, group by group: by kEncode(place, out,
/// more...), which returns a group's error. Returns the sum of these.
template <std::size_t kBytes, auto kEncode, typename... More>
CW2_INLINE double encode_row(const PlainLevel& level, std::uint32_t top, std::byte* out,
                             More... more) {
    double error = 0.0;
    for (std::uint32_t left = 0; left < level.width; left += 4 * kLanes, out += kBytes * kLanes)
        error += kEncode(Place{level, left, top}, out, more...);
    return error;
}

/// Red, green and blue.
struct Colors {
    Values channel[3];
};

CW2_INLINE void gather_colors(const Place& place, Colors& colors) {
    Ints texels[16];
    gather<std::uint32_t>(place, texels);
    for (int c = 0; c < 3; ++c) channel(texels, c, colors.channel[c]);
}

CW2_INLINE void times(const Floats (&matrix)[3][3], const Floats (&vector)[3],
                      Floats (&product)[3]) {
    for (int c = 0; c < 3; ++c) {
        product[c] = matrix[c][0] * vector[0] + matrix[c][1] * vector[1] + matrix[c][2] * vector[2];
    }
}

/// The row of the channel that varies most.
CW2_INLINE void widest_row(const Floats (&covariance)[3][3], Floats (&row)[3]) {
    const Ints red =
        (covariance[0][0] >= covariance[1][1]) & (covariance[0][0] >= covariance[2][2]);
    const Ints green = covariance[1][1] >= covariance[2][2];
    for (int c = 0; c < 3; ++c) {
        const Floats other = green ? covariance[1][c] : covariance[2][c];
        row[c] = red ? covariance[0][c] : other;
    }
}

/// The direction in which colours of this covariance differ most, its largest part 1, by power
/// iteration from widest_row(). Returns its square.
CW2_INLINE Floats principal_axis(const Floats (&covariance)[3][3], Floats (&axis)[3]) {
    widest_row(covariance, axis);
    for (int step = 0; step < 4; ++step) {
        Floats next[3];
        times(covariance, axis, next);
        std::copy_n(next, 3, axis);
    }
    Floats longest = all(1e-20f);
    for (const Floats part : axis) longest = larger(longest, larger(part, -part));
    Floats square{};
    for (Floats& part : axis) {
        part /= longest;
        square += part * part;
    }
    return square;
}

}  // namespace bake
