// BC1: the colours of a block on one line, three steps from end to end.

#include <algorithm>
#include <array>

#include "common/every_cpu.h"
#include "cw2-bake/textures/block_lanes.h"

namespace bake {
namespace {

/// Two colours for the ends of the palette, in 5, 6 and 5 bits.
struct Ends {
    Ints first[3];
    Ints second[3];
};
constexpr std::array<int, 3> kBits{5, 6, 5};

CW2_INLINE Ints quantise(Floats value, int c) {
    const float largest = static_cast<float>((1 << kBits[c]) - 1);
    return to_ints(smaller(larger(value, Floats{}), all(255.0f)) * (largest / 255.0f) + 0.5f);
}
CW2_INLINE Ints expand(Ints value, int c) {
    return value << (8 - kBits[c]) | value >> (2 * kBits[c] - 8);
}
/// x * 21846 >> 16 is x / 3 for the x that come up.
CW2_INLINE Ints third(Ints value) {
    return value * 21846 >> 16;
}

/// A palette between two ends, and for each texel how many thirds of the way it lies.
struct Candidate {
    Ends ends;
    Values steps;
    Values errors;
    Floats total;
};

CW2_INLINE void match(const Colors& colors, Candidate& candidate) {
    Floats palette[3][4];
    Floats square{};
    for (int c = 0; c < 3; ++c) {
        const Ints first = expand(candidate.ends.first[c], c);
        const Ints second = expand(candidate.ends.second[c], c);
        palette[c][0] = to_floats(first);
        palette[c][1] = to_floats(third(2 * first + second + 1));
        palette[c][2] = to_floats(third(first + 2 * second + 1));
        palette[c][3] = to_floats(second);
        const Floats difference = palette[c][3] - palette[c][0];
        square += difference * difference;
    }
    const Floats scale = 3.0f / larger(square, all(1.0f));
    Floats axis[3];
    Floats origin = all(0.5f);
    for (int c = 0; c < 3; ++c) {
        axis[c] = (palette[c][3] - palette[c][0]) * scale;
        origin -= palette[c][0] * axis[c];
    }
    candidate.total = Floats{};
    for (int i = 0; i < 16; ++i) {
        Floats along = origin;
        for (int c = 0; c < 3; ++c) along += colors.channel[c].of[i] * axis[c];
        const Ints one = along >= 1.0f;
        const Ints two = along >= 2.0f;
        const Ints three = along >= 3.0f;
        candidate.steps.of[i] = to_floats(-(one + two + three));
        Floats error{};
        for (int c = 0; c < 3; ++c) {
            const Floats upper = two ? palette[c][2] : palette[c][1];
            const Floats decoded = three ? palette[c][3] : one ? upper : palette[c][0];
            const Floats difference = colors.channel[c].of[i] - decoded;
            error += difference * difference;
        }
        candidate.errors.of[i] = error;
        candidate.total += error;
    }
}

/// The ends on the line through the mean along the direction in which the colours differ most.
CW2_INLINE Ends principal_ends(const Colors& colors, Ints& solid) {
    Floats mean[3];
    for (int c = 0; c < 3; ++c) {
        Floats sum{};
        for (const Floats value : colors.channel[c].of) sum += value;
        mean[c] = sum * (1.0f / 16.0f);
    }
    Floats covariance[3][3]{};
    for (int i = 0; i < 16; ++i) {
        Floats off[3];
        for (int c = 0; c < 3; ++c) off[c] = colors.channel[c].of[i] - mean[c];
        for (int a = 0; a < 3; ++a) {
            for (int b = a; b < 3; ++b) covariance[a][b] += off[a] * off[b];
        }
    }
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < a; ++b) covariance[a][b] = covariance[b][a];
    }
    solid = covariance[0][0] + covariance[1][1] + covariance[2][2] == 0.0f;

    Floats axis[3];
    const Floats square = principal_axis(covariance, axis);
    Floats least{};
    Floats most{};
    for (int i = 0; i < 16; ++i) {
        Floats along{};
        for (int c = 0; c < 3; ++c) along += (colors.channel[c].of[i] - mean[c]) * axis[c];
        least = smaller(least, along);
        most = larger(most, along);
    }
    Ends ends;
    for (int c = 0; c < 3; ++c) {
        const Floats unit = axis[c] / larger(square, all(1e-20f));
        ends.first[c] = quantise(mean[c] + unit * most, c);
        ends.second[c] = quantise(mean[c] + unit * least, c);
    }
    return ends;
}

