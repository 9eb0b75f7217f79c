#include "mesh-format/tangent_frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "common/every_cpu.h"
#include "mesh-format/frame_constants.h"
#include "mesh-format/frame_rotation.h"

namespace mesh_format {
namespace {

static_assert(kFrameQuat48 == static_cast<int>(FrameForm::quat48) &&
              kFrameQuat32 == static_cast<int>(FrameForm::quat32) &&
              kFrameHalf3 == static_cast<int>(FrameForm::half3) &&
              kFrameF32 == static_cast<int>(FrameForm::f32));

struct Vec3 {
    double x, y, z;
};

double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vec3 wide(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// A rotation as a quaternion x, y, z, w that is scaled so that its largest component is 1.
using Quaternion = std::array<double, 4>;

Quaternion quaternion_of(const TangentFrame& frame) {
    Rotations<1> rotation;
    rotation.load(0, frame);
    rotation.compute();
    const auto largest = static_cast<std::size_t>(rotation.largest[0]);
    Quaternion q{};
    q[largest] = 1;
    for (std::size_t k = 0; k < 3; ++k) q[k + (k >= largest)] = rotation.ratio[k][0];
    return q;
}

/// The rotation matrix of a quaternion of any length but 0. Dividing by the squared length instead
/// of normalising first keeps quaternions of small integers, hence the axis frames, exact.
/// shaders/tangent_frame.glsl repeats this operation by operation.
TangentFrame frame_of(float x, float y, float z, float w, bool left_handed) {
    const float s = 2.0f / (x * x + y * y + z * z + w * w);
    return {{1.0f - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
            {s * (x * z + w * y), s * (y * z - w * x), 1.0f - s * (x * x + y * y)},
            left_handed ? -1.0f : 1.0f};
}

// --- quat48 and quat32: the largest component dropped, its ratios to the others warped -----------

using Digits = std::array<std::uint32_t, 3>;

/// atan(x) / (pi / 4) for |x| <= 1, in the shape of tan_quarter_pi; within 2.3e-7.
CW2_INLINE float warped(float x) {
    const float y = x * x;
    float p = 0.00438045943f;
    p = p * y - 0.0206893347f;
    p = p * y + 0.0466871634f;
    p = p * y - 0.0735261068f;
    p = p * y + 0.102728099f;
    p = p * y - 0.151129022f;
    p = p * y + 0.273239106f;
    return x * (1.0f + (1.0f - y) * p);
}

CW2_INLINE float tan_quarter_pi(float x) {
    const float y = x * x;
    const float q = ((((kTanQ5 * y + kTanQ4) * y + kTanQ3) * y + kTanQ2) * y + kTanQ1) * y + kTanQ0;
    return x * (1.0f - (1.0f - y) * q);
}

/// What a digit stands for.
float ratio_of(std::uint32_t digit, int half, float inverse_half) {
    return tan_quarter_pi(static_cast<float>(static_cast<int>(digit) - half) * inverse_half);
}

TangentFrame frame_of_digits(const Digits& digits, int half, float inverse_half,
                             std::uint32_t largest, bool left_handed) {
    float q[4];
    for (unsigned i = 0, k = 0; i < 4; ++i) {
        q[i] = i == largest ? 1.0f : ratio_of(digits[k++], half, inverse_half);
    }
    return frame_of(q[0], q[1], q[2], q[3], left_handed);
}

/// Frames in digits, kLanes at a time, and how far they are from what they stand for.
template <std::size_t kLanes>
struct DigitLanes {
    Rotations<kLanes> rotations;
    std::int32_t digits[3][kLanes];
    double degrees[kLanes];

    CW2_INLINE void compute(int half, float inverse_half) {
        rotations.compute();
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t i = 0; i < kLanes; ++i) {
                const auto ratio = static_cast<float>(rotations.ratio[k][i]);
                const double level = static_cast<double>(warped(ratio)) * half;
                // Truncating a positive number plus one half rounds to nearest.
                digits[k][i] = static_cast<std::int32_t>(level + (half + 0.5));
                decoded_[k][i] =
                    tan_quarter_pi(static_cast<float>(digits[k][i] - half) * inverse_half);
            }
        }
        measure();
    }

    Digits of(std::size_t i) const {
        return {static_cast<std::uint32_t>(digits[0][i]), static_cast<std::uint32_t>(digits[1][i]),
                static_cast<std::uint32_t>(digits[2][i])};
    }

 private:
    /// With a and b the quaternions, |a|^2 |b|^2 sin^2(angle / 2) = |a|^2 |b|^2 - (a . b)^2, which
    /// is the sum over pairs of components of (a_i b_j - a_j b_i)^2: of small terms only.
    CW2_INLINE void measure() {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double a0 = rotations.ratio[0][i], b0 = decoded_[0][i];
            const double a1 = rotations.ratio[1][i], b1 = decoded_[1][i];
            const double a2 = rotations.ratio[2][i], b2 = decoded_[2][i];
            const double square_a = 1 + a0 * a0 + a1 * a1 + a2 * a2;
            const double square_b = 1 + b0 * b0 + b1 * b1 + b2 * b2;
            const double c01 = a0 * b1 - a1 * b0;
            const double c02 = a0 * b2 - a2 * b0;
            const double c12 = a1 * b2 - a2 * b1;
            const double square_cross = (a0 - b0) * (a0 - b0) + (a1 - b1) * (a1 - b1) +
                                        (a2 - b2) * (a2 - b2) + c01 * c01 + c02 * c02 + c12 * c12;
            const double sine = std::sqrt(square_cross / (square_a * square_b));
            // The codes are so close that the series' next term is below 1e-12 of the angle.
            degrees[i] = 2 * (sine + sine * sine * sine / 6) * (180 / std::numbers::pi);
        }
    }

