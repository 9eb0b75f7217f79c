// The sRGB curve of IEC 61966-2-1 in double, written here apart from the one that the programs use.
#pragma once

#include <cmath>

/// One step of an 8-bit sample.
inline constexpr double kByteStep = 1.0 / 255.0 + 1e-6;

inline double linear_of_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

inline double srgb_of_linear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}
