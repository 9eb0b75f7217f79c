#include "mesh-format/vertex_prediction.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "mesh-format/frame_constants.h"

namespace mesh_format {

namespace {

constexpr int kOne = 32'768;
constexpr int kAngles = 16'383;  // in 45 degrees, as many as quat48 has
constexpr int kSecantStep = 8;

/// Of every angle from 0 to 45 degrees its tangent, and of every tangent the angle; of some
/// tangents the secant.
struct Ratios {
    std::array<std::uint16_t, kAngles + 1> ratio;
    std::array<std::uint16_t, kOne + 1> angle;
    std::array<std::uint16_t, kOne / kSecantStep + 1> secant;

    Ratios() {
        for (int a = 0; a <= kAngles; ++a) ratio[static_cast<std::size_t>(a)] = ratio_of(a);
        std::uint16_t a = 0;
        for (std::size_t r = 0; r < angle.size(); ++r) {
            while (ratio[a] < r) ++a;
            angle[r] = a;
        }
        std::uint32_t root = kOne;
        for (std::uint32_t r = 0; r <= kOne; r += kSecantStep) {
            while (root * root < kOne * std::uint32_t{kOne} + r * r) ++root;
            secant[r / kSecantStep] = static_cast<std::uint16_t>(root);
        }
    }

 private:
    /// By the polynomial of frame_constants.h, in units of 2^-30.
    static std::uint16_t ratio_of(int a) {
        constexpr std::int64_t kUnit = 1 << 30;
        const auto units = [](double value) { return static_cast<std::int64_t>(value * kUnit); };
        const std::int64_t coefficients[] = {units(kTanQ4), units(kTanQ3), units(kTanQ2),
                                             units(kTanQ1), units(kTanQ0)};
        const std::int64_t x = kUnit * a / kAngles;
        const std::int64_t y = x * x / kUnit;
        std::int64_t q = units(kTanQ5);
        for (const std::int64_t coefficient : coefficients) q = q * y / kUnit + coefficient;
        const std::int64_t tangent = x * (kUnit - (kUnit - y) * q / kUnit) / kUnit;
        return static_cast<std::uint16_t>((tangent + kUnit / kOne / 2) * kOne / kUnit);
    }
};

const Ratios& ratios() {
    static const Ratios instance;
    return instance;
}

/// Without a branch, which no one can predict.
int with_sign_of(int number, int magnitude) {
    const int sign = number >> 31;
    return (magnitude ^ sign) - sign;
}

template <FrameForm kForm>
int ratio_of(int digit) {
    using Code = FrameCode<kForm>;
    const int level = std::min(digit, 2 * Code::kZero) - Code::kZero;
    int angle = std::abs(level);
    if (!Code::kWide) angle = (angle * kAngles + Code::kZero / 2) / Code::kZero;
    return with_sign_of(level, ratios().ratio[static_cast<std::size_t>(angle)]);
}

/// The digit of a component whose ratio to the largest is the tangent of `angle`, of the sign of
/// `sign`; not negative.
template <FrameForm kForm>
int digit_of_angle(int angle, int sign) {
    using Code = FrameCode<kForm>;
    const int level = Code::kWide ? angle : (angle * Code::kZero + kAngles / 2) / kAngles;
    return Code::kZero + with_sign_of(sign, level);
}

/// Of a ratio in [-kOne, kOne].
template <FrameForm kForm>
int digit_of(int ratio) {
    return digit_of_angle<kForm>(ratios().angle[static_cast<std::size_t>(std::abs(ratio))], ratio);
}

struct Polar {
    int angle;  ///< to the x axis, at most 90 degrees
    int length;
};

/// Of (x, y), neither negative nor above 46,341.
Polar polar(int x, int y) {
    const int longer = std::max({x, y, 1});
    const auto ratio = static_cast<std::size_t>(std::min(x, y) * kOne / longer);
    const int angle = ratios().angle[ratio];
    return {y > x ? 2 * kAngles - angle : angle,
            longer * (ratios().secant[ratio / kSecantStep] / 2) / (kOne / 2)};
}

/// A number of a quantised position.
std::int64_t number(const std::byte* position, std::size_t axis) {
    std::uint16_t value = 0;
    std::memcpy(&value, position + axis * sizeof value, sizeof value);
    return value;
}

}  // namespace

void sum_normals(std::span<const std::uint16_t> indices, const std::byte* positions,
                 std::size_t stride, std::span<Normal> sums) {
    std::ranges::fill(sums, Normal{});
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::byte* const p[] = {positions + indices[i] * stride,
                                      positions + indices[i + 1] * stride,
                                      positions + indices[i + 2] * stride};
        std::array<std::int64_t, 3> u;
        std::array<std::int64_t, 3> v;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            u[axis] = number(p[1], axis) - number(p[0], axis);
            v[axis] = number(p[2], axis) - number(p[0], axis);
        }
        const Normal normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                            u[0] * v[1] - u[1] * v[0]};
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                std::int64_t& sum = sums[indices[i + k]][axis];
                sum = static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) +
                                                static_cast<std::uint64_t>(normal[axis]));
            }
        }
    }
}