    float decoded_[3][kLanes];
};

constexpr std::size_t kManyLanes = 16;

void compute(DigitLanes<1>& lanes, int half, float inverse_half) {
    lanes.compute(half, inverse_half);
}

CW2_EVERY_CPU void compute(DigitLanes<kManyLanes>& lanes, int half, float inverse_half) {
    lanes.compute(half, inverse_half);
}

using Words = std::array<std::uint16_t, 3>;

constexpr std::size_t kQuat48Bytes = 6;

/// In the lower 48 bits.
std::uint64_t quat48_of(const Digits& digits, std::uint32_t largest, bool left_handed) {
    const std::uint64_t first = digits[0] | std::uint32_t{left_handed} << 15;
    const std::uint64_t second = digits[1] | (largest & 1) << 15;
    const std::uint64_t third = digits[2] | (largest >> 1) << 15;
    return first | second << 16 | third << 32;
}

TangentFrame unpack_quat48(const Words& words) {
    Digits digits{};
    for (int i = 0; i < 3; ++i) {
        digits[i] = std::min<std::uint32_t>(words[i] & 0x7FFFu, kQuat48DigitMax);
    }
    const std::uint32_t largest = words[1] >> 15 | words[2] >> 15 << 1;
    return frame_of_digits(digits, kQuat48DigitMax / 2, kQuat48InverseHalf, largest,
                           words[0] >> 15 != 0);
}

std::uint32_t quat32_of(const Digits& digits, std::uint32_t largest, bool left_handed) {
    std::uint32_t code = left_handed * 4u + largest;
    for (int i = 2; i >= 0; --i) code = code * kQuat32Base + digits[i];
    return code;
}

TangentFrame unpack_quat32(std::uint32_t code) {
    Digits digits{};
    for (std::uint32_t& digit : digits) {
        digit = code % kQuat32Base;
        code /= kQuat32Base;
    }
    return frame_of_digits(digits, kQuat32Base / 2, kQuat32InverseHalf, code & 3, (code & 4) != 0);
}

// --- half3: x, y and z of the unit quaternion with w >= 0 ----------------------------------------

constexpr std::uint16_t kSpareBit = 0x4000;  // clear in every half of magnitude below 2

/// The half nearest to `value` in [0, 1].
std::uint16_t half_of(double value) {
    const auto narrow = static_cast<float>(value);
    if (narrow < 0x1p-14f) return static_cast<std::uint16_t>(std::lrint(narrow * 0x1p24f));
    const auto bits = std::bit_cast<std::uint32_t>(narrow);
    return static_cast<std::uint16_t>(((bits + 0xFFF + (bits >> 13 & 1)) >> 13) - (112u << 10));
}

float float_of_half(std::uint16_t half) {
    const std::uint32_t magnitude = half & 0x3FFFu;
    const float value = magnitude < 0x400 ? static_cast<float>(magnitude) * 0x1p-24f
                                          : std::bit_cast<float>((magnitude << 13) + (112u << 23));
    return half & 0x8000 ? -value : value;
}

/// Of the eight codes around `v`, three magnitudes of a unit vector, the one whose half turn is
/// nearest. Rounding each component may leave the code inside the unit sphere, and the decoder
/// would make up the missing length with a w of up to 0.03.
Words nearest_half_turn(const std::array<double, 3>& v) {
    // A code that is longer by less than this lies among the eight around its own direction, so
    // packing what it decodes to finds it again.
    constexpr double kLongest = 1 + 0x1p-11;
    Words below{};
    for (int i = 0; i < 3; ++i) {
        below[i] = half_of(v[i]);
        if (float_of_half(below[i]) > v[i]) --below[i];
    }
    Words best{};
    double best_distance = 8;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Words code = below;
        float c[3];
        for (unsigned i = 0; i < 3; ++i) {
            if (corner >> i & 1 && float_of_half(below[i]) < v[i]) ++code[i];
            c[i] = float_of_half(code[i]);
        }
        const float squared = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
        const double length = std::sqrt(std::max(1.0, double{squared}));
        double distance = std::max(0.0f, 1 - squared);  // the decoder's w, squared
        for (int i = 0; i < 3; ++i) {
            distance += (c[i] / length - v[i]) * (c[i] / length - v[i]);
        }
        if (length < kLongest && distance < best_distance) {
            best_distance = distance;
            best = code;
        }
    }
    return best;
}

