// Shades a fragment in world space; the body of all fragment shaders. With
// VERTEX_COLORS defined, vertices have a colour.
#include "shaders/brdf.glsl"
#include "shaders/false_color.h"
#include "shaders/interop.h"

layout(constant_id = kViewConstant) const uint view = kViewShaded;
layout(constant_id = kNormalMapConstant) const uint use_normal_map = 1;
layout(constant_id = kRoughnessMapConstant) const uint use_roughness_map = 1;
layout(constant_id = kMetalnessMapConstant) const uint use_metalness_map = 1;
layout(constant_id = kMergedMapsConstant) const uint merged_maps = 0;
layout(constant_id = kFalseColorConstant) const uint use_false_color = 0;
layout(constant_id = kUnlitConstant) const uint unlit = 0;
layout(constant_id = kChangingUvsConstant) const uint changing_uvs = 0;

layout(set = kSceneSet, binding = kSceneBinding, std140) uniform Scene { SceneUniforms scene; };
layout(push_constant) uniform Push {
    DrawConstants draw;
    layout(offset = kDisplayOffset) DisplayConstants display;
};

layout(set = kMaterialSet, binding = kBaseColorBinding) uniform sampler2D base_color_map;
layout(set = kMaterialSet, binding = kRoughnessBinding) uniform sampler2D roughness_map;
layout(set = kMaterialSet, binding = kMetalnessBinding) uniform sampler2D metalness_map;
layout(set = kMaterialSet, binding = kNormalMapBinding) uniform sampler2D normal_map;

layout(location = 0) in vec3 world_position;
layout(location = 0, component = 3) in float signed_by_handedness;
layout(location = 1) in vec3 world_normal;
layout(location = 1, component = 3) in float uv_x;
layout(location = 2) in vec3 world_tangent;
layout(location = 2, component = 3) in float uv_y;
#ifdef VERTEX_COLORS
layout(location = 3) in vec4 vertex_color;
#else
const vec4 vertex_color = vec4(1.0);
#endif

layout(location = 0) out vec4 color;

float handedness = signed_by_handedness > 0.0 ? 1.0 : -1.0;
vec2 uv = vec2(uv_x, uv_y);

// Where maps are sampled. Where UVs are the same in a whole quad, as on faces that take their
// colour from a palette, Mesa 25's anisotropic filter divides 0 by 0: they are moved apart, by more
// than they are rounded by and far less than a texel.
vec2 sampled_uv() {
    if (changing_uvs == 0) return uv;
    const float least = max(1.0, max(abs(uv.x), abs(uv.y))) / 1048576.0;
    const vec2 change = max(abs(dFdx(uv)), abs(dFdy(uv)));
    if (max(change.x, change.y) > least) return uv;
    return uv + 2.0 * least * vec2(ivec2(gl_FragCoord.xy) & 1);
}
vec2 map_uv = sampled_uv();

// Which side of the surface is seen, as a factor of its normals.
float side() { return gl_FrontFacing ? 1.0 : draw.back_normals; }

vec3 vertex_normal() { return side() * normalize(world_normal); }

// In MikkTSpace's way: the bitangent from the interpolated normal and tangent as they are, only
// the sum is normalised.
vec3 shading_normal(vec2 texel) {
    vec3 t = vec3(texel * 2.0 - 1.0, 0.0);
    t.z = sqrt(max(1.0 - dot(t.xy, t.xy), 0.0));
    t.xy *= draw.normal_scale;
    const vec3 bitangent = handedness * cross(world_normal, world_tangent);
    return side() * normalize(t.x * world_tangent + t.y * bitangent + t.z * world_normal);
}

Surface surface_at_fragment() {
    Surface surface;
    surface.base_color =
        draw.base_color * vertex_color.rgb * texture(base_color_map, map_uv, display.lod_bias).rgb;
    const bool has_normal_map = draw.has_normal_map != 0;
    vec4 texel = vec4(0.0);
    if (merged_maps != 0 || (use_normal_map != 0 && has_normal_map))
        texel = texture(normal_map, map_uv, display.lod_bias);
    surface.alpha = draw.roughness;
    if (use_roughness_map != 0)
        surface.alpha *=
            merged_maps != 0 ? texel.b : texture(roughness_map, map_uv, display.lod_bias).r;
    surface.metalness = draw.metalness;
    if (use_metalness_map != 0)
        surface.metalness *=
            merged_maps != 0 ? texel.a : texture(metalness_map, map_uv, display.lod_bias).r;
    surface.normal =
        use_normal_map != 0 && has_normal_map ? shading_normal(texel.xy) : vertex_normal();
    return surface;
}

// A direction as a colour.
vec3 as_color(vec3 direction) { return 0.5 * direction + 0.5; }

// The linear value that the chosen view shows; `alpha_mask` is what the mask holds here, `emission`
// what is emitted, where white paper that faces a light of colour 1 has 1.
vec3 view_color(float alpha_mask, vec3 emission) {
    const Surface surface = surface_at_fragment();
    // A light on the surface itself is above that point.
    const vec3 to_light = scene.lightPosition - world_position;
    const vec3 l = dot(to_light, to_light) > 0.0 ? normalize(to_light) : surface.normal;
    const vec3 v = normalize(scene.cameraPosition - world_position);
    const Brdf brdf = evaluate_brdf(surface, l, v);
    switch (view == kViewOfDisplay ? display.view : view) {
        case kViewNormal: return as_color(surface.normal);
        case kViewVertexNormal: return as_color(vertex_normal());
        case kViewViewDirection: return as_color(v);
        case kViewLightDirection: return as_color(l);
        case kViewDiffuse: return brdf.diffuse;
        case kViewSpecular: return brdf.specular;
        case kViewDistribution: return vec3(brdf.distribution);
        case kViewMasking: return vec3(brdf.masking);
        case kViewFresnel: return brdf.fresnel;
        case kViewBaseColor: return surface.base_color;
        case kViewRoughness: return vec3(surface.alpha);
        case kViewMetalness: return vec3(surface.metalness);
        case kViewTangent: return as_color(normalize(world_tangent));
        case kViewBitangent:
            return as_color(normalize(handedness * cross(world_normal, world_tangent)));
        case kViewUv: return vec3(fract(uv), 0.0);
        case kViewAlphaMask: return vec3(alpha_mask);
        case kReadPosition: return world_position;
        case kViewEmission: return emission;
        case kViewVertexColor: return vertex_color.rgb;
        case kReadMaterial: return vec3(draw.material, unlit, 0.0);
    }
    if (unlit != 0) return surface.base_color / kPi;
    return emission / kPi + scene.ambientColor * surface.base_color +
           scene.lightColor * (brdf.diffuse * brdf.n_dot_l + brdf.specular_n_dot_l);
}

// The colour that shows the value of a view.
vec4 displayed(vec3 value) {
    if (use_false_color == 0) return vec4(value * display.exposure, 1.0);
    const float position = false_color_position(luminance_of(value), display.false_color_low,
                                                display.false_color_high);
    return vec4(false_color(position), 1.0);
}
