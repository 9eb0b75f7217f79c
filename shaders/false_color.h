// Values as colours that the eye can put in order. GLSL and C++ both include this file.
#ifndef CW2_SHADERS_FALSE_COLOR_H
#define CW2_SHADERS_FALSE_COLOR_H

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#define CW2_FUNCTION inline
namespace cw2::interop {
using glm::dot;
using glm::vec3;
using std::cos;
using std::log;
using std::max;
using std::min;
using std::sin;
#else
#define CW2_FUNCTION
#endif

// What false colour shows of a linear RGB value: its luminance (Rec. 709).
CW2_FUNCTION float luminance_of(vec3 value) {
    return dot(value, vec3(0.2126f, 0.7152f, 0.0722f));
}

// Where a value lies between low and high, clamped to [0, 1]: by its logarithm if low is positive,
// else linearly.
CW2_FUNCTION float false_color_position(float value, float low, float high) {
    const float position =
        low > 0.0f ? log(max(value, low) / low) / log(high / low) : (value - low) / (high - low);
    return min(max(position, 0.0f), 1.0f);
}

// The linear colour of a position in [0, 1]: from dark blue over purple, red and orange to light
// yellow. It is a helix in Oklab (B. Ottosson, "A perceptual color space for image processing",
// 2020): lightness 0.2 to 0.97, chroma 0.13, hue 265 to 470 degrees. So steps of equal length look
// equally large everywhere, and the lightness alone tells the order.
CW2_FUNCTION vec3 false_color(float position) {
    const float lightness = 0.2f + 0.77f * position;
    const float hue = 4.6251225f + 3.5779250f * position;
    const float a = 0.13f * cos(hue);
    const float b = 0.13f * sin(hue);
    const float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
    const float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
    const float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
    return l * l * l * vec3(4.0767416621f, -1.2684380046f, -0.0041960863f) +
           m * m * m * vec3(-3.3077115913f, 2.6097574011f, -0.7034186147f) +
           s * s * s * vec3(0.2309699292f, -0.3413193965f, 1.7076147010f);
}

#ifdef __cplusplus
}  // namespace cw2::interop
#endif

#endif
