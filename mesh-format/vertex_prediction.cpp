#include "mesh-format/vertex_prediction.h"

#include <algorithm>
#include <cmath>

#include "mesh-format/frame_constants.h"

namespace mesh_format {

namespace {

constexpr int kOne = 32'768;
constexpr int kAngles = 16'383;  // in 45 degrees, as many as quat48 has

/// Of every angle from 0 to 45 degrees its tangent, and of every tangent the angle.
struct Ratios {
    std::array<std::uint16_t, kAngles + 1> ratio;
    std::array<std::uint16_t, kOne + 1> angle;

    Ratios() {
        for (int a = 0; a <= kAngles; ++a) ratio[static_cast<std::size_t>(a)] = ratio_of(a);
        std::uint16_t a = 0;
        for (std::size_t r = 0; r < angle.size(); ++r) {
            while (ratio[a] < r) ++a;
            angle[r] = a;
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

/// Of a ratio in [-kOne, kOne].
template <FrameForm kForm>
int digit_of(int ratio) {
    using Code = FrameCode<kForm>;
    const int angle = ratios().angle[static_cast<std::size_t>(std::abs(ratio))];
    const int level = Code::kWide ? angle : (angle * Code::kZero + kAngles / 2) / kAngles;
    return Code::kZero + with_sign_of(ratio, level);
}

/// Of a quaternion whose largest component may be another.
template <FrameForm kForm>
void rebased_to(const std::array<int, 4>& q, std::uint32_t largest, Digits& others) {
    // It is not 0 where what is expected is near the truth.
    const int divisor = q[largest] == 0 ? 1 : q[largest];
    for (std::uint32_t k = 0; k < 3; ++k) {
        const int ratio = std::clamp(q[k + (k >= largest)] * kOne / divisor, -kOne, kOne);
        others[k] = static_cast<std::int16_t>(digit_of<kForm>(ratio));
    }
}

}  // namespace

template <FrameForm kForm>
void FrameCode<kForm>::rebased(const FrameDigits& frame, std::uint32_t largest, Digits& others) {
    const std::uint32_t from = frame.top & 3u;
    if (from == largest) {
        others = frame.others;
        return;
    }
    // No branch on which they are: no one can predict it.
    std::array<int, 4> q;
    for (std::uint32_t k = 0; k < 3; ++k) q[k + (k >= from)] = ratio_of<kForm>(frame.others[k]);
    q[from] = kOne;
    rebased_to<kForm>(q, largest, others);
}

template <FrameForm kForm>
int FrameCode<kForm>::of_x_tangent(int first, int second) {
    return digit_of<kForm>(ratio_of<kForm>(first) * ratio_of<kForm>(second) / kOne);
}

template <FrameForm kForm>
void FrameCode<kForm>::of_rotation(const Rotations& rotations, std::size_t k, std::uint32_t largest,
                                   Digits& others) {
    const auto component = [&](std::uint32_t number) { return rotations.components[number][k]; };
    if ((static_cast<std::uint32_t>(rotations.tops[k]) & 3u) == largest) [[likely]] {
        for (std::uint32_t i = 0; i < 3; ++i)
            others[i] = static_cast<std::int16_t>(digit_of<kForm>(component(i + (i >= largest))));
        return;
    }
    const std::array<int, 4> q{component(0), component(1), component(2), component(3)};
    rebased_to<kForm>(q, largest, others);
}

template struct FrameCode<FrameForm::quat48>;
template struct FrameCode<FrameForm::quat32>;

}  // namespace mesh_format
