#include "cw2-bake/gltf/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cw2-bake/base/text_lines.h"

namespace bake {
namespace {

using nlohmann::json;

constexpr std::int64_t kLargestCount = std::int64_t{1} << 40;
constexpr std::int64_t kLargestInt = 0x7FFF'FFFF;
constexpr int kDeepest = 64;

enum class Kind : std::uint8_t {
    index,    ///< into the top-level array `target`
    count,    ///< 0 .. kLargestCount
    small,    ///< 0 .. kLargestInt: where tinygltf has an int, and cuts off what does not fit
    number,   ///< finite
    numbers,  ///< an array of `length` numbers
    boolean,
    text,
    object,   ///< of `members`
    objects,  ///< an array of such
    indices,  ///< an array of indices
    lookup,   ///< an object whose members are indices
    texts,    ///< an array of texts
};

struct Member {
    const char* name;
    Kind kind;
    bool required = false;
    const char* target = nullptr;
    std::size_t length = 0;
    std::span<const Member> members{};
};

constexpr bool kRequired = true;

// The parts of the schema of glTF 2.0 that the reader looks at (Khronos, glTF 2.0 specification,
// appendix "JSON Schema Reference"), and of three extensions.
constexpr Member kAsset[] = {{"version", Kind::text, kRequired}};
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
constexpr Member kBuffer[] = {{"byteLength", Kind::count, kRequired}, {"uri", Kind::text}};
constexpr Member kBufferView[] = {{"buffer", Kind::index, kRequired, "buffers"},
                                  {"byteOffset", Kind::count},
                                  {"byteLength", Kind::count, kRequired},
                                  {"byteStride", Kind::count}};
constexpr Member kPrimitive[] = {{"attributes", Kind::lookup, kRequired, "accessors"},
                                 {"indices", Kind::index, false, "accessors"},
                                 {"material", Kind::index, false, "materials"},
                                 {"mode", Kind::small}};
constexpr Member kMesh[] = {{"name", Kind::text},
                            {"primitives", Kind::objects, kRequired, {}, 0, kPrimitive}};
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
                            {"translation", Kind::numbers, false, {}, 3},
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
constexpr Member kMaterial[] = {{"name", Kind::text},
                                {"pbrMetallicRoughness", Kind::object, false, {}, 0, kSurface},
                                {"normalTexture", Kind::object, false, {}, 0, kTextureInfo},
                                {"alphaMode", Kind::text},
                                {"alphaCutoff", Kind::number},
                                {"emissiveFactor", Kind::numbers, false, {}, 3},
                                {"doubleSided", Kind::boolean}};
constexpr Member kSampler[] = {{"wrapS", Kind::small}, {"wrapT", Kind::small}};
constexpr Member kWebp[] = {{"source", Kind::index, false, "images"}};
constexpr Member kTextureExtensions[] = {{"EXT_texture_webp", Kind::object, false, {}, 0, kWebp}};
constexpr Member kTexture[] = {{"sampler", Kind::index, false, "samplers"},
                               {"source", Kind::index, false, "images"},
                               {"extensions", Kind::object, false, {}, 0, kTextureExtensions}};
constexpr Member kImage[] = {
    {"name", Kind::text}, {"uri", Kind::text}, {"bufferView", Kind::index, false, "bufferViews"}};
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
constexpr Member kRoot[] = {{"asset", Kind::object, kRequired, {}, 0, kAsset},
                            {"accessors", Kind::objects, false, {}, 0, kAccessor},
                            {"buffers", Kind::objects, false, {}, 0, kBuffer},
                            {"bufferViews", Kind::objects, false, {}, 0, kBufferView},
                            {"meshes", Kind::objects, false, {}, 0, kMesh},
                            {"nodes", Kind::objects, false, {}, 0, kNode},
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

constexpr std::string_view kKnownExtensions[] = {"KHR_texture_transform", "KHR_mesh_quantization",
                                                 "KHR_lights_punctual", "EXT_texture_webp"};

class Checker {
 public:
    Checker(json& root, const std::filesystem::path& path) : root_(root), path_(path) {}

    void check(json& object, std::span<const Member> members, const std::string& pointer) {
        if (!object.is_object()) fail(pointer, "is no object");
        for (const Member& member : members) {
            const auto found = object.find(member.name);
            if (found == object.end()) {
                if (member.required) fail(pointer, fmt::format("has no {}", member.name));
                continue;
            }
            check_value(*found, member, pointer + '/' + member.name);
        }
    }

    [[noreturn]] void fail(const std::string& pointer, const std::string& what) const {
        fail_at(path_, pointer, what);
    }

 private:
    void check_value(json& value, const Member& member, const std::string& pointer) {
        switch (member.kind) {
            case Kind::index:
                return check_index(value, member, pointer);
            case Kind::count:
                if (integer(value, pointer) > kLargestCount) fail(pointer, "is absurdly large");
                return;
            case Kind::small:
                if (integer(value, pointer) > kLargestInt) fail(pointer, "is absurdly large");
                return;
            case Kind::number:
                return check_number(value, pointer);
            case Kind::numbers:
                elements(value, pointer, [&](json& e, const auto& at) { check_number(e, at); });
                if (value.size() != member.length)
                    fail(pointer, fmt::format("is not of {} numbers", member.length));
                return;
            case Kind::boolean:
                if (!value.is_boolean()) fail(pointer, "is neither true nor false");
                return;
            case Kind::text:
                if (!value.is_string()) fail(pointer, "is no string");
                return;
            case Kind::texts:
                return elements(value, pointer, [&](json& e, const auto& at) {
                    if (!e.is_string()) fail(at, "is no string");
                });
            case Kind::object:
                return check(value, member.members, pointer);
            case Kind::objects:
                return elements(value, pointer,
                                [&](json& e, const auto& at) { check(e, member.members, at); });
            case Kind::indices:
                return elements(value, pointer,
                                [&](json& e, const auto& at) { check_index(e, member, at); });
            case Kind::lookup:
                if (!value.is_object()) fail(pointer, "is no object");
                for (auto& [key, index] : value.items())
                    check_index(index, member, pointer + '/' + key);
                return;
        }
    }

    template <typename Check>
    void elements(json& array, const std::string& pointer, Check&& check_element) const {
        if (!array.is_array()) fail(pointer, "is no array");
        for (std::size_t i = 0; i < array.size(); ++i)
            check_element(array[i], pointer + '/' + std::to_string(i));
    }

    void check_number(const json& value, const std::string& pointer) const {
        if (!value.is_number() || !std::isfinite(value.get<double>()))
            fail(pointer, "is no finite number");
    }

    /// JSON knows one kind of number: 3.0 is an integer, and becomes one.
    std::int64_t integer(json& value, const std::string& pointer) const {
        const double number = value.is_number() ? value.get<double>() : -1.0;
        if (!(number >= 0.0) || number != std::floor(number)) fail(pointer, "is no whole number");
        if (number > 1e15) fail(pointer, "is absurdly large");
        value = static_cast<std::int64_t>(number);
        return value.get<std::int64_t>();
    }

    void check_index(json& value, const Member& member, const std::string& pointer) const {
        const std::int64_t index = integer(value, pointer);
        const auto array = root_.find(member.target);
        const std::size_t size = array != root_.end() && array->is_array() ? array->size() : 0;
        if (static_cast<std::size_t>(index) >= size) {
            fail(pointer, fmt::format("is {}, but there are {} {}", index, size, member.target));
        }
    }

    json& root_;
    const std::filesystem::path& path_;
};

/// The parser takes any depth, but what handles its result descends by recursion.
void check_depth(std::string_view text, const std::filesystem::path& path) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest) {
                throw BakeError(fmt::format("{}:{}: is nested deeper than {} levels", path.string(),
                                            line_number(text, i), kDeepest));
            }
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
}

void check_versions(const json& root, const Checker& checker) {
    const std::string& version = root["asset"]["version"].get_ref<const std::string&>();
    if (version != "2" && !version.starts_with("2."))
        checker.fail("/asset/version", fmt::format("is {}, not 2.0", in_quotes(version)));
    const auto required = root.find("extensionsRequired");
    if (required == root.end()) return;
    for (std::size_t i = 0; i < required->size(); ++i) {
        const std::string& name = (*required)[i].get_ref<const std::string&>();
        if (is_known_extension(name)) continue;
        checker.fail(fmt::format("/extensionsRequired/{}", i),
                     fmt::format("the extension {} is not supported", in_quotes(name)));
    }
}

constexpr std::size_t kNone = ~std::size_t{0};

/// A node that a scene showed twice would show all below it twice, and so on down: a small file
/// would claim all memory.
void check_scenes(const json& root, const std::vector<std::size_t>& parents,
                  const Checker& checker) {
    const auto scenes = root.find("scenes");
    for (std::size_t i = 0; scenes != root.end() && i < scenes->size(); ++i) {
        const json nodes = (*scenes)[i].value("nodes", json::array());
        std::vector<bool> met(parents.size(), false);
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const auto node = nodes[k].get<std::size_t>();
            const std::string pointer = fmt::format("/scenes/{}/nodes/{}", i, k);
            if (parents[node] != kNone) checker.fail(pointer, "is a child of another node");
            if (met[node]) checker.fail(pointer, fmt::format("is node {} again", node));
            met[node] = true;
        }
    }
}

