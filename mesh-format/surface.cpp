#include "mesh-format/surface.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "common/every_cpu.h"

// How vectors of 32 bytes are handed over depends on the processor; all that take them are inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace mesh_format {

namespace {

using std::int32_t;
using std::int64_t;
using std::uint64_t;

constexpr std::size_t kLanes = 8;
using Lanes = int32_t __attribute__((vector_size(4 * kLanes)));
using Numbers = std::array<int32_t, kLanes>;
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

/// Has the bits of a number, or of that above it if that is below 0.
CW2_INLINE Lanes magnitude(const Lanes& a) {
    return a ^ a >> 31;
}
/// Has all bits that a component has.
CW2_INLINE Lanes size(const Vectors& a) {
    return magnitude(a.x) | magnitude(a.y) | magnitude(a.z);
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
CW2_INLINE Vectors shifted(const Vectors& a, int bits) {
    return {a.x >> bits, a.y >> bits, a.z >> bits};
}

/// Of any components; then they are of 14 bits.
CW2_INLINE Vectors shortened(const Vectors& a) {
    Lanes rest = size(a);
    Lanes bits{};
    for (const int step : {8, 8, 4, 2, 1}) {
        const Lanes longer = rest >= (1 << (kBits + step - 1));
        rest = longer ? rest >> step : rest;
        bits += longer & step;
    }
    return shifted(a, bits);
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
    Lanes square = dot(a, a) | 1;
    Lanes bits{};
    for (const int step : {16, 8, 4, 2}) {
        const Lanes shorter = square < (1 << (30 - step));
        square = shorter ? square << step : square;
        bits += shorter & (step / 2);
    }
    return shifted(product(a, inverse_root(square)), 15 - bits);
}

/// Of length kOne, but for rounding.
CW2_INLINE Vectors unit(const Vectors& a) {
    const Vectors u = nearly_unit(a);
    const Lanes factor = 3 * kOne - (dot(u, u) >> kBits);  // Newton's step again
    return shifted(product(u, factor), kBits + 1);
}

/// Of a cosine, in radians within 0.012.
CW2_INLINE Lanes angle_of(const Lanes& cosine) {
    const Lanes square = cosine * cosine >> kBits;
    const Lanes series =
        fixed(1.05023) - (square * (fixed(0.16998) - (square * fixed(0.52382) >> kBits)) >> kBits);
    const Lanes angle = fixed(1.570796) - (cosine * series >> kBits);
    return angle < 0 ? Lanes{} : angle;
}

/// The corners of some triangles.
struct Corners {
    std::array<Vectors, 3> positions;
    std::array<Lanes, 3> u, v;
};

CW2_INLINE Lanes widened(const Row& row) {
    return __builtin_convertvector(row, Lanes);
}

CW2_INLINE Corners gather(const std::uint16_t* indices, const Row* vertices) {
    Corners result;
    for (std::size_t k = 0; k < 3; ++k) {
        std::array<Row, kRowNumbers> rows;
        for (std::size_t lane = 0; lane < kLanes; ++lane)
            rows[lane] = vertices[indices[3 * lane + k]];
        transpose(rows);
        result.positions[k] = {widened(rows[0]), widened(rows[1]), widened(rows[2])};
        result.u[k] = widened(rows[kFirstUv]);
        result.v[k] = widened(rows[kFirstUv + 1]);
    }
    return result;
}

/// What triangles add to the sums of their corners.
struct Parts {
    Vectors normal;  ///< by area; else of length kOne, to be weighted
    std::array<Lanes, 3> angles;
    Vectors tangent;  ///< of length kOne, to be weighted
    Lanes mirrored;   ///< kOne or -kOne, or 0 where UVs tell nothing; to be weighted
};

/// Edges go from corner 1 to 2, from 2 to 0, from 0 to 1.
CW2_INLINE std::array<Lanes, 3> angles_at(const std::array<Vectors, 3>& edges) {
    std::array<Vectors, 3> units;
    for (std::size_t k = 0; k < 3; ++k) units[k] = nearly_unit(edges[k]);
    std::array<Lanes, 3> angles;
    for (std::size_t k = 0; k < 3; ++k) {
        Lanes cosine = -(dot(units[(k + 1) % 3], units[(k + 2) % 3]) >> kBits);
        cosine = cosine > kOne ? Lanes{} + kOne : cosine;
        cosine = cosine < -kOne ? Lanes{} - kOne : cosine;
        angles[k] = angle_of(cosine);
    }
    return angles;
}

CW2_INLINE Lanes range(const std::array<Lanes, 3>& a) {
    const Lanes low = a[0] < a[1] ? a[0] : a[1];
    const Lanes high = a[0] < a[1] ? a[1] : a[0];
    return (high < a[2] ? a[2] : high) - (low < a[2] ? low : a[2]);
}

/// How many bits numbers of 16 bits with these ranges have to lose so that those have 14. Numbers
/// lose them, not differences: so it does not matter at which corner a triangle starts.
CW2_INLINE Lanes excess(const Lanes& ranges) {
    return -((ranges >= (1 << 14)) + (ranges >= (1 << 15)));
}

/// Of the derivatives of position by UV the one along u: the edges' combination of no v.
CW2_INLINE void set_tangent(const Corners& corners, const std::array<Vectors, 3>& edges,
                            Parts& out) {
    const Lanes bits = excess(range(corners.u) | range(corners.v));
    const Lanes u0 = corners.u[0] >> bits, v0 = corners.v[0] >> bits;
    const Lanes u1 = (corners.u[1] >> bits) - u0, v1 = (corners.v[1] >> bits) - v0;
    const Lanes u2 = (corners.u[2] >> bits) - u0, v2 = (corners.v[2] >> bits) - v0;
    const Lanes winding = u1 * v2 - u2 * v1;
    const Lanes sign = (winding < 0) - (winding > 0);
    const Vectors a = product(edges[2], v2);
    const Vectors b = product(edges[1], v1);
    const Vectors along_u{a.x + b.x, a.y + b.y, a.z + b.z};
    out.tangent = nearly_unit(shortened(product(along_u, sign)));
    out.mirrored = sign * kOne;
}

template <bool kByAngle, bool kHasUvs>
CW2_INLINE void compute(const Corners& corners, int area_shift, Parts& out) {
    const auto& p = corners.positions;
    const Lanes bits = excess(range({p[0].x, p[1].x, p[2].x}) | range({p[0].y, p[1].y, p[2].y}) |
                              range({p[0].z, p[1].z, p[2].z}));
    std::array<Vectors, 3> edges;
    for (std::size_t k = 0; k < 3; ++k)
        edges[k] = difference(shifted(p[(k + 2) % 3], bits), shifted(p[(k + 1) % 3], bits));
    const Vectors normal = cross(edges[1], edges[2]);
    if constexpr (kByAngle) {
        out.normal = nearly_unit(shortened(normal));
    } else {
        const Lanes down = area_shift - 2 * bits;
        const Lanes up = down < 0 ? -down : Lanes{};
        const Vectors least = shifted(normal, down < 0 ? Lanes{} : down);
        out.normal = {least.x << up, least.y << up, least.z << up};
    }
    if constexpr (kByAngle || kHasUvs) out.angles = angles_at(edges);
    if constexpr (kHasUvs) set_tangent(corners, edges, out);
}

using Four = int32_t __attribute__((vector_size(16)));

/// The four numbers of each lane. Registers' halves are shuffled each by itself, which is faster.
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

struct VectorsAndNumbers {
    Vectors xyz;
    Lanes w;
};

/// The other way.
CW2_INLINE VectorsAndNumbers by_number(const std::array<Four, kLanes>& in) {
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

CW2_INLINE void add(std::array<int32_t, 4>& sum, const Four& part) {
    using Unsigned = std::uint32_t __attribute__((vector_size(16)));
    Unsigned lanes;
    std::memcpy(&lanes, &sum, sizeof lanes);
    lanes += reinterpret_cast<Unsigned>(part);
    std::memcpy(&sum, &lanes, sizeof lanes);
}

template <bool kByAngle, bool kHasUvs>
CW2_INLINE void scatter(const Parts& parts, const std::uint16_t* indices, std::size_t count,
                        Surface* surfaces) {
    const std::array<Four, kLanes> normals = by_lane(parts.normal, Lanes{});
    const std::array<Four, kLanes> tangents = by_lane(parts.tangent, parts.mirrored);
    for (std::size_t lane = 0; lane < count; ++lane) {
        for (std::size_t k = 0; k < 3; ++k) {
            Surface& surface = surfaces[indices[3 * lane + k]];
            const int32_t angle = parts.angles[k][lane];
            add(surface.normal, kByAngle ? normals[lane] * angle >> kBits : normals[lane]);
            if constexpr (kHasUvs) add(surface.tangent, tangents[lane] * angle >> kBits);
        }
    }
}

template <bool kByAngle, bool kHasUvs>
CW2_INLINE void sum_all(std::span<const std::uint16_t> indices, const Row* vertices, int area_shift,
                        Surface* surfaces) {
    constexpr std::size_t kStep = 3 * kLanes;
    Parts parts{};
    std::size_t i = 0;
    for (; i + kStep <= indices.size(); i += kStep) {
        compute<kByAngle, kHasUvs>(gather(&indices[i], vertices), area_shift, parts);
        scatter<kByAngle, kHasUvs>(parts, &indices[i], kLanes, surfaces);
    }
    std::array<std::uint16_t, kStep> rest{};
    std::copy(indices.begin() + static_cast<std::ptrdiff_t>(i), indices.end(), rest.begin());
    compute<kByAngle, kHasUvs>(gather(rest.data(), vertices), area_shift, parts);
    scatter<kByAngle, kHasUvs>(parts, rest.data(), (indices.size() - i) / 3, surfaces);
}

CW2_INLINE void put(const Lanes& lanes, Numbers& out) {
    std::memcpy(&out, &lanes, sizeof lanes);
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

}  // namespace

CW2_EVERY_CPU void sum_surfaces(std::span<const std::uint16_t> indices, const Row* vertices,
                                const SurfaceModel& model, std::span<Surface> surfaces) {
    std::ranges::fill(surfaces, Surface{});
    const auto [by_angle, has_uvs, shift] = model;
    if (by_angle && has_uvs)
        sum_all<true, true>(indices, vertices, shift, surfaces.data());
    else if (by_angle)
        sum_all<true, false>(indices, vertices, shift, surfaces.data());
    else if (has_uvs)
        sum_all<false, true>(indices, vertices, shift, surfaces.data());
    else
        sum_all<false, false>(indices, vertices, shift, surfaces.data());
}

int fitting_area_shift(std::span<const std::uint16_t> indices, const Row* vertices) {
    constexpr int kBitsOfOne = 24;
    uint64_t size = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const Row& a = vertices[indices[i]];
        const Row& b = vertices[indices[i + 1]];
        const Row& c = vertices[indices[i + 2]];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t next = (axis + 1) % 3;
            const auto edge = [&](const Row& to, std::size_t k) { return int64_t{to[k]} - a[k]; };
            const int64_t area = edge(b, axis) * edge(c, next) - edge(b, next) * edge(c, axis);
            size |= static_cast<uint64_t>(area < 0 ? -area : area);
        }
    }
    return std::clamp(static_cast<int>(std::bit_width(size)) - kBitsOfOne, 0, kMaxAreaShift);
}

CW2_EVERY_CPU void rotations_of(const Surface* surfaces, Rotations& rotations) {
    std::array<Four, kLanes> normals;
    std::array<Four, kLanes> tangents;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        std::memcpy(&normals[lane], &surfaces[lane].normal, sizeof(Four));
        std::memcpy(&tangents[lane], &surfaces[lane].tangent, sizeof(Four));
    }
    const Vectors n = unit(shortened(by_number(normals).xyz));
    auto [t, mirrored] = by_number(tangents);
    t.x = size(t) == 0 ? Lanes{} + kOne : t.x;
    t = nearly_unit(shortened(t));
    t = unit(shortened(difference(t, shifted(product(n, dot(t, n) >> kBits), kBits))));
    const Vectors b = shifted(cross(n, t), kBits);
    // Every row of 4 q q^T is a multiple of q, see frame_rotation.h.
    const Lanes xy = t.y + b.x, xz = t.z + n.x, yz = b.z + n.y;
    const Lanes xw = b.z - n.y, yw = n.x - t.z, zw = t.y - b.x;
    const Vectors diagonal{t.x - b.y - n.z, b.y - n.z - t.x, n.z - t.x - b.y};
    Lanes best = kOne + diagonal.x;
    Lanes largest{};
    std::array<Lanes, 4> row{best, xy, xz, xw};
    const auto choose = [&](int number, const Lanes& square, const std::array<Lanes, 4>& own) {
        const Lanes is_larger = square > best;
        best = is_larger ? square : best;
        largest = is_larger ? Lanes{} + number : largest;
        for (std::size_t k = 0; k < 4; ++k) row[k] = is_larger ? own[k] : row[k];
    };
    const Lanes yy = kOne + diagonal.y, zz = kOne + diagonal.z, ww = kOne + t.x + b.y + n.z;
    choose(1, yy, {xy, yy, yz, yw});
    choose(2, zz, {xz, yz, zz, zw});
    choose(3, ww, {xw, yw, zw, ww});
    const Lanes factor = inverse(best);
    for (std::size_t k = 0; k < 4; ++k) {
        Lanes ratio = row[k] * factor >> 15;
        ratio = ratio > 32'768 ? Lanes{} + 32'768 : ratio;
        ratio = ratio < -32'768 ? Lanes{} - 32'768 : ratio;
        put(ratio, rotations.components[k]);
    }
    put(mirrored > 0 ? largest + 4 : largest, rotations.tops);
}

}  // namespace mesh_format
