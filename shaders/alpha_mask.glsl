// What an alpha mask leaves of a surface.
layout(constant_id = kAlphaMaskConstant) const uint use_alpha_mask = 1;

layout(set = kMaterialSet, binding = kAlphaMaskBinding) uniform sampler2D alpha_mask_map;

float alpha_mask_at_fragment() {
    if (use_alpha_mask == kAlphaMaskAbsent) return 1.0;
    return vertex_color.a * texture(alpha_mask_map, map_uv, display.lod_bias).r;
}

void discard_below_cutoff(float alpha_mask) {
    if (use_alpha_mask == 1 && alpha_mask < draw.alpha_cutoff) discard;
}
