// What the textures of the test scenes show, as functions of u and v, with v up.
#pragma once

#include <array>
#include <cmath>

/// A round bump, or a dent where the height is negative: height * cos^2(pi r / (2 radius)) within
/// its radius. All lengths in units of the texture's width, which its height equals.
struct Bump {
    double u, v;  ///< centre, v up
    double radius;
    double height;
};

/// Unlike any mirror image or turn of themselves.
inline constexpr std::array<Bump, 4> kBumps{{{0.30, 0.68, 0.24, 0.060},
                                             {0.74, 0.32, 0.20, -0.050},
                                             {0.76, 0.78, 0.12, 0.030},
                                             {0.22, 0.20, 0.12, 0.030}}};

inline double bump_height(double u, double v) {
    double height = 0.0;
    for (const Bump& bump : kBumps) {
        const double r = std::hypot(u - bump.u, v - bump.v) / bump.radius;
        if (r < 1.0) height += bump.height * std::pow(std::cos(0.5 * M_PI * r), 2.0);
    }
    return height;
}

/// Unit normal: x along u, y along v, z out of the surface.
inline std::array<double, 3> bump_normal(double u, double v) {
    double du = 0.0;
    double dv = 0.0;
    for (const Bump& bump : kBumps) {
        const double distance = std::hypot(u - bump.u, v - bump.v);
        if (distance >= bump.radius || distance == 0.0) continue;
        const double slope =
            -bump.height * M_PI / (2.0 * bump.radius) * std::sin(M_PI * distance / bump.radius);
        du += slope * (u - bump.u) / distance;
        dv += slope * (v - bump.v) / distance;
    }
    const double length = std::sqrt(du * du + dv * dv + 1.0);
    return {-du / length, -dv / length, 1.0 / length};
}

/// A pointed leaf on a stem that bends to the right at its foot.
inline bool in_leaf(double u, double v) {
    const double along = (v - 0.25) / 0.7;
    if (along > 0.0 && along < 1.0) {
        const double half_width = 0.42 * std::sin(M_PI * std::sqrt(along)) * (1.0 - 0.35 * along);
        return std::abs(u - 0.5) < half_width;
    }
    return v <= 0.26 && std::abs(u - 0.5 - 1.2 * (0.26 - v)) < 0.035;
}

/// Colours of an image's quarters, in 255ths, sRGB: below left, below right, above left, above
/// right.
inline constexpr int kQuadrants[4][3] = {
    {40, 60, 220}, {230, 210, 20}, {200, 30, 40}, {30, 150, 70}};
