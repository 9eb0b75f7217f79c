// A baked scene on the host.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/io.h"
#include "cw2/render/camera.h"
#include "mesh-format/decode.h"
#include "mesh-format/file.h"

namespace cw2 {

/// A .cw2mesh file: read, checked and decoded. What refers to it stays good when it is moved.
struct SceneFile {
    std::optional<common::MappedFile> mapped;
    std::vector<std::byte> bytes;  ///< of a file that is not mapped
    std::string name;              ///< for messages
    mesh_format::Document document;
    mesh_format::DecodedGeometry decoded;
    std::vector<glm::vec3> positions;  ///< of all vertices, mesh after mesh
    Bounds bounds;                     ///< refers to the positions
    SceneStart start;

    /// What is mapped of these bytes is not needed in memory for now.
    void forget(std::span<const std::byte> part) const;
};

/// Throws common::FileError or mesh_format::FormatError.
SceneFile load_scene_file(const std::filesystem::path& path);

/// The same for a window, which must not end when somebody cuts off bytes that it has mapped: the
/// file is read.
SceneFile read_scene_file(const std::filesystem::path& path);

/// Throws the common::FileError of those above for a lack of memory.
[[noreturn]] void refuse_for_memory(const std::filesystem::path& path);

}  // namespace cw2
