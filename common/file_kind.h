// Which files are scenes, told by their names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace common {

/// The last extension of a file's name, its dot included, in small letters; empty if it has none.
std::string lower_extension(const std::filesystem::path& path);

enum class FileKind {
    obj,    ///< .obj
    gltf,   ///< .gltf, .glb
    baked,  ///< .cw2mesh
};

/// By the extension, in any case; nothing where it is that of none.
std::optional<FileKind> file_kind(const std::filesystem::path& path);

}  // namespace common
