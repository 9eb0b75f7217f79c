#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shade.glsl"
#include "shaders/alpha_mask.glsl"

void main() {
    const float alpha_mask = alpha_mask_at_fragment();
    // The colour first: its samples need the derivatives of the whole quad.
    color = displayed(view_color(alpha_mask, vec3(0.0)));
    discard_below_cutoff(alpha_mask);
}
