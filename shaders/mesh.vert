// Unpacks a vertex into world space; all pipelines share it. With VERTEX_COLORS defined, vertices
// have a colour.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/srgb.h"
#include "shaders/interop.h"
#include "shaders/tangent_frame.glsl"

layout(constant_id = kPositionFormConstant) const uint position_form = 0;
layout(constant_id = kFrameFormConstant) const uint frame_form = 0;
layout(constant_id = kUvFormConstant) const uint uv_form = 0;

layout(set = kSceneSet, binding = kSceneBinding, std140) uniform Scene { SceneUniforms scene; };
layout(push_constant) uniform Draw { DrawConstants draw; };

layout(location = kPositionLocation) in uvec4 position_words;
layout(location = kFrameLocation) in uvec4 frame_words;
layout(location = kUvLocation) in uvec2 uv_words;
#ifdef VERTEX_COLORS
layout(location = kColorLocation) in vec4 encoded_color;
#endif

// Three locations and not five: on CPUs every one is set up for every triangle, and kept with it.
layout(location = 0) out vec3 world_position;
layout(location = 0, component = 3) out float handedness;  // the same at a triangle's corners
layout(location = 1) out vec3 world_normal;
layout(location = 1, component = 3) out float uv_x;
layout(location = 2) out vec3 world_tangent;
layout(location = 2, component = 3) out float uv_y;
#ifdef VERTEX_COLORS
layout(location = 3) out vec4 vertex_color;  // linear
#endif

void main() {
    // Integers below 2^24 times a power of two: exact, so equal positions stay equal across meshes.
    world_position = position_form == 0
                         ? vec3(draw.position_origin + ivec3(position_words.xyz)) * draw.position_step
                         : uintBitsToFloat(position_words.xyz);
    const vec2 uv =
        uv_form == 0 ? draw.uv_origin + draw.uv_step * vec2(uv_words) : uintBitsToFloat(uv_words);
    uv_x = uv.x;
    uv_y = uv.y;
    decode_frame(frame_form, frame_words, world_tangent, world_normal, handedness);
#ifdef VERTEX_COLORS
    vertex_color = vec4(linear_of_srgb(encoded_color.r), linear_of_srgb(encoded_color.g),
                        linear_of_srgb(encoded_color.b), encoded_color.a);
#endif
    gl_Position = scene.projCam * vec4(world_position, 1.0);
}
