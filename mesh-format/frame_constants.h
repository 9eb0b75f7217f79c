// Constants of the packed tangent frames: one text that both C++ and GLSL include.
#ifndef MESH_FORMAT_FRAME_CONSTANTS_H
#define MESH_FORMAT_FRAME_CONSTANTS_H

#ifdef __cplusplus
namespace mesh_format {
#endif

// The values of FrameForm.
const int kFrameQuat48 = 0;
const int kFrameQuat32 = 1;
const int kFrameHalf3 = 2;
const int kFrameF32 = 3;

// A digit d stands for the warped ratio (d - kMax / 2) / (kMax / 2) in [-1, 1]. The number of
// levels is odd, so that 0 and both ends are exact; multiplying by the inverse keeps them exact.
const int kQuat48DigitMax = 32766;
const float kQuat48InverseHalf = 1.0f / 16383.0f;
const int kQuat32Base = 811;
const float kQuat32InverseHalf = 1.0f / 405.0f;

// tan(x * pi / 4) = x * (1 - (1 - x^2) * Q(x^2)) for |x| <= 1, where Q has these coefficients,
// lowest power first. The shape makes 0 and +-1 exact whatever Q is. Q interpolates at the six
// Chebyshev nodes of [0, 1]: the polynomial is within 2.4e-8 of tan, in float within 8e-8.
const float kTanQ0 = 0.214601785f;
const float kTanQ1 = 0.0531149842f;
const float kTanQ2 = 0.0132167106f;
const float kTanQ3 = 0.0035121711f;
const float kTanQ4 = 0.000476221874f;
const float kTanQ5 = 0.00047622071f;

#ifdef __cplusplus
}  // namespace mesh_format
#endif

#endif
