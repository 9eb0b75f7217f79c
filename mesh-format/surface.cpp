#include "mesh-format/surface.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "common/every_cpu.h"

// How vectors of 32 bytes are handed over depends on the processor; all that take them are inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace mesh_format {

namespace {

using std::int32_t;
using std::int64_t;
using std::uint64_t;

using Four = int32_t __attribute__((vector_size(16)));
using UnsignedFour = std::uint32_t __attribute__((vector_size(16)));
using UnsignedEight = std::uint32_t __attribute__((vector_size(32)));

/// Of two rows of signed numbers the products, each two neighbouring ones added; modulo 2^32.
CW2_INLINE Four paired_products(const Row& a, const Row& b) {
#ifdef __SSE2__
    using Words = short __attribute__((vector_size(16)));
    return reinterpret_cast<Four>(
        __builtin_ia32_pmaddwd128(reinterpret_cast<Words>(a), reinterpret_cast<Words>(b)));
#else
    UnsignedFour sums;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto product = [&](std::size_t at) {
            return static_cast<std::uint32_t>(static_cast<std::int16_t>(a[at]) *
                                              static_cast<std::int16_t>(b[at]));
        };
        sums[k] = product(2 * k) + product(2 * k + 1);
    }
    return reinterpret_cast<Four>(sums);
#endif
}

/// Adds to a vertex's sums, as many as there are.
template <typename Parts>
CW2_INLINE void add(Sum* sums, const Parts& parts) {
    Parts lanes;
    std::memcpy(&lanes, sums, sizeof lanes);
    lanes += parts;
    std::memcpy(sums, &lanes, sizeof lanes);
}

template <bool kHasUvs>
CW2_INLINE void add_triangle(const std::uint16_t* indices, const Place* places,
                             const SurfaceModel& model, Sum* sums) {
    const std::size_t corners[] = {indices[0], indices[1], indices[2]};
    const Place& first = places[corners[0]];
    // The edges e = second - first and f = third - first, and the other way.
    const Row e = places[corners[1]] - first;
    const Row minus_e = first - places[corners[1]];
    const Row minus_f = first - places[corners[2]];
    // cross(e, f), component by component: e.z -f.y + -e.y -f.z, ...
    const Row left = __builtin_shufflevector(e, minus_e, 2, 9, 0, 10, 1, 8, 3, 3);
    const Row right = __builtin_shufflevector(minus_f, minus_f, 1, 2, 2, 0, 0, 1, 3, 3);
    const Four normal = paired_products(left, right) >> model.normal_shift;
    if constexpr (!kHasUvs) {
        for (const std::size_t corner : corners)
            add(&sums[corner], reinterpret_cast<UnsignedFour>(normal));
    } else {
        // The edges' combination of no v, and what it has of u: e f.v - f e.v, the other way.
        const Row edges = __builtin_shufflevector(e, minus_f, 0, 8, 1, 9, 2, 10, 3, 11);
        const Row factors = __builtin_shufflevector(minus_f, minus_e, 4, 12, 4, 12, 4, 12, 4, 12);
        const Four along_u = paired_products(edges, factors);
        const Four is_negative = __builtin_shufflevector(along_u, along_u, 3, 3, 3, 3) >> 31;
        const Four sign = is_negative & Four{-1, -1, -1, 0};
        const Four tangent = (along_u >> model.tangent_shift ^ sign) - sign;
        const auto both = reinterpret_cast<UnsignedEight>(
            __builtin_shufflevector(normal, tangent, 0, 1, 2, 3, 4, 5, 6, 7));
        for (const std::size_t corner : corners) add(&sums[2 * corner], both);
    }
}

template <bool kHasUvs>
CW2_INLINE void sum_all(std::span<const std::uint16_t> indices, const Place* places,
                        const SurfaceModel& model, Sum* sums) {
    // One of each quarter in turn: those that follow each other wait for the sums of the same
    // vertex.
    constexpr std::size_t kParts = 4;
    const std::size_t count = indices.size() / 3;
    const std::size_t part = count / kParts;
    for (std::size_t i = 0; i < part; ++i)
        for (std::size_t k = 0; k < kParts; ++k)
            add_triangle<kHasUvs>(&indices[3 * (k * part + i)], places, model, sums);
    for (std::size_t i = kParts * part; i < count; ++i)
        add_triangle<kHasUvs>(&indices[3 * i], places, model, sums);
}