void check_hierarchy(const json& root, const Checker& checker) {
    const auto nodes = root.find("nodes");
    if (nodes == root.end()) return;
    std::vector<std::size_t> parents(nodes->size(), kNone);
    for (std::size_t i = 0; i < nodes->size(); ++i) {
        const auto children = (*nodes)[i].find("children");
        if (children == (*nodes)[i].end()) continue;
        for (std::size_t c = 0; c < children->size(); ++c) {
            std::size_t& parent = parents[(*children)[c].get<std::size_t>()];
            if (parent != kNone) {
                checker.fail(fmt::format("/nodes/{}/children/{}", i, c),
                             fmt::format("is a child of node {}, too", parent));
            }
            parent = i;
        }
    }
    // Each way up ends at a root or at a node whose way up is known to end.
    std::vector<bool> ends(nodes->size(), false);
    for (std::size_t i = 0; i < nodes->size(); ++i) {
        std::size_t steps = 0;
        std::size_t node = i;
        for (; node != kNone && !ends[node]; node = parents[node]) {
            if (++steps > nodes->size())
                checker.fail(fmt::format("/nodes/{}", node), "is its own descendant");
        }
        for (node = i; node != kNone && !ends[node]; node = parents[node]) ends[node] = true;
    }
    check_scenes(root, parents, checker);
}

