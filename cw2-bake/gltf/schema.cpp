#include "cw2-bake/gltf/schema.h"

namespace bake {
namespace {

using Kind = JsonKind;
using Member = JsonMember;

constexpr bool kRequired = true;

// The parts of the schema of glTF 2.0 that the reader looks at (Khronos, glTF 2.0 specification,
// appendix "JSON Schema Reference"), and of three extensions.
constexpr Member kSparseIndices[] = {{"bufferView", Kind::index, kRequired, "bufferViews"},
                                     {"byteOffset", Kind::small},
                                     {"componentType", Kind::small, kRequired}};
constexpr Member kSparseValues[] = {{"bufferView", Kind::index, kRequired, "bufferViews"},
                                    {"byteOffset", Kind::small}};
constexpr Member kSparse[] = {{"count", Kind::small, kRequired},
                              {"indices", Kind::object, kRequired, {}, 0, kSparseIndices},
                              {"values", Kind::object, kRequired, {}, 0, kSparseValues}};
constexpr Member kAccessor[] = {{"bufferView", Kind::index, false, "bufferViews"},
                                {"byteOffset", Kind::count},
                                {"componentType", Kind::small, kRequired},
                                {"normalized", Kind::boolean},
                                {"count", Kind::count, kRequired},
                                {"type", Kind::text, kRequired},
                                {"sparse", Kind::object, false, {}, 0, kSparse}};
constexpr Member kFallback[] = {{"fallback", Kind::boolean}};
constexpr Member kBufferExtensions[] = {
    {"EXT_meshopt_compression", Kind::object, false, {}, 0, kFallback}};
constexpr Member kBuffer[] = {{"byteLength", Kind::count, kRequired},
                              {"uri", Kind::text},
                              {"extensions", Kind::object, false, {}, 0, kBufferExtensions}};
constexpr Member kMeshopt[] = {{"buffer", Kind::index, kRequired, "buffers"},
                               {"byteOffset", Kind::small},
                               {"byteLength", Kind::small, kRequired},
                               {"byteStride", Kind::small, kRequired},
                               {"count", Kind::small, kRequired},
                               {"mode", Kind::text, kRequired},
                               {"filter", Kind::text}};
constexpr Member kBufferViewExtensions[] = {
    {"EXT_meshopt_compression", Kind::object, false, {}, 0, kMeshopt}};
constexpr Member kBufferView[] = {
    {"buffer", Kind::index, kRequired, "buffers"},
    {"byteOffset", Kind::count},
    {"byteLength", Kind::count, kRequired},
    {"byteStride", Kind::count},
    {"extensions", Kind::object, false, {}, 0, kBufferViewExtensions}};
constexpr Member kDraco[] = {{"bufferView", Kind::index, kRequired, "bufferViews"},
                             {"attributes", Kind::ids, kRequired}};
constexpr Member kPrimitiveExtensions[] = {
    {"KHR_draco_mesh_compression", Kind::object, false, {}, 0, kDraco}};
constexpr Member kPrimitive[] = {{"attributes", Kind::lookup, kRequired, "accessors"},
                                 {"indices", Kind::index, false, "accessors"},
                                 {"material", Kind::index, false, "materials"},
                                 {"mode", Kind::small},
                                 {"targets", Kind::lookups, false, "accessors"},
                                 {"extensions", Kind::object, false, {}, 0, kPrimitiveExtensions}};
constexpr Member kMesh[] = {{"name", Kind::text},
                            {"primitives", Kind::objects, kRequired, {}, 0, kPrimitive},
                            {"weights", Kind::numbers}};
constexpr Member kSkin[] = {{"name", Kind::text},
                            {"joints", Kind::indices, kRequired, "nodes"},
                            {"inverseBindMatrices", Kind::index, false, "accessors"}};
constexpr Member kNodeLight[] = {{"light", Kind::small, kRequired}};
constexpr Member kNodeExtensions[] = {
    {"KHR_lights_punctual", Kind::object, false, {}, 0, kNodeLight}};
constexpr Member kNode[] = {{"name", Kind::text},
                            {"camera", Kind::index, false, "cameras"},
                            {"children", Kind::indices, false, "nodes"},
                            {"matrix", Kind::numbers, false, {}, 16},
                            {"mesh", Kind::index, false, "meshes"},
                            {"rotation", Kind::numbers, false, {}, 4},
                            {"scale", Kind::numbers, false, {}, 3},
                            {"skin", Kind::index, false, "skins"},
                            {"translation", Kind::numbers, false, {}, 3},
                            {"weights", Kind::numbers},
                            {"extensions", Kind::object, false, {}, 0, kNodeExtensions}};
constexpr Member kTransform[] = {{"offset", Kind::numbers, false, {}, 2},
                                 {"rotation", Kind::number},
                                 {"scale", Kind::numbers, false, {}, 2},
                                 {"texCoord", Kind::small}};
constexpr Member kTextureInfoExtensions[] = {
    {"KHR_texture_transform", Kind::object, false, {}, 0, kTransform}};
constexpr Member kTextureInfo[] = {
    {"index", Kind::index, kRequired, "textures"},
    {"texCoord", Kind::small},
    {"scale", Kind::number},
    {"extensions", Kind::object, false, {}, 0, kTextureInfoExtensions}};
constexpr Member kSurface[] = {
    {"baseColorFactor", Kind::numbers, false, {}, 4},
    {"baseColorTexture", Kind::object, false, {}, 0, kTextureInfo},
    {"metallicFactor", Kind::number},
    {"roughnessFactor", Kind::number},
    {"metallicRoughnessTexture", Kind::object, false, {}, 0, kTextureInfo}};
constexpr Member kStrength[] = {{"emissiveStrength", Kind::number}};
constexpr Member kMaterialExtensions[] = {
    {"KHR_materials_emissive_strength", Kind::object, false, {}, 0, kStrength},
    {"KHR_materials_unlit", Kind::object}};
constexpr Member kMaterial[] = {{"name", Kind::text},
                                {"pbrMetallicRoughness", Kind::object, false, {}, 0, kSurface},
                                {"normalTexture", Kind::object, false, {}, 0, kTextureInfo},
                                {"alphaMode", Kind::text},
                                {"alphaCutoff", Kind::number},
                                {"emissiveFactor", Kind::numbers, false, {}, 3},
                                {"emissiveTexture", Kind::object, false, {}, 0, kTextureInfo},
                                {"extensions", Kind::object, false, {}, 0, kMaterialExtensions},
                                {"doubleSided", Kind::boolean}};
constexpr Member kSampler[] = {{"wrapS", Kind::small}, {"wrapT", Kind::small}};
constexpr Member kWebp[] = {{"source", Kind::index, false, "images"}};
constexpr Member kTextureExtensions[] = {{"EXT_texture_webp", Kind::object, false, {}, 0, kWebp}};
constexpr Member kTexture[] = {{"sampler", Kind::index, false, "samplers"},
                               {"source", Kind::index, false, "images"},
                               {"extensions", Kind::object, false, {}, 0, kTextureExtensions}};
constexpr Member kImage[] = {{"name", Kind::text},
                             {"mimeType", Kind::text},
                             {"uri", Kind::text},
                             {"bufferView", Kind::index, false, "bufferViews"}};
constexpr Member kPerspective[] = {{"yfov", Kind::number, kRequired},
                                   {"znear", Kind::number, kRequired}};
constexpr Member kOrthographic[] = {{"xmag", Kind::number, kRequired},
                                    {"ymag", Kind::number, kRequired},
                                    {"zfar", Kind::number, kRequired},
                                    {"znear", Kind::number, kRequired}};
constexpr Member kCamera[] = {{"type", Kind::text, kRequired},
                              {"perspective", Kind::object, false, {}, 0, kPerspective},
                              {"orthographic", Kind::object, false, {}, 0, kOrthographic}};
constexpr Member kScene[] = {{"nodes", Kind::indices, false, "nodes"}};
constexpr Member kLight[] = {{"type", Kind::text, kRequired},
                             {"color", Kind::numbers, false, {}, 3},
                             {"intensity", Kind::number}};
constexpr Member kLights[] = {{"lights", Kind::objects, false, {}, 0, kLight}};
constexpr Member kExtensions[] = {{"KHR_lights_punctual", Kind::object, false, {}, 0, kLights}};
constexpr Member kRoot[] = {{"accessors", Kind::objects, false, {}, 0, kAccessor},
                            {"buffers", Kind::objects, false, {}, 0, kBuffer},
                            {"bufferViews", Kind::objects, false, {}, 0, kBufferView},
                            {"meshes", Kind::objects, false, {}, 0, kMesh},
                            {"nodes", Kind::objects, false, {}, 0, kNode},
                            {"skins", Kind::objects, false, {}, 0, kSkin},
                            {"materials", Kind::objects, false, {}, 0, kMaterial},
                            {"textures", Kind::objects, false, {}, 0, kTexture},
                            {"samplers", Kind::objects, false, {}, 0, kSampler},
                            {"images", Kind::objects, false, {}, 0, kImage},
                            {"cameras", Kind::objects, false, {}, 0, kCamera},
                            {"scenes", Kind::objects, false, {}, 0, kScene},
                            {"scene", Kind::index, false, "scenes"},
                            {"extensionsUsed", Kind::texts},
                            {"extensionsRequired", Kind::texts},
                            {"extensions", Kind::object, false, {}, 0, kExtensions}};

}  // namespace

std::span<const JsonMember> gltf_schema() {
    return kRoot;
}

}  // namespace bake
