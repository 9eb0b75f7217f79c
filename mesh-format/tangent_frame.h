// The tangent frame of a vertex, and the forms in which a vertex holds it.
//
// Tangent t, bitangent b and normal n with handedness s are orthonormal with b = s * cross(n, t).
// For s = -1 the matrix (t, b, n) is a reflection, which no quaternion can express; so the forms
// hold the rotation (t, cross(n, t), n) as a unit quaternion, and s as one bit beside it.
// q and -q are the same rotation: the sign is made canonical before a component is dropped.
#pragma once

#include <cstddef>
#include <span>

#include "mesh-format/layout.h"

namespace mesh_format {

struct TangentFrame {
    float tangent[3];  ///< unit length, orthogonal to the normal
    float normal[3];   ///< unit length
    float handedness;  ///< +1 or -1
};

/// Writes `frame` to the frame_bytes(form) bytes at `out`, nearest code first. The input need be
/// orthonormal only roughly: the normal's direction is kept, the tangent is made orthogonal to it.
///
/// Worst and mean angle of the rotation between `frame` and what unpack_frame returns, degrees:
///
///     form     bytes   mean     worst
///     quat48   6       0.0023   0.0050   largest component dropped, 3 x 15 bits, warped by atan
///     quat32   4       0.094    0.193    largest dropped, 3 digits of base 811, warped by atan
///     half3    6       0.084    3.3      x, y, z as halves with w >= 0
///     f32      16      rounding of float
///
/// The 24 frames along the axes are exact in every form, for both hands.
///
/// The bits, where `others` are the components besides the largest in the order x, y, z, w, each
/// divided by it, warped by a = atan(ratio) / (pi / 4) and rounded to a digit:
///
///     quat48   word k = digit of others[k], 0..32766; bit 15 of word 0 = left-handed, of words 1
///              and 2 = bits 0 and 1 of the largest component's number
///     quat32   digits 0..810: others[0] + 811 (others[1] + 811 (others[2] + 811 (number of the
///              largest + 4 left-handed)))
///     half3    x, y, z; bit 14 of the first = left-handed; bit 14 of the second: w is 1, else w is
///              what x, y, z lack to unit length. So are the quarter turns exact: (1, 0, 0, 1)
///     f32      x, y, z, w scaled to a largest component of +-1, w >= 0; the sign bit of w =
///              left-handed
///
/// Returns the angle of the rotation between `frame` and its code, degrees; 0 for f32.
double pack_frame(FrameForm form, const TangentFrame& frame, std::byte* out);

/// As pack_frame for each of `frames`, several times as fast: frame i goes to out + i * stride,
/// what pack_frame returns to degrees[i].
void pack_frames(FrameForm form, std::span<const TangentFrame> frames, std::byte* out,
                 std::size_t stride, double* degrees);

/// Reads the frame_bytes(form) bytes at `in`. Any bytes give a finite frame; those that no
/// pack_frame wrote give an arbitrary one.
TangentFrame unpack_frame(FrameForm form, const std::byte* in);

/// The angle of the rotation that takes frame a to frame b, degrees in [0, 180]; 180 if their
/// handedness differs.
double frame_angle(const TangentFrame& a, const TangentFrame& b);

}  // namespace mesh_format
