// BC7: two subsets of a block's texels, each on a line of its own, eight steps from end to end.

#include <bit>

#include "common/every_cpu.h"
#include "cw2-bake/textures/block_lanes.h"
#include "mesh-format/bc7.h"

namespace bake {
namespace {

using mesh_format::kBc7Partitions;

/// Of each texel, in each lane, all bits or none.
struct Masks {
    Ints of[16];
};

/// Sums over texels of their colours and of the products of those.
struct Moments {
    Floats sum[3];
    Floats product[6];  ///< red by red, by green, by blue, green by green, by blue, blue by blue

    /// Of one texel.
    CW2_INLINE void set(const Colors& colors, int texel) {
        int i = 0;
        for (int a = 0; a < 3; ++a) {
            sum[a] = colors.channel[a].of[texel];
            for (int b = a; b < 3; ++b, ++i)
                product[i] = colors.channel[a].of[texel] * colors.channel[b].of[texel];
        }
    }
    CW2_INLINE void add(const Moments& other) {
        for (int i = 0; i < 3; ++i) sum[i] += other.sum[i];
        for (int i = 0; i < 6; ++i) product[i] += other.product[i];
    }
    CW2_INLINE void subtract(const Moments& other) {
        for (int i = 0; i < 3; ++i) sum[i] -= other.sum[i];
        for (int i = 0; i < 6; ++i) product[i] -= other.product[i];
    }
    /// Of so many texels, times their number.
    CW2_INLINE void covariance(Floats count, Floats (&result)[3][3]) const {
        const Floats scale = 1.0f / count;
        int i = 0;
        for (int a = 0; a < 3; ++a) {
            for (int b = a; b < 3; ++b, ++i) {
                result[a][b] = product[i] - sum[a] * sum[b] * scale;
                result[b][a] = result[a][b];
            }
        }
    }
};

/// The variance along the direction in which colours of this covariance differ most, nearly.
CW2_INLINE Floats largest_variance(const Floats (&covariance)[3][3]) {
    Floats axis[3];
    widest_row(covariance, axis);
    Floats square{};
    Floats variance{};
    Floats next[3];
    times(covariance, axis, next);
    times(covariance, next, axis);
    for (int c = 0; c < 3; ++c) {
        square += next[c] * next[c];
        variance += next[c] * axis[c];
    }
    return variance / larger(square, all(1e-20f));
}

/// About the squared error that a line with eight steps leaves: what lies beside it, and a share of
/// what lies along it.
CW2_INLINE Floats estimate(const Moments& moments, int count) {
    Floats covariance[3][3];
    moments.covariance(all(static_cast<float>(count)), covariance);
    const Floats along = largest_variance(covariance);
    constexpr float kBeside = 0.98f;
    return covariance[0][0] + covariance[1][1] + covariance[2][2] - kBeside * along;
}

CW2_INLINE Ints best_partition(const Colors& colors) {
    Moments texels[16];
    Moments whole{};
    for (int i = 0; i < 16; ++i) {
        texels[i].set(colors, i);
        whole.add(texels[i]);
    }
    Ints best{};
    Floats least = all(1e30f);
    for (std::uint32_t partition = 0; partition < kBc7Partitions; ++partition) {
        const std::uint32_t subset = mesh_format::kBc7Subsets[partition];
        Moments second{};
        for (std::uint32_t left = subset; left != 0; left &= left - 1)
            second.add(texels[std::countr_zero(left)]);
        Moments first = whole;
        first.subtract(second);
        const int count = std::popcount(subset);
        const Floats error = estimate(first, 16 - count) + estimate(second, count);
        best = error < least ? Ints{} + static_cast<std::int32_t>(partition) : best;
        least = smaller(least, error);
    }
    return best;
}

/// Two ends for a subset, and for each of its texels how many steps from the first it lies.
struct Line {
    Ints first[3];   ///< six bits
    Ints second[3];  ///< the same
    Ints lowest;     ///< the bit below those of all
    Values steps;
    Values errors;
    Floats total;
};

CW2_INLINE Ints quantise(Floats value, Ints lowest) {
    const Floats six = (value * (127.0f / 255.0f) - to_floats(lowest)) * 0.5f;
    return to_ints(smaller(larger(six, Floats{}), all(63.0f)) + 0.5f);
}

/// The nearest ends that a line can have, in the lanes of `where`.
CW2_INLINE void set_ends(const Floats (&first)[3], const Floats (&second)[3], Ints where,
                         Line& line) {
    Floats least = all(1e30f);
    for (std::int32_t lowest = 0; lowest < 2; ++lowest) {
        const Ints bit = Ints{} + lowest;
        Ints ends[2][3];
        Floats error{};
        for (int c = 0; c < 3; ++c) {
            ends[0][c] = quantise(first[c], bit);
            ends[1][c] = quantise(second[c], bit);
            const Floats off[2] = {first[c] - to_floats(mesh_format::expand_bc7(ends[0][c], bit)),
                                   second[c] - to_floats(mesh_format::expand_bc7(ends[1][c], bit))};
            error += off[0] * off[0] + off[1] * off[1];
        }
        const Ints better = where & (error < least);
        for (int c = 0; c < 3; ++c) {
            line.first[c] = better ? ends[0][c] : line.first[c];
            line.second[c] = better ? ends[1][c] : line.second[c];
        }
        line.lowest = better ? bit : line.lowest;
        least = smaller(least, error);
    }
}

CW2_INLINE void match(const Colors& colors, const Masks& inside, Line& line) {
    Floats first[3];
    Floats axis[3];
    Floats square{};
    for (int c = 0; c < 3; ++c) {
        first[c] = to_floats(mesh_format::expand_bc7(line.first[c], line.lowest));
        axis[c] = to_floats(mesh_format::expand_bc7(line.second[c], line.lowest)) - first[c];
        square += axis[c] * axis[c];
    }
    const Floats scale = 7.0f / larger(square, all(1.0f));
    line.total = Floats{};
    for (int i = 0; i < 16; ++i) {
        Floats along{};
        for (int c = 0; c < 3; ++c) along += (colors.channel[c].of[i] - first[c]) * axis[c];
        const Floats step =
            to_floats(to_ints(smaller(larger(along * scale, Floats{}), all(7.0f)) + 0.5f));
        // kBc7Weights
        const Floats weight = step * 9.0f + (step > 3.5f ? all(1.0f) : Floats{});
        Floats error{};
        for (int c = 0; c < 3; ++c) {
            const Floats decoded =
                to_floats(to_ints((first[c] * 64.0f + axis[c] * weight + 32.0f) * (1.0f / 64.0f)));
            const Floats off = colors.channel[c].of[i] - decoded;
            error += off * off;
        }
        line.steps.of[i] = step;
        line.errors.of[i] = inside.of[i] ? error : Floats{};
        line.total += line.errors.of[i];
    }
}

/// The ends on the line through the mean along the direction in which the colours differ most.
CW2_INLINE void principal_ends(const Colors& colors, const Masks& inside, Floats (&first)[3],
                               Floats (&second)[3]) {
    Moments moments{};
    Floats count{};
    for (int i = 0; i < 16; ++i) {
        Moments texel;
        texel.set(colors, i);
        const Floats weight = inside.of[i] ? all(1.0f) : Floats{};
        count += weight;
        for (Floats& sum : texel.sum) sum *= weight;
        for (Floats& product : texel.product) product *= weight;
        moments.add(texel);
    }
    count = larger(count, all(1.0f));
    Floats covariance[3][3];
    moments.covariance(count, covariance);
    Floats axis[3];
    const Floats square = principal_axis(covariance, axis);
    Floats mean[3];
    for (int c = 0; c < 3; ++c) mean[c] = moments.sum[c] / count;
    Floats least{};
    Floats most{};
    for (int i = 0; i < 16; ++i) {
        Floats along{};
        for (int c = 0; c < 3; ++c) along += (colors.channel[c].of[i] - mean[c]) * axis[c];
        along = inside.of[i] ? along : Floats{};
        least = smaller(least, along);
        most = larger(most, along);
    }
    for (int c = 0; c < 3; ++c) {
        const Floats unit = axis[c] / larger(square, all(1e-20f));
        first[c] = mean[c] + unit * least;
        second[c] = mean[c] + unit * most;
    }
}

/// The ends that fit the texels best (least squares) at their present steps; the present ones where
/// all steps are equal.
CW2_INLINE void refine(const Colors& colors, const Masks& inside, Line& line) {
    Floats first_square{};
    Floats product{};
    Floats second_square{};
    Floats first_sum[3]{};
    Floats second_sum[3]{};
    for (int i = 0; i < 16; ++i) {
        const Floats weight = inside.of[i] ? all(1.0f) : Floats{};
        const Floats second = line.steps.of[i] * weight;
        const Floats first = 7.0f * weight - second;
        first_square += first * first;
        product += first * second;
        second_square += second * second;
        for (int c = 0; c < 3; ++c) {
            first_sum[c] += first * colors.channel[c].of[i];
            second_sum[c] += second * colors.channel[c].of[i];
        }
    }
    const Floats determinant = first_square * second_square - product * product;
    const Ints solvable = determinant > 0.5f;
    const Floats scale = 7.0f / (solvable ? determinant : all(1.0f));
    Floats first[3];
    Floats second[3];
    for (int c = 0; c < 3; ++c) {
        first[c] = (second_square * first_sum[c] - product * second_sum[c]) * scale;
        second[c] = (first_square * second_sum[c] - product * first_sum[c]) * scale;
    }
    set_ends(first, second, solvable, line);
}

/// Replaces `best` in the lanes where `other` is nearer.
CW2_INLINE void keep_better(const Line& other, Line& best) {
    const Ints better = other.total < best.total;
    for (int c = 0; c < 3; ++c) {
        best.first[c] = better ? other.first[c] : best.first[c];
        best.second[c] = better ? other.second[c] : best.second[c];
    }
    best.lowest = better ? other.lowest : best.lowest;
    for (int i = 0; i < 16; ++i) {
        best.steps.of[i] = better ? other.steps.of[i] : best.steps.of[i];
        best.errors.of[i] = better ? other.errors.of[i] : best.errors.of[i];
    }
    best.total = smaller(best.total, other.total);
}

/// The line of a subset whose step at texel `anchor` has its highest bit 0.
CW2_INLINE Line fit(const Colors& colors, const Masks& inside, int anchor) {
    Floats first[3];
    Floats second[3];
    principal_ends(colors, inside, first, second);
    Line best{};
    set_ends(first, second, ~Ints{}, best);
    match(colors, inside, best);
    Line line = best;
    refine(colors, inside, line);
    match(colors, inside, line);
    keep_better(line, best);
    // From either end the same colours lie between.
    const Ints turned = best.steps.of[anchor] > 3.5f;
    for (int c = 0; c < 3; ++c) {
        const Ints end = best.first[c];
        best.first[c] = turned ? best.second[c] : end;
        best.second[c] = turned ? end : best.second[c];
    }
    for (Floats& step : best.steps.of) step = turned ? 7.0f - step : step;
    return best;
}

/// The bits of a block, the lowest first.
class BlockWriter {
 public:
    void put(std::int32_t bits, std::uint32_t count) {
        const auto value = static_cast<std::uint64_t>(static_cast<std::uint32_t>(bits));
        words_[at_ / 64] |= value << at_ % 64;
        if (at_ / 64 == 0 && at_ + count > 64) words_[1] |= value >> (64 - at_);
        at_ += count;
    }
    void store(std::byte* out) const { std::memcpy(out, words_, sizeof words_); }