template <FrameForm kForm>
void FrameCode<kForm>::rebased(const FrameDigits& frame, std::uint32_t largest, Digits& others) {
    const std::uint32_t from = frame.top & 3u;
    if (from == largest) {
        others = frame.others;
        return;
    }
    // No branch on which they are: no one can predict it.
    int q[4];
    for (std::uint32_t k = 0; k < 3; ++k) q[k + (k >= from)] = ratio_of<kForm>(frame.others[k]);
    q[from] = kOne;
    // It is not 0 where the two are neighbours on a smooth surface.
    const int divisor = q[largest] == 0 ? 1 : q[largest];
    for (std::uint32_t k = 0; k < 3; ++k) {
        const int ratio = std::clamp(q[k + (k >= largest)] * kOne / divisor, -kOne, kOne);
        others[k] = static_cast<std::int16_t>(digit_of<kForm>(ratio));
    }
}

template <FrameForm kForm>
int FrameCode<kForm>::of_x_tangent(int first, int second) {
    return digit_of<kForm>(ratio_of<kForm>(first) * ratio_of<kForm>(second) / kOne);
}

// A frame whose tangent is the x axis, made orthogonal to the normal, is a turn by a about the x
// axis after one by b, at most 90 degrees, about the y axis. Its quaternion is (sin a/2 cos b/2,
// cos a/2 sin b/2, sin a/2 sin b/2, cos a/2 cos b/2), its normal (sin b, -sin a cos b, cos a cos
// b).
Turn turn_to(const Normal& normal) {
    std::array<std::uint64_t, 3> sizes;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto number = static_cast<std::uint64_t>(normal[k]);
        sizes[k] = normal[k] < 0 ? 0 - number : number;
    }
    const int bits = static_cast<int>(std::bit_width(sizes[0] | sizes[1] | sizes[2]));
    std::array<int, 3> n;
    for (std::size_t k = 0; k < 3; ++k) n[k] = static_cast<int>(sizes[k] >> std::max(bits - 15, 0));

    const Polar yz = polar(n[2], n[1]);
    return {(normal[2] < 0 ? 4 * kAngles - yz.angle : yz.angle) / 2,
            polar(yz.length, n[0]).angle / 2, normal[1] > 0 ? -1 : 0, normal[0] < 0 ? -1 : 0};
}

template <FrameForm kForm>
void FrameCode<kForm>::of_turn(const Turn& turn, std::uint32_t largest, Digits& others) {
    const int first = std::min(largest == 0 ? 2 * kAngles - turn.about_x : turn.about_x, kAngles);
    others[largest == 0 ? 2 : 0] =
        static_cast<std::int16_t>(digit_of_angle<kForm>(first, turn.x_sign));
    others[1] = static_cast<std::int16_t>(digit_of_angle<kForm>(turn.about_y, turn.y_sign));
}

template struct FrameCode<FrameForm::quat48>;
template struct FrameCode<FrameForm::quat32>;

}  // namespace mesh_format