/// What tinygltf refuses, or takes for something else, with a message that names no place.
void check_enumerations(const json& root, const Checker& checker) {
    constexpr int kComponentTypes[] = {5120, 5121, 5122, 5123, 5125, 5126};
    constexpr std::string_view kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4",
                                           "MAT2",   "MAT3", "MAT4"};
    const auto each = [&](const char* array, auto&& check_element) {
        const auto found = root.find(array);
        for (std::size_t i = 0; found != root.end() && i < found->size(); ++i)
            check_element((*found)[i], fmt::format("/{}/{}", array, i));
    };
    each("accessors", [&](const json& accessor, const std::string& pointer) {
        const int type = accessor["componentType"].get<int>();
        if (std::ranges::find(kComponentTypes, type) == std::end(kComponentTypes))
            checker.fail(pointer + "/componentType", fmt::format("is {}, which is none", type));
        const auto& shape = accessor["type"].get_ref<const std::string&>();
        if (std::ranges::find(kTypes, shape) == std::end(kTypes))
            checker.fail(pointer + "/type", fmt::format("is {}, which is none", in_quotes(shape)));
        if (accessor["count"] == 0) checker.fail(pointer + "/count", "is 0");
    });
    each("bufferViews", [&](const json& view, const std::string& pointer) {
        const auto stride = view.value("byteStride", std::int64_t{4});
        if (stride < 4 || stride > 252 || stride % 4 != 0) {
            checker.fail(pointer + "/byteStride",
                         fmt::format("is {}, no multiple of 4 from 4 to 252", stride));
        }
    });
}

}  // namespace

bool is_known_extension(std::string_view name) {
    return std::ranges::find(kKnownExtensions, name) != std::end(kKnownExtensions);
}

void fail_at(const std::filesystem::path& path, std::string_view pointer, std::string_view what) {
    throw BakeError(
        fmt::format("{}: {}: {}", path.string(), pointer.empty() ? "/" : pointer, what));
}

json parse_gltf_json(std::string_view text, const std::filesystem::path& path) {
    check_depth(text, path);
    json root;
    try {
        root = json::parse(text);
    } catch (const json::parse_error& error) {
        const std::size_t at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
        throw BakeError(fmt::format("{}:{}: is no JSON: unexpected {}", path.string(),
                                    line_number(text, at),
                                    at < text.size() ? in_quotes(text.substr(at, 1)) : "end"));
    }
    Checker checker(root, path);
    checker.check(root, kRoot, "");
    check_versions(root, checker);
    check_enumerations(root, checker);
    check_hierarchy(root, checker);
    return root;
}

}  // namespace bake