Words pack_half3(const Quaternion& q, bool left_handed) {
    constexpr double kExact = 1e-6;  // what the rounding of the input's floats may amount to
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const std::array<double, 3> v{std::abs(q[0]) / norm, std::abs(q[1]) / norm,
                                  std::abs(q[2]) / norm};
    int ones = 0;
    bool whole = true;
    for (const double component : q) {
        const double nearest = std::round(std::abs(component));
        ones += nearest == 1;
        whole = whole && std::abs(std::abs(component) - nearest) < kExact;
    }

    Words words{};
    if (whole && ones == 2) {
        // A quarter turn about an axis or a half turn between two needs sqrt(1/2), which no half
        // is. Components of 1 say the same; they are too long to leave a w by themselves.
        for (int i = 0; i < 3; ++i) words[i] = half_of(std::round(std::abs(q[i])));
        if (std::abs(q[3]) > 0.5) words[1] |= kSpareBit;
    } else if (std::abs(q[3]) < kExact * norm) {
        words = nearest_half_turn(v);
    } else {
        for (int i = 0; i < 3; ++i) words[i] = half_of(v[i]);
    }
    const double sign = q[3] < 0 ? -1 : 1;
    for (int i = 0; i < 3; ++i) {
        if (q[i] * sign < 0) words[i] |= 0x8000;
    }
    if (left_handed) words[0] |= kSpareBit;
    return words;
}

TangentFrame unpack_half3(const Words& words) {
    const float x = float_of_half(words[0]);
    const float y = float_of_half(words[1]);
    const float z = float_of_half(words[2]);
    const float squared = x * x + y * y + z * z;
    const float w = words[1] & kSpareBit ? 1.0f : std::sqrt(std::max(0.0f, 1.0f - squared));
    return frame_of(x, y, z, w, (words[0] & kSpareBit) != 0);
}

// --- f32: x, y, z, w with w >= 0, the handedness in its sign bit ---------------------------------

using Components = std::array<std::uint32_t, 4>;
constexpr std::uint32_t kSignBit = 0x8000'0000;
constexpr std::uint32_t kOneBits = std::bit_cast<std::uint32_t>(1.0f);

Components pack_f32(const Quaternion& q, bool left_handed) {
    const double sign = q[3] < 0 ? -1 : 1;
    Components bits{};
    for (int i = 0; i < 4; ++i) {
        bits[i] = std::bit_cast<std::uint32_t>(static_cast<float>(q[i] * sign));
    }
    bits[3] = (bits[3] & ~kSignBit) | (left_handed ? kSignBit : 0);
    return bits;
}

TangentFrame unpack_f32(const Components& bits) {
    // Clamping the bits sends infinities and NaN to +-1 as well.
    float q[4];
    for (int i = 0; i < 4; ++i) {
        const std::uint32_t magnitude = std::min(bits[i] & ~kSignBit, kOneBits);
        q[i] = std::bit_cast<float>(magnitude | (i < 3 ? bits[i] & kSignBit : 0));
    }
    // pack_frame writes a squared length of at least 1.
    if (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] < 0.5f) q[3] = 1.0f;
    return frame_of(q[0], q[1], q[2], q[3], (bits[3] & kSignBit) != 0);
}

