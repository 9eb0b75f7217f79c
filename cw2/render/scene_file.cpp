#include "cw2/render/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <string>

#include "common/lfs_pointer.h"
#include "cw2/render/vertex_positions.h"

namespace cw2 {

namespace {

void read(SceneFile& file, std::span<const std::byte> bytes, const std::string& name) {
    file.document = mesh_format::parse(bytes, name);
    file.decoded = mesh_format::decode(file.document, name);
    file.positions = vertex_positions(file.document);
    file.bounds = bounds_of(file.document.scene, file.positions);
    file.start = start_of(file.document.scene);
}

}  // namespace

SceneFile load_scene_file(const std::filesystem::path& path) {
    SceneFile file;
    file.mapped.emplace(path);
    read(file, file.mapped->bytes(), path.string());
    return file;
}

SceneFile reload_scene_file(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary | std::ios::ate);
    const auto size = static_cast<std::streamoff>(stream.tellg());
    SceneFile file;
    file.bytes.resize(static_cast<std::size_t>(std::max<std::streamoff>(size, 0)));
    stream.seekg(0);
    if (!stream.read(reinterpret_cast<char*>(file.bytes.data()),
                     static_cast<std::streamsize>(size))) {
        throw common::FileError(fmt::format("{}: cannot be read", path.string()));
    }
    if (common::is_lfs_pointer(file.bytes)) {
        throw common::FileError(fmt::format("{}: {}", path.string(), common::kIsLfsPointer));
    }
    read(file, file.bytes, path.string());
    return file;
}

}  // namespace cw2
