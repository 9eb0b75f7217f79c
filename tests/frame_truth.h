// Tangent frames that are made and measured without the code under test: a rotation is a
// double-precision quaternion that is applied to the axes by cross products, and the error is the
// angle of the relative rotation.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh-format/tangent_frame.h"

namespace frame_truth {

using mesh_format::TangentFrame;
using Vec3 = std::array<double, 3>;
using Random = std::mt19937_64;

inline constexpr double kDegrees = 180 / std::numbers::pi;

inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3 wide(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// A rotation, x y z w of unit length.
struct Quaternion {
    double x, y, z, w;

    static Quaternion unit(double x, double y, double z, double w) {
        const double norm = std::sqrt(x * x + y * y + z * z + w * w);
        return {x / norm, y / norm, z / norm, w / norm};
    }
    Vec3 rotate(const Vec3& v) const {
        const Vec3 u{x, y, z};
        const Vec3 once = cross(u, v);
        const Vec3 twice = cross(u, once);
        return {v[0] + 2 * (w * once[0] + twice[0]), v[1] + 2 * (w * once[1] + twice[1]),
                v[2] + 2 * (w * once[2] + twice[2])};
    }
};

inline TangentFrame frame_of(const Quaternion& q, bool left_handed) {
    const Vec3 t = q.rotate({1, 0, 0});
    const Vec3 n = q.rotate({0, 0, 1});
    TangentFrame frame{};
    for (int i = 0; i < 3; ++i) {
        frame.tangent[i] = static_cast<float>(t[i]);
        frame.normal[i] = static_cast<float>(n[i]);
    }
    frame.handedness = left_handed ? -1.0f : 1.0f;
    return frame;
}

/// Degrees of the rotation between the columns (t, cross(n, t), n) of two frames.
inline double rotation_angle(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    double m[3][3];  // a transposed, times b
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m[i][j] = dot(a[i], b[j]);
    }
    const Vec3 axis{m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
    return std::atan2(std::sqrt(dot(axis, axis)), m[0][0] + m[1][1] + m[2][2] - 1) * kDegrees;
}
inline std::array<Vec3, 3> columns(const TangentFrame& frame) {
    const Vec3 t = wide(frame.tangent);
    const Vec3 n = wide(frame.normal);
    return {t, cross(n, t), n};
}
inline std::array<Vec3, 3> columns(const Quaternion& q) {
    return {q.rotate({1, 0, 0}), q.rotate({0, 1, 0}), q.rotate({0, 0, 1})};
}

inline Quaternion random_rotation(Random& random) {
    std::normal_distribution<double> normal;
    return Quaternion::unit(normal(random), normal(random), normal(random), normal(random));
}

/// Where encoders go wrong: w near 0, ties for the largest component, all components equal, a
/// single component, each with perturbations between 1e-9 and 1e-1.
inline Quaternion adversarial_rotation(Random& random) {
    std::uniform_real_distribution<double> signed_unit(-1, 1);
    const auto tiny = [&] {
        return signed_unit(random) * std::pow(10, -5 + 4 * signed_unit(random));
    };
    const auto sign = [&] { return random() & 1 ? 1.0 : -1.0; };
    double q[4];
    switch (random() % 4) {
        case 0:
            for (double& component : q) component = signed_unit(random);
            q[3] = tiny();
            break;
        case 1:
            for (double& component : q) component = signed_unit(random);
            q[random() % 4] = sign();
            q[random() % 4] = sign() + (random() & 1 ? 0 : tiny());
            break;
        case 2:
            for (double& component : q) component = sign() + (random() & 1 ? 0 : tiny());
            break;
        default:
            for (double& component : q) component = tiny();
            q[random() % 4] = sign();
    }
    return Quaternion::unit(q[0], q[1], q[2], q[3]);
}

}  // namespace frame_truth
