// Decodes one packed tangent frame per invocation with the decoder that the renderer uses.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/tangent_frame.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kForm = 0;

struct Decoded {
    vec4 tangent;  // w: handedness
    vec4 normal;
};

layout(std430, set = 0, binding = 0) readonly buffer Codes { uvec4 codes[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Frames { Decoded frames[]; };

void main() {
    const uint i = gl_GlobalInvocationID.x;
    vec3 tangent;
    vec3 normal;
    float handedness;
    decode_frame(kForm, codes[i], tangent, normal, handedness);
    frames[i] = Decoded(vec4(tangent, handedness), vec4(normal, 0.0));
}
