// The JSON of a glTF 2.0 file, held against what the reader relies on.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

namespace bake {

/// Throws BakeError "PATH: /json/pointer: what is wrong".
[[noreturn]] void fail_at(const std::filesystem::path& path, std::string_view pointer,
                          std::string_view what);

/// Of textures whose image is a KTX2; not read.
inline constexpr std::string_view kBasisuExtension = "KHR_texture_basisu";

/// Whether the reader does what the extension says.
bool is_known_extension(std::string_view name);

/// Parses and checks. Afterwards: every member that the reader uses has its type (integers as
/// integers), every index points into its array, counts and offsets are below 2^40, nothing is
/// nested deeper than 64 levels, a node has one parent at most and is no descendant of itself, and
/// no extension is required beside those that the reader knows. Throws BakeError, with the JSON
/// pointer, for anything else.
nlohmann::json parse_gltf_json(std::string_view text, const std::filesystem::path& path);

}  // namespace bake
