// BC4: the values of a block on a ramp between two of them. BC5: two of these.

#include <array>
#include <cmath>

#include "common/every_cpu.h"
#include "cw2-bake/textures/block_lanes.h"

namespace bake {
namespace {

/// Two whole numbers in [0, 255], the first not below the second, with six others between them; a
/// texel has one of these, 0 to 7 steps from the first.
struct Ramp {
    Floats first;
    Floats second;

    /// 0 where the ends are equal, so that all texels are at step 0.
    CW2_INLINE Floats steps_per_unit() const {
        return first > second ? 7.0f / larger(first - second, all(1.0f)) : Floats{};
    }
};

/// The step nearest to a place that lies so many steps from the first.
CW2_INLINE Floats nearest_step(Floats along) {
    return to_floats(to_ints(smaller(larger(along, Floats{}), all(7.0f)) + 0.5f));
}

/// What a step of a ramp decodes to. The quotient is exact: a quarter more than the half that
/// rounds it never reaches the next whole number.
CW2_INLINE Floats decoded(const Ramp& ramp, Floats step) {
    const Floats range = ramp.first - ramp.second;
    return ramp.first - to_floats(to_ints((step * range + 3.25f) * (1.0f / 7.0f)));
}

/// The sum of the squared differences.
CW2_INLINE Floats error_of(const Values& values, const Ramp& ramp) {
    const Floats scale = ramp.steps_per_unit();
    Floats error{};
    for (int i = 0; i < 16; ++i) {
        const Floats step = nearest_step((ramp.first - values.of[i]) * scale);
        const Floats off = values.of[i] - decoded(ramp, step);
        error += off * off;
    }
    return error;
}

CW2_INLINE Floats to_byte(Floats value) {
    return to_floats(to_ints(smaller(larger(value, Floats{}), all(255.0f)) + 0.5f));
}

/// The ramp that fits the texels best (least squares) at the steps that they have on `ramp`, which
/// it is where those are all equal. `sum` is that of the values.
CW2_INLINE Ramp refined(const Values& values, Floats sum, const Ramp& ramp) {
    const Floats scale = ramp.steps_per_unit();
    Floats steps{};
    Floats second_square{};
    Floats second_sum{};
    for (int i = 0; i < 16; ++i) {
        const Floats step = nearest_step((ramp.first - values.of[i]) * scale);
        steps += step;
        second_square += step * step;
        second_sum += step * values.of[i];
    }
    const Floats product = 7.0f * steps - second_square;
    const Floats first_square = 16.0f * 49.0f - 7.0f * steps - product;
    const Floats first_sum = 7.0f * sum - second_sum;
    const Floats determinant = first_square * second_square - product * product;
    const Ints solvable = determinant > 0.5f;
    const Floats factor = 7.0f / (solvable ? determinant : all(1.0f));
    const Floats first = to_byte((second_square * first_sum - product * second_sum) * factor);
    const Floats second = to_byte((first_square * second_sum - product * first_sum) * factor);
    return {solvable ? first : ramp.first, solvable ? smaller(first, second) : ramp.second};
}

CW2_INLINE Ramp ramp_of_all(const Values& values) {
    Ramp ramp{values.of[0], values.of[0]};
    for (const Floats value : values.of) {
        ramp.first = larger(ramp.first, value);
        ramp.second = smaller(ramp.second, value);
    }
    return ramp;
}

/// Where the search for a ramp starts: how many 16ths of the range inside of its ends. Few texels
/// are at the ends, and most are nearer to a shorter ramp.
struct Inset {
    float first;
    float second;
};
constexpr std::array<Inset, 3> kInsets{{{1, 1}, {1, 0}, {0, 1}}};

/// The best of the ramp of all values and of those that start inside of it.
CW2_INLINE Ramp best_ramp(const Values& values) {
    const Ramp whole = ramp_of_all(values);
    Floats sum{};
    for (const Floats value : values.of) sum += value;
    Ramp best = whole;
    Floats least = error_of(values, whole);
    for (const Inset& inset : kInsets) {
        const Floats sixteenth = (whole.first - whole.second) * (1.0f / 16.0f);
        const Ramp ramp = refined(
            values, sum,
            {whole.first - sixteenth * inset.first, whole.second + sixteenth * inset.second});
        const Floats error = error_of(values, ramp);
        best.first = error < least ? ramp.first : best.first;
        best.second = error < least ? ramp.second : best.second;
        least = smaller(least, error);
    }
    return best;
}

/// What a block holds of one channel.
struct Block {
    Ints first;
    Ints second;
    Ints index[16];

