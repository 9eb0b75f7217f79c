#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shade.glsl"

layout(constant_id = kAlphaMaskConstant) const uint use_alpha_mask = 1;

layout(set = kMaterialSet, binding = kAlphaMaskBinding) uniform sampler2D alpha_mask_map;

void main() {
    const float alpha_mask = texture(alpha_mask_map, uv, display.lod_bias).r;
    // The colour first: its samples need the derivatives of the whole quad.
    color = displayed(view_color(alpha_mask));
    if (use_alpha_mask != 0 && alpha_mask < draw.alpha_cutoff) discard;
}