/// The ends that fit the texels best (least squares) at their present steps; the present ends
/// where all steps are equal.
CW2_INLINE Ends refined_ends(const Colors& colors, const Candidate& candidate) {
    Floats first_square{};
    Floats product{};
    Floats second_square{};
    for (const Floats step : candidate.steps.of) {
        first_square += (3.0f - step) * (3.0f - step);
        product += step * (3.0f - step);
        second_square += step * step;
    }
    const Floats determinant = first_square * second_square - product * product;
    const Ints solvable = determinant > 0.5f;
    const Floats scale = 3.0f / (solvable ? determinant : all(1.0f));
    Ends ends;
    for (int c = 0; c < 3; ++c) {
        Floats sum{};
        Floats second{};
        for (int i = 0; i < 16; ++i) {
            sum += colors.channel[c].of[i];
            second += colors.channel[c].of[i] * candidate.steps.of[i];
        }
        const Floats first = 3.0f * sum - second;
        ends.first[c] = quantise((second_square * first - product * second) * scale, c);
        ends.second[c] = quantise((first_square * second - product * first) * scale, c);
        ends.first[c] = solvable ? ends.first[c] : candidate.ends.first[c];
        ends.second[c] = solvable ? ends.second[c] : candidate.ends.second[c];
    }
    return ends;
}

/// Replaces `best` in the lanes where `other` is nearer.
CW2_INLINE void keep_better(const Candidate& other, Candidate& best) {
    const Ints better = other.total < best.total;
    for (int c = 0; c < 3; ++c) {
        best.ends.first[c] = better ? other.ends.first[c] : best.ends.first[c];
        best.ends.second[c] = better ? other.ends.second[c] : best.ends.second[c];
    }
    for (int i = 0; i < 16; ++i) {
        best.steps.of[i] = better ? other.steps.of[i] : best.steps.of[i];
        best.errors.of[i] = better ? other.errors.of[i] : best.errors.of[i];
    }
    best.total = smaller(best.total, other.total);
}

/// For each byte the two ends of `bits` bits between which, a third of the way, it is met best.
class ThirdTable {
 public:
    explicit ThirdTable(int bits) {
        std::array<int, 256> error;
        error.fill(256);
        const int count = 1 << bits;
        for (int first = 0; first < count; ++first) {
            for (int second = 0; second < count; ++second) {
                const auto whole = [&](int end) {
                    return end << (8 - bits) | end >> (2 * bits - 8);
                };
                const int met = (2 * whole(first) + whole(second) + 1) / 3;
                for (int value = std::max(met - 4, 0); value <= std::min(met + 4, 255); ++value) {
                    if (std::abs(value - met) >= error[value]) continue;
                    error[value] = std::abs(value - met);
                    ends[value] = {first, second};
                }
            }
        }
    }
    std::array<std::array<int, 2>, 256> ends{};
};

/// Ends for blocks of one colour; the others keep theirs.
void solid_ends(const Colors& colors, const Ints& solid, Ends& ends) {
    static const ThirdTable five(5);
    static const ThirdTable six(6);
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        if (!solid[lane]) continue;
        for (int c = 0; c < 3; ++c) {
            const auto value = static_cast<std::size_t>(colors.channel[c].of[0][lane]);
            const auto& pair = (kBits[c] == 5 ? five : six).ends[value];
            ends.first[c][lane] = pair[0];
            ends.second[c][lane] = pair[1];
        }
    }
}

CW2_INLINE bool any(Ints mask) {
    std::int32_t sum = 0;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) sum |= mask[lane];
    return sum != 0;
}

CW2_INLINE void pack(const Candidate& best, Ints& low, Ints& high) {
    const Ints first = best.ends.first[0] << 11 | best.ends.first[1] << 5 | best.ends.first[2];
    const Ints second = best.ends.second[0] << 11 | best.ends.second[1] << 5 | best.ends.second[2];
    // The larger comes first: else a block would mean three colours and black. (Between equal ends
    // match() makes no step, and index 0 is the same in both.)
    const Ints swapped = first < second;
    low = swapped ? second | first << 16 : first | second << 16;
    high = Ints{};
    for (int i = 0; i < 16; ++i) {
        const Ints steps = to_ints(best.steps.of[i]);
        const Ints along = swapped ? 3 - steps : steps;
        // The ends come first, then what lies between them.
        const Ints index = along == 0 ? Ints{} : along == 3 ? Ints{} + 1 : along + 1;
        high |= index << 2 * i;
    }
}

CW2_INLINE double encode_colors(const Place& place, std::byte* out) {
    Colors colors;
    gather_colors(place, colors);
    Ints solid;
    Candidate best;
    best.ends = principal_ends(colors, solid);
    if (any(solid)) solid_ends(colors, solid, best.ends);
    match(colors, best);
    Candidate next = best;
    for (int round = 0; round < 2; ++round) {
        next.ends = refined_ends(colors, next);
        match(colors, next);
        keep_better(next, best);
    }
    Ints low;
    Ints high;
    pack(best, low, high);
    store(place, low, high, out, 8);
    return sum_inside(best.errors, place);
}

}  // namespace

CW2_EVERY_CPU double encode_bc1_row(const PlainLevel& level, std::uint32_t top, std::byte* out) {
    return encode_row<8, encode_colors>(level, top, out);
}

}  // namespace bake
