// Makes the bytes of a picture from linear colours.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/srgb.h"
#include "shaders/interop.h"

layout(local_size_x = kAverageGroup, local_size_y = kAverageGroup) in;
layout(set = 0, binding = kMeanBinding, rgba32f) uniform readonly image2D mean;
layout(set = 0, binding = kBytesBinding, rgba8) uniform writeonly image2D bytes;
layout(push_constant) uniform Push { AverageConstants average; };

vec3 srgb_of(vec3 x) {
    return vec3(srgb_of_linear(x.r), srgb_of_linear(x.g), srgb_of_linear(x.b));
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(mean)))) return;
    vec4 color = imageLoad(mean, pixel);
    // Colours are premultiplied by the coverage where there is no background.
    if (average.divides_by_alpha != 0 && color.a > 0.0) color.rgb = min(color.rgb / color.a, 1.0);
    if (average.encodes_srgb != 0) color.rgb = srgb_of(color.rgb);
    imageStore(bytes, pixel, average.swaps_red_and_blue != 0 ? color.bgra : color);
}
