// Writes the demo scene.
#pragma once

#include <filesystem>

namespace assets {

/// Writes courtyard.obj, courtyard.mtl and textures/*.png into `directory`, which is made if it is
/// missing. The bytes depend on nothing but this code. Throws std::runtime_error where a file
/// cannot be written.
void write_demo_scene(const std::filesystem::path& directory);

}  // namespace assets