constexpr std::size_t kLanes = 8;
using Lanes = int32_t __attribute__((vector_size(4 * kLanes)));
using Floats = float __attribute__((vector_size(4 * kLanes)));
struct Vectors {
    Lanes x, y, z;
};

// Numbers below 1, cosines and components of unit vectors, are in units of 2^-14; so products of
// two fit.
constexpr int kBits = 14;
constexpr int32_t kOne = 1 << kBits;

constexpr int32_t fixed(double number) {
    return static_cast<int32_t>(number * kOne + 0.5);
}

CW2_INLINE Lanes dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
CW2_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
CW2_INLINE Vectors difference(const Vectors& a, const Vectors& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
CW2_INLINE Vectors product(const Vectors& a, const Lanes& factor) {
    return {a.x * factor, a.y * factor, a.z * factor};
}
CW2_INLINE Vectors shifted(const Vectors& a, const Lanes& bits) {
    return {a.x >> bits, a.y >> bits, a.z >> bits};
}
CW2_INLINE Lanes larger(const Lanes& a, const Lanes& b) {
    return a > b ? a : b;
}

/// Of numbers not below 0, 126 + how many bits they have, or 0 of 0: what a float has as exponent.
CW2_INLINE Lanes exponent(const Lanes& number) {
    // Without the bit below the highest it is not rounded up to the next power of two.
    const Floats floats = __builtin_convertvector(number & ~(number >> 1), Floats);
    return reinterpret_cast<Lanes>(floats) >> 23;
}

/// Has all bits of the components, or of those above them where they are below 0.
CW2_INLINE Lanes size(const Vectors& a) {
    return (a.x ^ a.x >> 31) | (a.y ^ a.y >> 31) | (a.z ^ a.z >> 31);
}

/// Of any components, and their size; then they are of 14 bits.
CW2_INLINE Vectors shortened(const Vectors& a, const Lanes& size) {
    return shifted(a, larger(exponent(size) - (126 + kBits), Lanes{}));
}

/// 2^15 / sqrt(number) in units of 2^-14, of numbers from 2^28 to 2^30; within 0.1 %.
CW2_INLINE Lanes inverse_root(const Lanes& number) {
    const Lanes x = number >> 16;
    const Lanes y =
        fixed(2.67084) - (x * (fixed(3.28536) - (x * fixed(1.63857) >> kBits)) >> kBits);
    const Lanes factor = 3 * kOne - (x * (y * y >> kBits) >> kBits);  // of Newton's step
    return y * factor >> (kBits + 1);
}

/// Within 0.1 % of length kOne, of components of 14 bits; 0 remains 0.
CW2_INLINE Vectors nearly_unit(const Vectors& a) {
    const Lanes square = dot(a, a) | 1;
    const Lanes bits = (156 - exponent(square)) >> 1;  // to have 29 or 30 once shifted twice
    return shifted(product(a, inverse_root(square << 2 * bits)), 15 - bits);
}

using UnsignedLanes = std::uint32_t __attribute__((vector_size(4 * kLanes)));

/// a b - c d, modulo 2^32.
CW2_INLINE Lanes wrapped_winding(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d) {
    return reinterpret_cast<Lanes>(
        reinterpret_cast<UnsignedLanes>(a) * reinterpret_cast<UnsignedLanes>(b) -
        reinterpret_cast<UnsignedLanes>(c) * reinterpret_cast<UnsignedLanes>(d));
}

/// Of a cosine, which may be a bit too large, in radians within 0.012.
CW2_INLINE Lanes arc_cosine(const Lanes& number) {
    const Lanes low = number < -kOne ? Lanes{} - kOne : number;
    const Lanes cosine = low > kOne ? Lanes{} + kOne : low;
    const Lanes square = cosine * cosine >> kBits;
    const Lanes series =
        fixed(1.05023) - (square * (fixed(0.16998) - (square * fixed(0.52382) >> kBits)) >> kBits);
    return larger(fixed(1.570796) - (cosine * series >> kBits), Lanes{});
}

/// An edge of each of some triangles, in positions and UVs.
struct Edges {
    Vectors xyz;
    Lanes u, v;
};

CW2_INLINE Edges edges_between(const std::uint16_t* indices, std::size_t from, std::size_t to,
                               const Place* places) {
    using SignedRow = std::int16_t __attribute__((vector_size(16)));
    std::array<Row, kRowNumbers> rows;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
        rows[lane] = places[indices[3 * lane + to]] - places[indices[3 * lane + from]];
    transpose(rows);
    const auto widened = [&](std::size_t k) __attribute__((always_inline)) {
        return __builtin_convertvector(reinterpret_cast<SignedRow>(rows[k]), Lanes);
    };
    return {{widened(0), widened(1), widened(2)}, widened(3), widened(4)};
}

/// The four numbers of each lane.
CW2_INLINE std::array<Four, kLanes> by_lane(const Vectors& xyz, const Lanes& w) {
    const Lanes xy0 = __builtin_shufflevector(xyz.x, xyz.y, 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes zw0 = __builtin_shufflevector(xyz.z, w, 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes xy2 = __builtin_shufflevector(xyz.x, xyz.y, 2, 10, 3, 11, 6, 14, 7, 15);
    const Lanes zw2 = __builtin_shufflevector(xyz.z, w, 2, 10, 3, 11, 6, 14, 7, 15);
    return {__builtin_shufflevector(xy0, zw0, 0, 1, 8, 9),
            __builtin_shufflevector(xy0, zw0, 2, 3, 10, 11),
            __builtin_shufflevector(xy2, zw2, 0, 1, 8, 9),
            __builtin_shufflevector(xy2, zw2, 2, 3, 10, 11),
            __builtin_shufflevector(xy0, zw0, 4, 5, 12, 13),
            __builtin_shufflevector(xy0, zw0, 6, 7, 14, 15),
            __builtin_shufflevector(xy2, zw2, 4, 5, 12, 13),
            __builtin_shufflevector(xy2, zw2, 6, 7, 14, 15)};
}

/// Of kLanes triangles the first `count`.
template <bool kHasUvs>
CW2_INLINE void add_by_angle(const std::uint16_t* indices, std::size_t count, const Place* places,
                             Sum* sums) {
    const Edges e = edges_between(indices, 0, 1, places);
    const Edges f = edges_between(indices, 0, 2, places);
    const Edges g = edges_between(indices, 1, 2, places);
    const auto unit = [&](const Vectors& v) __attribute__((always_inline)) {
        return nearly_unit(shortened(v, size(v)));
    };
    const Vectors along_e = unit(e.xyz), along_f = unit(f.xyz), along_g = unit(g.xyz);
    const Lanes angles[] = {arc_cosine(dot(along_e, along_f) >> kBits),
                            arc_cosine(-dot(along_e, along_g) >> kBits),
                            arc_cosine(dot(along_f, along_g) >> kBits)};
    const std::array<Four, kLanes> normals =
        by_lane(unit({wrapped_winding(e.xyz.y, f.xyz.z, e.xyz.z, f.xyz.y),
                      wrapped_winding(e.xyz.z, f.xyz.x, e.xyz.x, f.xyz.z),
                      wrapped_winding(e.xyz.x, f.xyz.y, e.xyz.y, f.xyz.x)}),
                Lanes{});
    std::array<Four, kLanes> tangents{};
    if constexpr (kHasUvs) {
        const Lanes area = wrapped_winding(f.u, e.v, e.u, f.v);
        const Lanes sign = area >> 31;
        const auto along_u = [&](const Lanes& a, const Lanes& b) __attribute__((always_inline)) {
            const Lanes part = wrapped_winding(b, e.v, a, f.v);
            return reinterpret_cast<Lanes>(reinterpret_cast<UnsignedLanes>(part ^ sign) -
                                           reinterpret_cast<UnsignedLanes>(sign));
        };
        tangents = by_lane(
            unit({along_u(e.xyz.x, f.xyz.x), along_u(e.xyz.y, f.xyz.y), along_u(e.xyz.z, f.xyz.z)}),
            ((area < 0) - (area > 0)) * kOne);
    }
    for (std::size_t lane = 0; lane < count; ++lane) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t corner = indices[3 * lane + k];
            const Four normal = normals[lane] * angles[k][lane] >> kBits;
            if constexpr (!kHasUvs) {
                add(&sums[corner], reinterpret_cast<UnsignedFour>(normal));
            } else {
                const Four tangent = tangents[lane] * angles[k][lane] >> kBits;
                add(&sums[2 * corner], reinterpret_cast<UnsignedEight>(__builtin_shufflevector(
                                           normal, tangent, 0, 1, 2, 3, 4, 5, 6, 7)));
            }
        }
    }
}

template <bool kHasUvs>
CW2_INLINE void sum_by_angle(std::span<const std::uint16_t> indices, const Place* places,
                             Sum* sums) {
    constexpr std::size_t kStep = 3 * kLanes;
    std::size_t i = 0;
    for (; i + kStep <= indices.size(); i += kStep)
        add_by_angle<kHasUvs>(&indices[i], kLanes, places, sums);
    if (i == indices.size()) return;
    std::array<std::uint16_t, kStep> rest{};
    std::ranges::copy(indices.subspan(i), rest.begin());
    add_by_angle<kHasUvs>(rest.data(), (indices.size() - i) / 3, places, sums);
}

/// 2^30 / number, of numbers from 2^14 to 2^16.
CW2_INLINE Lanes inverse(const Lanes& number) {
    const Lanes x = number >> 2;
    // Chebyshev fit of 1 / x, within 2.5 %, then Newton's steps.
    Lanes y = fixed(6.242) - (x * fixed(2.4968) >> kBits);
    y = fixed(5.50076) - (x * y >> kBits);
    y = 4 * (fixed(1.99939) - (x * y >> kBits));
    for (int step = 0; step < 2; ++step) y = y * (2 * kOne - (number * y >> 16)) >> kBits;
    return y;
}

CW2_INLINE Lanes wrapped_product(const Lanes& a, const Lanes& b) {
    return reinterpret_cast<Lanes>(reinterpret_cast<UnsignedLanes>(a) *
                                   reinterpret_cast<UnsignedLanes>(b));
}

/// Of a ratio of at most 1 the angle in units of 45 degrees / 16,383, within 2.
CW2_INLINE Lanes angle_of(const Lanes& ratio) {
    const Lanes square = ratio * ratio >> kBits;
    const Lanes y = 3051 - (square * 813 >> kBits);
    const Lanes series = 6700 - (square * y >> kBits);
    return ratio * (20'843 - (square * series >> kBits)) >> kBits;
}

struct VectorsAndNumbers {
    Vectors xyz;
    Lanes w;
};

/// The first numbers of all lanes, the second, ... Registers' halves are shuffled each by itself,
/// which is faster.
template <std::size_t kStride>
CW2_INLINE VectorsAndNumbers by_number(const Sum* sums) {
    std::array<Four, kLanes> in;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
        std::memcpy(&in[lane], &sums[kStride * lane], sizeof(Four));
    std::array<Lanes, 4> pairs;
    for (std::size_t k = 0; k < 4; ++k)
        pairs[k] = __builtin_shufflevector(in[k], in[k + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    const Lanes xy0 = __builtin_shufflevector(pairs[0], pairs[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes zw0 = __builtin_shufflevector(pairs[0], pairs[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Lanes xy2 = __builtin_shufflevector(pairs[2], pairs[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes zw2 = __builtin_shufflevector(pairs[2], pairs[3], 2, 10, 3, 11, 6, 14, 7, 15);
    return {{__builtin_shufflevector(xy0, xy2, 0, 1, 8, 9, 4, 5, 12, 13),
             __builtin_shufflevector(xy0, xy2, 2, 3, 10, 11, 6, 7, 14, 15),
             __builtin_shufflevector(zw0, zw2, 0, 1, 8, 9, 4, 5, 12, 13)},
            __builtin_shufflevector(zw0, zw2, 2, 3, 10, 11, 6, 7, 14, 15)};
}

/// Frames on the way from surfaces to quaternions.
struct Frames {
    Vectors n, t;
    Lanes is_left;                ///< -1 where left-handed, else 0
    Lanes largest;                ///< the number of the quaternion's largest component
    Lanes best;                   ///< four times its square
    std::array<Lanes, 3> others;  ///< four times it times the others, in their order
    std::array<Lanes, 3> angles;  ///< of the others
};

template <bool kHasUvs>
CW2_INLINE void load(const Sum* sums, Frames& frames) {
    constexpr std::size_t kStride = kHasUvs ? 2 : 1;
    const VectorsAndNumbers normal = by_number<kStride>(sums);
    frames.n = shortened(normal.xyz, size(normal.xyz));
    if constexpr (kHasUvs) {
        const VectorsAndNumbers tangent = by_number<kStride>(sums + 1);
        const Lanes tangent_size = size(tangent.xyz);
        frames.t = shortened(tangent.xyz, tangent_size);
        frames.t.x = tangent_size == 0 ? Lanes{} + kOne : frames.t.x;
        frames.is_left = tangent.w < 0;
    } else {
        frames.t = {Lanes{} + kOne, Lanes{}, Lanes{}};
        frames.is_left = Lanes{};
    }
}

CW2_INLINE void make_orthogonal(Frames& frames) {
    const Lanes along = dot(frames.t, frames.n) >> kBits;
    frames.t = difference(frames.t, shifted(product(frames.n, along), Lanes{} + kBits));
}

/// Every row of 4 q q^T is a multiple of q, see frame_rotation.h; this takes the largest one.
CW2_INLINE void choose_row(Frames& frames) {
    const Vectors& n = frames.n;
    const Vectors& t = frames.t;
    const Vectors b = shifted(cross(n, t), Lanes{} + kBits);
    const Lanes xy = t.y + b.x, xz = t.z + n.x, yz = b.z + n.y;
    const Lanes xw = b.z - n.y, yw = n.x - t.z, zw = t.y - b.x;
    Lanes best = kOne + t.x - b.y - n.z;
    Lanes largest{};
    std::array<Lanes, 3> others{xy, xz, xw};
    const auto choose = [&](int number, const Lanes& square, const std::array<Lanes, 3>& own) {
        const Lanes is_larger = square > best;
        best = is_larger ? square : best;
        largest = is_larger ? Lanes{} + number : largest;
        for (std::size_t k = 0; k < 3; ++k) others[k] = is_larger ? own[k] : others[k];
    };
    choose(1, kOne - t.x + b.y - n.z, {xy, yz, yw});
    choose(2, kOne - t.x - b.y + n.z, {xz, yz, zw});
    choose(3, kOne + t.x + b.y + n.z, {xw, yw, zw});
    frames.best = best;
    frames.largest = largest;
    frames.others = others;
}

CW2_INLINE void set_angles(Frames& frames) {
    const Lanes factor = inverse(frames.best);
    // Where next to nothing is left of a tangent it may be along the normal; then this is any
    // number.
    for (std::size_t k = 0; k < 3; ++k)
        frames.angles[k] = angle_of(wrapped_product(frames.others[k], factor) >> 16);
}

using Groups = std::array<Frames, kFrameLanes / kLanes>;

/// Step by step for all groups: a step waits for the one before, and another group's need not.
template <bool kHasUvs>
CW2_INLINE void set_quaternions(const Sum* sums, Groups& groups) {
    for (Frames& each : groups) {
        load<kHasUvs>(sums, each);
        sums += (kHasUvs ? 2 : 1) * kLanes;
    }
    for (Frames& each : groups) each.n = nearly_unit(each.n);
    for (Frames& each : groups) make_orthogonal(each);
    for (Frames& each : groups) each.t = nearly_unit(each.t);
    for (Frames& each : groups) choose_row(each);
    for (Frames& each : groups) set_angles(each);
}

CW2_INLINE Row narrowed(const Lanes& lanes) {
    return __builtin_convertvector(lanes, Row);
}

template <bool kHasUvs>
CW2_INLINE void set_words(const Sum* sums, std::array<Words, 3>& words) {
    Groups groups;
    set_quaternions<kHasUvs>(sums, groups);
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const Frames& frames = groups[i];
        const Lanes bits[] = {frames.is_left, frames.largest, frames.largest >> 1};
        for (std::size_t k = 0; k < 3; ++k)
            words[k][i] = narrowed(frames.angles[k] + 16'383 + (bits[k] << 15));
    }
}

template <bool kHasUvs>
CW2_INLINE void set_codes(const Sum* sums, std::array<std::uint32_t, kFrameLanes>& codes) {
    Groups groups;
    set_quaternions<kHasUvs>(sums, groups);
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const Frames& frames = groups[i];
        auto code = reinterpret_cast<UnsignedLanes>(frames.largest - 4 * frames.is_left);
        for (std::size_t k = 3; k-- > 0;) {
            const Lanes digit = ((frames.angles[k] * 405 + kOne / 2) >> kBits) + 405;
            code = code * 811 + reinterpret_cast<UnsignedLanes>(digit);
        }
        std::memcpy(&codes[i * kLanes], &code, sizeof code);
    }
}

/// The largest magnitude of what triangles add, to the number of bits that have to go so that 24
/// are left.
int fitting_shift(uint64_t size) {
    constexpr int kBitsOfOne = 24;
    return std::clamp(static_cast<int>(std::bit_width(size)) - kBitsOfOne, 0, kMaxSurfaceShift);
}

}  // namespace

CW2_EVERY_CPU void sum_surfaces(std::span<const std::uint16_t> indices, const Place* places,
                                const SurfaceModel& model, std::span<Sum> sums) {
    std::ranges::fill(sums, Sum{});
    if (model.by_angle && model.has_uvs)
        sum_by_angle<true>(indices, places, sums.data());
    else if (model.by_angle)
        sum_by_angle<false>(indices, places, sums.data());
    else if (model.has_uvs)
        sum_all<true>(indices, places, model, sums.data());
    else
        sum_all<false>(indices, places, model, sums.data());
}

SurfaceModel fitting_model(std::span<const std::uint16_t> indices, const Place* places,
                           bool has_uvs) {
    uint64_t normal = 0;
    uint64_t tangent = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const Place& a = places[indices[i]];
        const auto edge = [&](std::size_t corner, std::size_t k) {
            return static_cast<std::int16_t>(places[indices[i + corner]][k] - a[k]);
        };
        const auto winding = [&](std::size_t k, std::size_t l) {
            return std::abs(int64_t{edge(1, k)} * edge(2, l) - int64_t{edge(1, l)} * edge(2, k));
        };
        for (std::size_t k = 0; k < 3; ++k)
            normal |= static_cast<uint64_t>(winding(k, (k + 1) % 3));
        for (std::size_t k = 0; k < 4; ++k) tangent |= static_cast<uint64_t>(winding(k, 4));
    }
    return {has_uvs, false, fitting_shift(normal), fitting_shift(tangent)};
}

CW2_EVERY_CPU void expect_quat48(const Sum* sums, bool has_uvs, std::array<Words, 3>& words) {
    if (has_uvs)
        set_words<true>(sums, words);
    else
        set_words<false>(sums, words);
}

CW2_EVERY_CPU void expect_quat32(const Sum* sums, bool has_uvs,
                                 std::array<std::uint32_t, kFrameLanes>& codes) {
    if (has_uvs)
        set_codes<true>(sums, codes);
    else
        set_codes<false>(sums, codes);
}

}  // namespace mesh_format
