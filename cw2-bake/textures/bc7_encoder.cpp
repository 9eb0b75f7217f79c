// BC7: two subsets of a block's texels, each on a line of its own, eight steps from end to end.

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

/// Sums over texels: how many, of their colours, and of the products of those.
struct Moments {
    Floats count{};
    Floats sum[3]{};
    Floats product[3][3]{};  ///< where the first index is not above the second

    CW2_INLINE void covariance(Floats (&result)[3][3]) const {
        const Floats scale = 1.0f / larger(count, all(1.0f));
        for (int a = 0; a < 3; ++a) {
            for (int b = a; b < 3; ++b) {
                result[a][b] = product[a][b] - sum[a] * sum[b] * scale;
                result[b][a] = result[a][b];
            }
        }
    }
};

/// Of the texels whose bits are set.
CW2_INLINE Moments moments_of(const Colors& colors, std::uint32_t texels) {
    Moments moments;
    for (std::uint32_t i = 0; i < 16; ++i) {
        const float weight = texels >> i & 1 ? 1.0f : 0.0f;
        moments.count += weight;
        Floats color[3];
        for (int c = 0; c < 3; ++c) color[c] = colors.channel[c].of[i] * weight;
        for (int a = 0; a < 3; ++a) {
            moments.sum[a] += color[a];
            for (int b = a; b < 3; ++b) moments.product[a][b] += color[a] * colors.channel[b].of[i];
        }
    }
    return moments;
}

CW2_INLINE Moments difference(const Moments& whole, const Moments& part) {
    Moments rest = whole;
    rest.count -= part.count;
    for (int a = 0; a < 3; ++a) {
        rest.sum[a] -= part.sum[a];
        for (int b = a; b < 3; ++b) rest.product[a][b] -= part.product[a][b];
    }
    return rest;
}

/// About the squared error that a line with eight steps leaves: what lies beside it, and a share of
/// what lies along it.
CW2_INLINE Floats estimate(const Moments& moments) {
    Floats covariance[3][3];
    moments.covariance(covariance);
    Floats axis[3];
    const Floats square = principal_axis(covariance, axis, 2);
    Floats along{};
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) along += axis[a] * covariance[a][b] * axis[b];
    }
    along /= larger(square, all(1e-20f));
    constexpr float kBeside = 0.98f;
    return covariance[0][0] + covariance[1][1] + covariance[2][2] - kBeside * along;
}

CW2_INLINE Ints best_partition(const Colors& colors) {
    const Moments whole = moments_of(colors, 0xFFFF);
    Ints best{};
    Floats least = all(1e30f);
    for (std::uint32_t partition = 0; partition < kBc7Partitions; ++partition) {
        const Moments second = moments_of(colors, mesh_format::kBc7Subsets[partition]);
        const Floats error = estimate(second) + estimate(difference(whole, second));
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
    Moments moments;
    for (int i = 0; i < 16; ++i) {
        const Floats weight = inside.of[i] ? all(1.0f) : Floats{};
        moments.count += weight;
        for (int a = 0; a < 3; ++a) {
            const Floats value = colors.channel[a].of[i] * weight;
            moments.sum[a] += value;
            for (int b = a; b < 3; ++b) moments.product[a][b] += value * colors.channel[b].of[i];
        }
    }
    Floats covariance[3][3];
    moments.covariance(covariance);
    Floats axis[3];
    const Floats square = principal_axis(covariance, axis);
    Floats mean[3];
    for (int c = 0; c < 3; ++c) mean[c] = moments.sum[c] / larger(moments.count, all(1.0f));
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
    for (int c = 0; c < 3; ++c) {
        const Ints first =
            quantise((second_square * first_sum[c] - product * second_sum[c]) * scale, line.lowest);
        const Ints second =
            quantise((first_square * second_sum[c] - product * first_sum[c]) * scale, line.lowest);
        line.first[c] = solvable ? first : line.first[c];
        line.second[c] = solvable ? second : line.second[c];
    }
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
    best.total = all(1e30f);
    for (std::int32_t lowest = 0; lowest < 2; ++lowest) {
        Line line{};
        line.lowest = Ints{} + lowest;
        for (int c = 0; c < 3; ++c) {
            line.first[c] = quantise(first[c], line.lowest);
            line.second[c] = quantise(second[c], line.lowest);
        }
        match(colors, inside, line);
        keep_better(line, best);
        refine(colors, inside, line);
        match(colors, inside, line);
        keep_better(line, best);
    }
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
    double error = 0.0;
    for (std::uint32_t left = 0; left < level.width; left += 4 * kLanes, out += 16 * kLanes) {
        error += encode_blocks({level, left, top}, out);
    }
    return error;
}

}  // namespace bake
