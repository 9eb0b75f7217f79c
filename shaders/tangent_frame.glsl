// Decodes the packed tangent frames, see mesh-format/tangent_frame.h. The operations and their
// order are those of mesh-format/tangent_frame.cpp, so that both give the same bits.
#ifndef TANGENT_FRAME_GLSL
#define TANGENT_FRAME_GLSL

#include "mesh-format/frame_constants.h"

// The tangent and normal of the rotation by a quaternion of any length but 0.
void frame_of(vec4 q, out vec3 tangent, out vec3 normal) {
    precise float s =
        2.0 / (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    precise vec3 t = vec3(1.0 - s * (q.y * q.y + q.z * q.z), s * (q.x * q.y + q.w * q.z),
                          s * (q.x * q.z - q.w * q.y));
    precise vec3 n = vec3(s * (q.x * q.z + q.w * q.y), s * (q.y * q.z - q.w * q.x),
                          1.0 - s * (q.x * q.x + q.y * q.y));
    tangent = t;
    normal = n;
}

vec3 tan_quarter_pi(vec3 x) {
    precise vec3 y = x * x;
    precise vec3 q =
        ((((kTanQ5 * y + kTanQ4) * y + kTanQ3) * y + kTanQ2) * y + kTanQ1) * y + kTanQ0;
    precise vec3 result = x * (1.0 - (1.0 - y) * q);
    return result;
}

// `ratios` to the largest component, which goes back to where it was dropped.
vec4 with_largest(vec3 ratios, uint largest) {
    return largest == 0u   ? vec4(1.0, ratios)
           : largest == 1u ? vec4(ratios.x, 1.0, ratios.yz)
           : largest == 2u ? vec4(ratios.xy, 1.0, ratios.z)
                           : vec4(ratios, 1.0);
}

vec4 unpack_quat48(uvec3 words, out bool left_handed) {
    const ivec3 digits = ivec3(min(words & 0x7FFFu, uvec3(kQuat48DigitMax)));
    const vec3 levels = vec3(digits - kQuat48DigitMax / 2) * kQuat48InverseHalf;
    left_handed = words.x >> 15 != 0u;
    return with_largest(tan_quarter_pi(levels), words.y >> 15 | words.z >> 15 << 1);
}

vec4 unpack_quat32(uvec2 words, out bool left_handed) {
    const uint base = uint(kQuat32Base);
    uint code = words.x | words.y << 16;
    ivec3 digits;
    for (int i = 0; i < 3; ++i) {
        digits[i] = int(code % base);
        code /= base;
    }
    const vec3 levels = vec3(digits - kQuat32Base / 2) * kQuat32InverseHalf;
    left_handed = (code & 4u) != 0u;
    return with_largest(tan_quarter_pi(levels), code & 3u);
}

vec4 unpack_half3(uvec3 words, out bool left_handed) {
    const uvec3 halves = words & 0xBFFFu;
    const vec3 v =
        vec3(unpackHalf2x16(halves.x | halves.y << 16), unpackHalf2x16(halves.z).x);
    precise float squared = v.x * v.x + v.y * v.y + v.z * v.z;
    left_handed = (words.x & 0x4000u) != 0u;
    return vec4(v, (words.y & 0x4000u) != 0u ? 1.0 : sqrt(max(0.0, 1.0 - squared)));
}

vec4 unpack_f32(uvec4 words, out bool left_handed) {
    const uvec4 magnitudes = min(words & 0x7FFFFFFFu, uvec4(floatBitsToUint(1.0)));
    vec4 q = uintBitsToFloat(magnitudes | (words & uvec4(uvec3(0x80000000u), 0u)));
    precise float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (squared < 0.5) q.w = 1.0;
    left_handed = (words.w & 0x80000000u) != 0u;
    return q;
}

// `form` is a value of FrameForm. `words` holds the frame as read by an attribute of the format
// R16G16B16A16_UINT (quat48 and half3, x y z used), R16G16_UINT (quat32, x y used) or
// R32G32B32A32_UINT (f32). Tangent and normal are orthonormal and the bitangent is
// handedness * cross(normal, tangent), handedness +1 or -1; any words give a finite frame.
void decode_frame(uint form, uvec4 words, out vec3 tangent, out vec3 normal,
                  out float handedness) {
    bool left_handed;
    vec4 q;
    if (form == kFrameQuat48) {
        q = unpack_quat48(words.xyz, left_handed);
    } else if (form == kFrameQuat32) {
        q = unpack_quat32(words.xy, left_handed);
    } else if (form == kFrameHalf3) {
        q = unpack_half3(words.xyz, left_handed);
    } else {
        q = unpack_f32(words, left_handed);
    }
    frame_of(q, tangent, normal);
    handedness = left_handed ? -1.0 : 1.0;
}

#endif
