// The sRGB transfer function of IEC 61966-2-1, both ways. GLSL and C++ both include this file.
#ifndef COMMON_SRGB_H
#define COMMON_SRGB_H

#ifdef __cplusplus
#include <cmath>
#define CW2_SRGB_FUNCTION    \
    template <typename Real> \
    inline
namespace common {
using std::pow;
#else
#define CW2_SRGB_FUNCTION
#define Real float
#endif

// Linear light in [0, 1] of an encoded value in [0, 1].
CW2_SRGB_FUNCTION Real linear_of_srgb(Real encoded) {
    return encoded <= Real(0.04045) ? encoded / Real(12.92)
                                    : pow((encoded + Real(0.055)) / Real(1.055), Real(2.4));
}

// The encoded value in [0, 1] of linear light in [0, 1].
CW2_SRGB_FUNCTION Real srgb_of_linear(Real linear) {
    return linear <= Real(0.0031308)
               ? Real(12.92) * linear
               : Real(1.055) * pow(linear, Real(1.0) / Real(2.4)) - Real(0.055);
}

#ifdef __cplusplus
}  // namespace common
#else
#undef Real
#endif

#endif
