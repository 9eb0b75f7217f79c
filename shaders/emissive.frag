#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shade.glsl"
#include "shaders/alpha_mask.glsl"

layout(set = kMaterialSet, binding = kEmissionBinding) uniform sampler2D emission_map;

void main() {
    const float alpha_mask = alpha_mask_at_fragment();
    // The colour first: its samples need the derivatives of the whole quad.
    const vec3 emission = draw.emission * texture(emission_map, map_uv, display.lod_bias).rgb;
    color = displayed(view_color(alpha_mask, emission));
    discard_below_cutoff(alpha_mask);
}