template <class T>
T read(const std::byte* in) {
    T value;
    std::memcpy(&value, in, sizeof value);
    return value;
}

template <class T>
void write(const T& value, std::byte* out) {
    std::memcpy(out, &value, sizeof value);
}

/// quat48 or quat32 of kLanes frames.
template <std::size_t kLanes>
void pack_digits(FrameForm form, std::span<const TangentFrame> frames, std::byte* out,
                 std::size_t stride, double* degrees) {
    const bool wide = form == FrameForm::quat48;
    DigitLanes<kLanes> lanes;
    for (std::size_t i = 0; i < kLanes; ++i) lanes.rotations.load(i, frames[i]);
    compute(lanes, (wide ? kQuat48DigitMax : kQuat32Base) / 2,
            wide ? kQuat48InverseHalf : kQuat32InverseHalf);
    for (std::size_t i = 0; i < kLanes; ++i, out += stride) {
        const auto largest = static_cast<std::uint32_t>(lanes.rotations.largest[i]);
        const bool left_handed = frames[i].handedness < 0;
        if (wide) {
            const std::uint64_t code = quat48_of(lanes.of(i), largest, left_handed);
            std::memcpy(out, &code, kQuat48Bytes);
        } else {
            write(quat32_of(lanes.of(i), largest, left_handed), out);
        }
        degrees[i] = lanes.degrees[i];
    }
}

}  // namespace

double pack_frame(FrameForm form, const TangentFrame& frame, std::byte* out) {
    double degrees = 0;
    if (form == FrameForm::quat48 || form == FrameForm::quat32) {
        pack_digits<1>(form, {&frame, 1}, out, 0, &degrees);
        return degrees;
    }
    const bool left_handed = frame.handedness < 0;
    const Quaternion q = quaternion_of(frame);
    const Components exact = pack_f32(q, left_handed);
    if (form == FrameForm::f32) {
        write(exact, out);
        return 0;
    }
    const Words words = pack_half3(q, left_handed);
    write(words, out);
    return frame_angle(unpack_f32(exact), unpack_half3(words));
}

void pack_frames(FrameForm form, std::span<const TangentFrame> frames, std::byte* out,
                 std::size_t stride, double* degrees) {
    std::size_t i = 0;
    if (form == FrameForm::quat48 || form == FrameForm::quat32) {
        for (; i + kManyLanes <= frames.size(); i += kManyLanes)
            pack_digits<kManyLanes>(form, frames.subspan(i, kManyLanes), out + i * stride, stride,
                                    degrees + i);
    }
    for (; i < frames.size(); ++i) degrees[i] = pack_frame(form, frames[i], out + i * stride);
}

TangentFrame unpack_frame(FrameForm form, const std::byte* in) {
    switch (form) {
        case FrameForm::quat48:
            return unpack_quat48(read<Words>(in));
        case FrameForm::quat32:
            return unpack_quat32(read<std::uint32_t>(in));
        case FrameForm::half3:
            return unpack_half3(read<Words>(in));
        case FrameForm::f32:
            break;
    }
    return unpack_f32(read<Components>(in));
}

double frame_angle(const TangentFrame& a, const TangentFrame& b) {
    if ((a.handedness < 0) != (b.handedness < 0)) return 180;
    const auto squared_distance = [](Vec3 u, Vec3 v) {
        const Vec3 d{u.x - v.x, u.y - v.y, u.z - v.z};
        return dot(d, d);
    };
    const Vec3 ta = wide(a.tangent);
    const Vec3 tb = wide(b.tangent);
    const Vec3 na = wide(a.normal);
    const Vec3 nb = wide(b.normal);
    // Two rotations at an angle of theta differ by 2 sqrt(2) sin(theta / 2) in Frobenius' norm,
    // which is precise for small angles where the trace is not.
    const double squared = squared_distance(ta, tb) + squared_distance(na, nb) +
                           squared_distance(cross(na, ta), cross(nb, tb));
    const double sine = std::min(1.0, std::sqrt(squared / 8));
    return 2 * std::asin(sine) * (180 / std::numbers::pi);
}

}  // namespace mesh_format