 private:
    std::uint64_t words_[2] = {};
    std::uint32_t at_ = 0;
};

/// Writes the blocks that lie inside the level; see mesh-format/bc7.h.
CW2_INLINE void store(const Place& place, const Ints& partition, const Line (&lines)[2],
                      const Ints (&steps)[16], std::byte* out) {
    const std::uint32_t count = std::min(kLanes, (place.level.width - place.left + 3) / 4);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
        BlockWriter writer;
        writer.put(2, 2);
        writer.put(partition[lane], 6);
        for (int c = 0; c < 3; ++c) {
            for (const Line& line : lines) {
                writer.put(line.first[c][lane], 6);
                writer.put(line.second[c][lane], 6);
            }
        }
        for (const Line& line : lines) writer.put(line.lowest[lane], 1);
        for (int i = 0; i < 16; ++i) writer.put(steps[i][lane], i == 0 || i == 15 ? 2 : 3);
        writer.store(out + std::size_t{16} * lane);
    }
}

CW2_INLINE double encode_blocks(const Place& place, std::byte* out) {
    Colors colors;
    gather_colors(place, colors);
    const Ints partition = best_partition(colors);
    Ints subsets;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane)
        subsets[lane] = mesh_format::kBc7Subsets[static_cast<std::size_t>(partition[lane])];
    Masks inside[2];
    for (int i = 0; i < 16; ++i) {
        inside[1].of[i] = (subsets >> i & 1) != 0;
        inside[0].of[i] = ~inside[1].of[i];
    }
    const Line lines[2] = {fit(colors, inside[0], 0), fit(colors, inside[1], 15)};
    Ints steps[16];
    Values errors;
    for (int i = 0; i < 16; ++i) {
        steps[i] = to_ints(inside[1].of[i] ? lines[1].steps.of[i] : lines[0].steps.of[i]);
        errors.of[i] = lines[0].errors.of[i] + lines[1].errors.of[i];
    }
    store(place, partition, lines, steps, out);
    return sum_inside(errors, place);
}

}  // namespace

CW2_EVERY_CPU double encode_bc7_row(const PlainLevel& level, std::uint32_t top, std::byte* out) {
    return encode_row<16, encode_blocks>(level, top, out);
}

}  // namespace bake
