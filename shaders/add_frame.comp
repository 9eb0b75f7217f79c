// Adds a frame to the mean of several.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/interop.h"

layout(local_size_x = kAverageGroup, local_size_y = kAverageGroup) in;
layout(set = 0, binding = kFrameBinding, rgba32f) uniform readonly image2D frame;
layout(set = 0, binding = kMeanBinding, rgba32f) uniform image2D mean;
layout(push_constant) uniform Push { AverageConstants average; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(frame)))) return;
    vec4 color = imageLoad(frame, pixel);
    if (average.clamps != 0) color = clamp(color, 0.0, 1.0);
    color *= average.weight;
    if (average.starts == 0) color += imageLoad(mean, pixel);
    imageStore(mean, pixel, color);
}
