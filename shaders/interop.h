// What GLSL and C++ share: structures, bindings, constants. Both languages include this file; it
// is the only definition of any of them.
#ifndef CW2_SHADERS_INTEROP_H
#define CW2_SHADERS_INTEROP_H

#ifdef __cplusplus
#include <cstddef>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#define CW2_STD140 alignas(16)
#define CW2_CONSTANT inline constexpr
namespace cw2::interop {
using glm::ivec3;
using glm::mat4;
using glm::vec2;
using glm::vec3;
using uint = unsigned int;
#else
#define CW2_STD140
#define CW2_CONSTANT const
#endif

// Set 0: the scene, bound once a frame, seen by both stages.
struct SceneUniforms {
    mat4 camera;                     // view from world
    mat4 projection;                 // clip from view; depth 1 at the near plane, 0 at infinity
    mat4 projCam;                    // clip from world
    CW2_STD140 vec3 cameraPosition;  // world
    CW2_STD140 vec3 lightPosition;   // world
    CW2_STD140 vec3 lightColor;      // linear
    CW2_STD140 vec3 ambientColor;    // linear
};
CW2_CONSTANT uint kSceneSet = 0;
CW2_CONSTANT uint kSceneBinding = 0;

// Set 1: the material, bound when it changes, fragment stage only. A map's binding is its place
// in mesh_format::MapUse. The opaque pipelines' layout has the first four, the alpha-mask
// pipelines' the first five, the emissive pipelines' all of them.
CW2_CONSTANT uint kMaterialSet = 1;
CW2_CONSTANT uint kBaseColorBinding = 0;
CW2_CONSTANT uint kRoughnessBinding = 1;
CW2_CONSTANT uint kMetalnessBinding = 2;
CW2_CONSTANT uint kNormalMapBinding = 3;
CW2_CONSTANT uint kAlphaMaskBinding = 4;
CW2_CONSTANT uint kEmissionBinding = 5;

// Push constants: what the packed vertices of one mesh need, and its material's factors.
struct DrawConstants {
    ivec3 position_origin;  // lattice units
    float position_step;    // world units
    vec2 uv_origin;
    vec2 uv_step;
    vec3 base_color;  // linear
    float roughness;
    vec3 emission;  // 1 is white paper that faces a light of colour 1
    float metalness;
    float alpha_cutoff;
    uint has_normal_map;  // 0 or 1
    float normal_scale;   // multiplies x and y of what the normal map holds
    float back_normals;   // multiplies the normals of back faces: 1 or -1
    uint material;        // index
};

// Push constants after those, at kDisplayOffset: how a view's values become colours.
struct DisplayConstants {
    float exposure;          // factor on the values
    float false_color_low;   // values from low to high have the whole range of colours,
    float false_color_high;  // see false_color.h
    uint view;               // what kViewOfDisplay shows
    float lod_bias;          // added to textures' level of detail
};
CW2_CONSTANT uint kDisplayOffset = 96;

// What add_frame.comp and encode_mean.comp are told; booleans are 0 or 1.
struct AverageConstants {
    float weight;  // of the frame in the mean
    uint starts;   // the frame is the first one
    uint clamps;   // the frame's colours to [0, 1]
    uint divides_by_alpha;
    uint encodes_srgb;
    uint swaps_red_and_blue;
};
CW2_CONSTANT uint kFrameBinding = 0;
CW2_CONSTANT uint kMeanBinding = 1;
CW2_CONSTANT uint kBytesBinding = 2;
CW2_CONSTANT uint kAverageGroup = 8;  // pixels a side of a group of invocations

// Vertex inputs; all are read as unsigned integers of the width their form has.
CW2_CONSTANT uint kPositionLocation = 0;
CW2_CONSTANT uint kFrameLocation = 1;
CW2_CONSTANT uint kUvLocation = 2;
CW2_CONSTANT uint kColorLocation = 3;  // normalised; where VERTEX_COLORS is defined

CW2_CONSTANT uint kAlphaMaskAbsent = 2;

// Specialisation constants. The forms are mesh_format's enumerations.
CW2_CONSTANT uint kPositionFormConstant = 0;
CW2_CONSTANT uint kFrameFormConstant = 1;
CW2_CONSTANT uint kUvFormConstant = 2;
CW2_CONSTANT uint kViewConstant = 3;
CW2_CONSTANT uint kNormalMapConstant = 4;     // 0: the vertex normal shades
CW2_CONSTANT uint kAlphaMaskConstant = 5;     // 0: nothing is discarded; kAlphaMaskAbsent
CW2_CONSTANT uint kRoughnessMapConstant = 6;  // 0: the factor alone counts
CW2_CONSTANT uint kMetalnessMapConstant = 7;  // the same
CW2_CONSTANT uint kFalseColorConstant = 8;    // 0: exposure, else false colour
CW2_CONSTANT uint kUnlitConstant = 9;         // else the base colour is what is seen
CW2_CONSTANT uint kMergedMapsConstant = 10;  // else the normal map holds x, y, roughness, metalness
CW2_CONSTANT uint kChangingUvsConstant = 11;  // 0: they may be the same in neighbouring pixels
CW2_CONSTANT uint kSpecializationCount = 12;

// What a fragment shows; cw2/render/view.h names them.
CW2_CONSTANT uint kViewShaded = 0;
CW2_CONSTANT uint kViewNormal = 1;
CW2_CONSTANT uint kViewVertexNormal = 2;
CW2_CONSTANT uint kViewViewDirection = 3;
CW2_CONSTANT uint kViewLightDirection = 4;
CW2_CONSTANT uint kViewDiffuse = 5;
CW2_CONSTANT uint kViewSpecular = 6;
CW2_CONSTANT uint kViewDistribution = 7;
CW2_CONSTANT uint kViewMasking = 8;
CW2_CONSTANT uint kViewFresnel = 9;
CW2_CONSTANT uint kViewBaseColor = 10;
CW2_CONSTANT uint kViewRoughness = 11;
CW2_CONSTANT uint kViewMetalness = 12;
CW2_CONSTANT uint kViewTangent = 13;
CW2_CONSTANT uint kViewBitangent = 14;
CW2_CONSTANT uint kViewUv = 15;
CW2_CONSTANT uint kViewAlphaMask = 16;
CW2_CONSTANT uint kViewEmission = 17;
CW2_CONSTANT uint kViewVertexColor = 18;
CW2_CONSTANT uint kViewCount = 19;
// Further values that can be read, though they make no picture.
CW2_CONSTANT uint kReadPosition = kViewCount;      // world
CW2_CONSTANT uint kReadMaterial = kViewCount + 1;  // index; whether it is unlit
// What DisplayConstants say, so that one pipeline serves every view.
CW2_CONSTANT uint kViewOfDisplay = kViewCount + 2;

#ifdef __cplusplus
static_assert(offsetof(SceneUniforms, cameraPosition) == 192);
static_assert(offsetof(SceneUniforms, ambientColor) == 240 && sizeof(SceneUniforms) == 256);
static_assert(offsetof(DrawConstants, base_color) == 32 && offsetof(DrawConstants, emission) == 48);
static_assert(sizeof(DrawConstants) == 84);
// Vulkan promises no more.
static_assert(kDisplayOffset + sizeof(DisplayConstants) <= 128);
static_assert(kDisplayOffset >= sizeof(DrawConstants) && kDisplayOffset % 16 == 0);
}  // namespace cw2::interop
#endif

#endif
