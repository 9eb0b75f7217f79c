#include "cw2-bake/gltf/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/gltf/schema.h"

namespace bake {
namespace {

using nlohmann::json;

constexpr std::int64_t kLargestCount = std::int64_t{1} << 40;
constexpr std::int64_t kLargestInt = 0x7FFF'FFFF;
constexpr int kDeepest = 64;

using Kind = JsonKind;
using Member = JsonMember;

constexpr std::string_view kKnownExtensions[] = {"KHR_texture_transform",
                                                 "KHR_mesh_quantization",
                                                 "KHR_lights_punctual",
                                                 "EXT_texture_webp",
                                                 "EXT_meshopt_compression",
                                                 "KHR_draco_mesh_compression",
                                                 "KHR_materials_emissive_strength",
                                                 "KHR_materials_unlit"};

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
                if (member.length > 0 && value.size() != member.length)
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
                return check_lookup(value, member, pointer);
            case Kind::ids:
                if (!value.is_object()) fail(pointer, "is no object");
                for (auto& [key, id] : value.items())
                    check_value(id, {nullptr, Kind::small}, pointer + '/' + key);
                return;
            case Kind::lookups:
                return elements(value, pointer,
                                [&](json& e, const auto& at) { check_lookup(e, member, at); });
        }
    }

    void check_lookup(json& lookup, const Member& member, const std::string& pointer) const {
        if (!lookup.is_object()) fail(pointer, "is no object");
        for (auto& [key, index] : lookup.items()) check_index(index, member, pointer + '/' + key);
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

/// The first number of a JSON text that no double holds; empty if there is none.
std::string_view find_huge_number(std::string_view text) {
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string && c == '\\') ++i;
        if (c == '"') in_string = !in_string;
        if (in_string || !(c == '-' || (c >= '0' && c <= '9'))) continue;
        const std::size_t end = std::min(text.find_first_not_of("+-.0123456789eE", i), text.size());
        const std::string_view number = text.substr(i, end - i);
        if (std::isinf(std::strtod(std::string(number).c_str(), nullptr))) return number;
        i = end - 1;
    }
    return {};
}

json parse_json(std::string_view text, const std::filesystem::path& path) {
    std::size_t at = 0;
    std::string problem;
    try {
        return json::parse(text);
    } catch (const json::parse_error& error) {
        at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
        problem = "unexpected " + (at < text.size() ? in_quotes(text.substr(at, 1)) : "end");
    } catch (const json::out_of_range&) {
        const std::string_view number = find_huge_number(text);
        at = number.empty() ? 0 : static_cast<std::size_t>(number.data() - text.data());
        problem = fmt::format("the number {} is too large", number);
    }
    throw BakeError(
        fmt::format("{}:{}: is no JSON: {}", path.string(), line_number(text, at), problem));
}

/// What it is at all comes first: all else of an older glTF looks malformed.
void check_version(json& root, const Checker& checker) {
    if (!root.is_object()) checker.fail("", "is no object");
    const auto asset = root.find("asset");
    const bool has_asset = asset != root.end() && asset->is_object();
    const auto meshes = root.find("meshes");
    // Version 1 may go without an asset, and has objects where version 2 has arrays.
    if ((!has_asset || !asset->contains("version")) && meshes != root.end() && meshes->is_object())
        checker.fail("/asset/version", "is missing, so this is glTF 1.0; only 2.0 is read");
    if (!has_asset) checker.fail("", "has no asset");
    const auto version = asset->find("version");
    if (version == asset->end()) checker.fail("/asset", "has no version");
    if (version->is_number()) *version = fmt::format("{:.1f}", version->get<double>());
    if (!version->is_string()) checker.fail("/asset/version", "is no string");
    const auto& text = version->get_ref<const std::string&>();
    if (text == "2" || text.starts_with("2.")) return;
    const bool is_version = !text.empty() && text.find_first_not_of("0123456789.") == text.npos;
    checker.fail("/asset/version",
                 fmt::format("is glTF {}; only 2.0 is read", is_version ? text : in_quotes(text)));
}

/// Whether every texture of a KTX2 has another image, too, so that none is lacked.
bool has_images_beside_ktx2(const json& root) {
    const auto textures = root.find("textures");
    return textures == root.end() || std::ranges::all_of(*textures, [](const json& texture) {
               const auto extensions = texture.find("extensions");
               return extensions == texture.end() || !extensions->contains(kBasisuExtension) ||
                      texture.contains("source");
           });
}

void check_required_extensions(const json& root, const Checker& checker) {
    const auto required = root.find("extensionsRequired");
    if (required == root.end()) return;
    for (std::size_t i = 0; i < required->size(); ++i) {
        const std::string& name = (*required)[i].get_ref<const std::string&>();
        if (is_known_extension(name)) continue;
        if (name == kBasisuExtension && has_images_beside_ktx2(root)) continue;
        checker.fail(fmt::format("/extensionsRequired/{}", i),
                     fmt::format("the extension {} is not supported{}", in_quotes(name),
                                 name == kBasisuExtension ? ": KTX2 textures are not read" : ""));
    }
}

void check_hierarchy(const json& root, const Checker& checker) {
    constexpr std::size_t kNone = ~std::size_t{0};
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
    each("cameras", [&](const json& camera, const std::string& pointer) {
        const auto& type = camera["type"].get_ref<const std::string&>();
        if (type != "perspective" && type != "orthographic")
            checker.fail(pointer + "/type", fmt::format("is {}, which is none", in_quotes(type)));
        if (!camera.contains(type)) checker.fail(pointer, "has no " + type);
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
    json root = parse_json(text, path);
    Checker checker(root, path);
    check_version(root, checker);
    checker.check(root, gltf_schema(), "");
    check_required_extensions(root, checker);
    check_enumerations(root, checker);
    check_hierarchy(root, checker);
    return root;
}

}  // namespace bake
