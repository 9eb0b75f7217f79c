// Tangent frames as quaternions, some at a time: loops over kLanes that compilers turn into vector
// instructions. Of tangent_frame.cpp only.
#pragma once

#include <cmath>
#include <cstddef>

#include "common/every_cpu.h"
#include "mesh-format/tangent_frame.h"

namespace mesh_format {

/// The rotations (t, cross(n, t), n) of frames, made orthonormal, as quaternions x, y, z, w scaled
/// so that the largest component is 1: its number, and the other three in their order.
template <std::size_t kLanes>
struct Rotations {
    double n[3][kLanes];
    double t[3][kLanes];
    double ratio[3][kLanes];
    double largest[kLanes];

    void load(std::size_t i, const TangentFrame& frame) {
        for (int k = 0; k < 3; ++k) {
            n[k][i] = frame.normal[k];
            t[k][i] = frame.tangent[k];
        }
    }

    CW2_INLINE void compute() {
        normalise();
        for (std::size_t i = 0; i < kLanes; ++i)
            if (!has_tangent_[i]) make_tangent(i);
        divide();
    }

 private:
    CW2_INLINE void normalise() {
        // A sine of 1e-6 is what float vectors of one direction may differ by.
        constexpr double kParallelSquared = 1e-12;
        for (std::size_t i = 0; i < kLanes; ++i) {
            double x = n[0][i];
            double y = n[1][i];
            double z = n[2][i];
            const double normal_squared = x * x + y * y + z * z;
            const bool has_normal = normal_squared > 0 && normal_squared < HUGE_VAL;
            const double scale = 1 / std::sqrt(has_normal ? normal_squared : 1);
            n[0][i] = x = has_normal ? x * scale : 0;
            n[1][i] = y = has_normal ? y * scale : 0;
            n[2][i] = z = has_normal ? z * scale : 1;
            const double full = t[0][i] * t[0][i] + t[1][i] * t[1][i] + t[2][i] * t[2][i];
            const double along = t[0][i] * x + t[1][i] * y + t[2][i] * z;
            t[0][i] -= along * x;
            t[1][i] -= along * y;
            t[2][i] -= along * z;
            squared_[i] = t[0][i] * t[0][i] + t[1][i] * t[1][i] + t[2][i] * t[2][i];
            // False for NaN and for two infinities too.
            has_tangent_[i] = squared_[i] > kParallelSquared * full;
        }
    }

    /// From the coordinate axis that is farthest from +-n; the first of equals.
    void make_tangent(std::size_t i) {
        const double size[3] = {std::abs(n[0][i]), std::abs(n[1][i]), std::abs(n[2][i])};
        const int axis = size[0] <= size[1] && size[0] <= size[2] ? 0 : size[1] <= size[2] ? 1 : 2;
        squared_[i] = 0;
        for (int k = 0; k < 3; ++k) {
            t[k][i] = (k == axis ? 1 : 0) - n[axis][i] * n[k][i];
            squared_[i] += t[k][i] * t[k][i];
        }
    }

    /// Every row of 4 q q^T is a multiple of q; the one with the largest diagonal is the most
    /// precise, and dividing by that diagonal makes the largest component +1, whatever its sign
    /// was.
    CW2_INLINE void divide() {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double scale = 1 / std::sqrt(squared_[i]);
            const double nx = n[0][i], ny = n[1][i], nz = n[2][i];
            const double tx = t[0][i] * scale, ty = t[1][i] * scale, tz = t[2][i] * scale;
            const double bx = ny * tz - nz * ty;
            const double by = nz * tx - nx * tz;
            const double bz = nx * ty - ny * tx;
            const double xy = ty + bx, xz = tz + nx, yz = bz + ny;
            const double xw = bz - ny, yw = nx - tz, zw = ty - bx;
            double best = 1 + tx - by - nz;
            double number = 0;
            double first = xy, second = xz, third = xw;
            const auto choose = [&](double diagonal, double row, double a, double b, double c) {
                const bool larger = diagonal > best;
                best = larger ? diagonal : best;
                number = larger ? row : number;
                first = larger ? a : first;
                second = larger ? b : second;
                third = larger ? c : third;
            };
            choose(1 - tx + by - nz, 1, xy, yz, yw);
            choose(1 - tx - by + nz, 2, xz, yz, zw);
            choose(1 + tx + by + nz, 3, xw, yw, zw);
            const double inverse = 1 / best;
            ratio[0][i] = first * inverse;
            ratio[1][i] = second * inverse;
            ratio[2][i] = third * inverse;
            largest[i] = number;
        }
    }

    double squared_[kLanes];
    bool has_tangent_[kLanes];
};

}  // namespace mesh_format
