#include "common/file_kind.h"

#include <algorithm>

namespace common {

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : static_cast<char>(c);
    });
    return extension;
}

std::optional<FileKind> file_kind(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    if (extension == ".obj") return FileKind::obj;
    if (extension == ".gltf" || extension == ".glb") return FileKind::gltf;
    if (extension == ".cw2mesh") return FileKind::baked;
    return std::nullopt;
}

}  // namespace common