    CW2_INLINE void store(const Place& place, std::byte* out, std::size_t step) const {
        Ints bits[2]{};
        for (int i = 0; i < 16; ++i) bits[i / 8] |= index[i] << 3 * (i % 8);
        bake::store(place, first | second << 8 | bits[0] << 16,
                    (bits[0] >> 16 & 255) | bits[1] << 8, out, step);
    }
};

/// The ends come first, then what lies between them.
CW2_INLINE Ints index_of(Floats step) {
    const Ints later = step == 7.0f ? Ints{} + 1 : to_ints(step) + 1;
    return step == 0.0f ? Ints{} : later;
}

CW2_INLINE Ints strays(Floats value, Floats decoded, float limit) {
    return (value >= limit) ^ (decoded >= limit);
}

/// Fills in what the values decode to, and returns the sum of the squared differences. Of a mask
/// each is on its side of the limit; the sum is huge where the ramp leaves a texel no such step.
template <bool kIsMask>
CW2_INLINE Floats encode_on_ramp(const Values& values, const Ramp& ramp, float limit, Values& shown,
                                 Block& block) {
    const Floats scale = ramp.steps_per_unit();
    Floats error{};
    for (int i = 0; i < 16; ++i) {
        const Floats value = values.of[i];
        Floats step = nearest_step((ramp.first - value) * scale);
        if constexpr (kIsMask) {
            const Floats next = value >= limit ? step - 1.0f : step + 1.0f;
            const auto goes_on =
                strays(value, decoded(ramp, step), limit) & (next >= 0.0f) & (next <= 7.0f);
            step = goes_on ? next : step;
        }
        shown.of[i] = decoded(ramp, step);
        block.index[i] = index_of(step);
        const Floats off = value - shown.of[i];
        if constexpr (kIsMask)
            error += strays(value, shown.of[i], limit) ? all(1e9f) : off * off;
        else
            error += off * off;
    }
    block.first = to_ints(ramp.first);
    block.second = to_ints(ramp.second);
    return error;
}

/// Encodes one channel; `values` become what the blocks decode to.
CW2_INLINE void encode_scalars(Values& values, const Ramp& ramp, Block& block) {
    encode_on_ramp<false>(values, ramp, 0.0f, values, block);
}

/// As encode_scalars(), with every texel on its side of the limit.
CW2_INLINE void encode_mask(Values& values, float limit, Block& block) {
    // Between the ends of the whole ramp every value has a number on its side.
    Values shown;
    const Floats error = encode_on_ramp<true>(values, ramp_of_all(values), limit, shown, block);
    const Ramp ramp = best_ramp(values);
    Values other_shown;
    Block other;
    const Ints better = encode_on_ramp<true>(values, ramp, limit, other_shown, other) < error;
    for (int i = 0; i < 16; ++i) {
        values.of[i] = better ? other_shown.of[i] : shown.of[i];
        block.index[i] = better ? other.index[i] : block.index[i];
    }
    block.first = better ? other.first : block.first;
    block.second = better ? other.second : block.second;
}

// ---- BC5 ----

CW2_INLINE Floats square_root(Floats values) {
    Floats roots;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) roots[lane] = std::sqrt(values[lane]);
    return roots;
}

/// What 0.5 n + 0.5 in 8 bits stands for.
CW2_INLINE Floats component(Floats value) {
    return value * (2.0f / 255.0f) - 1.0f;
}
/// z of a normal.
CW2_INLINE Floats height(Floats x, Floats y) {
    return square_root(larger(1.0f - x * x - y * y, Floats{}));
}

CW2_INLINE double encode_normals(const Place& place, std::byte* out) {
    Ints texels[16];
    gather<std::uint16_t>(place, texels);
    Values decoded[2];
    for (int c = 0; c < 2; ++c) {
        channel(texels, c, decoded[c]);
        Block block;
        encode_scalars(decoded[c], best_ramp(decoded[c]), block);
        block.store(place, out + 8 * c, 16);
    }
    Values errors;
    for (int i = 0; i < 16; ++i) {
        const Floats x = component(decoded[0].of[i]);
        const Floats y = component(decoded[1].of[i]);
        const Floats true_x = component(to_floats(texels[i] & 255));
        const Floats true_y = component(to_floats(texels[i] >> 8));
        const Floats off[3]{x - true_x, y - true_y, height(x, y) - height(true_x, true_y)};
        errors.of[i] = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
    }
    return sum_inside(errors, place) * (127.5 * 127.5);
}

/// With a limit of 0 no mask.
CW2_INLINE double encode_values(const Place& place, std::byte* out, std::uint32_t limit) {
    Ints texels[16];
    gather<std::uint8_t>(place, texels);
    Values decoded;
    for (int i = 0; i < 16; ++i) decoded.of[i] = to_floats(texels[i]);
    Block block;
    if (limit == 0) {
        // No picture shows that a better ramp is 0.9 dB nearer.
        encode_scalars(decoded, ramp_of_all(decoded), block);
    } else {
        encode_mask(decoded, static_cast<float>(limit), block);
    }
    block.store(place, out, 8);
    for (int i = 0; i < 16; ++i) {
        const Floats difference = to_floats(texels[i]) - decoded.of[i];
        decoded.of[i] = difference * difference;
    }
    return sum_inside(decoded, place);
}

}  // namespace

CW2_EVERY_CPU double encode_bc4_row(const PlainLevel& level, std::uint32_t top, std::uint32_t limit,
                                    std::byte* out) {
    return encode_row<8, encode_values>(level, top, out, limit);
}

CW2_EVERY_CPU double encode_bc5_row(const PlainLevel& level, std::uint32_t top, std::byte* out) {
    return encode_row<16, encode_normals>(level, top, out);
}

}  // namespace bake
