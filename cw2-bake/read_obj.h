// Wavefront OBJ and MTL to a SourceScene.
#pragma once

#include <filesystem>

#include "cw2-bake/diagnostics.h"
#include "cw2-bake/source_scene.h"

namespace bake {

/// Reads an OBJ and the MTLs it names. Throws BakeError, with the line, for what cannot be read:
/// no such file, no faces, an index out of range, a number that is not finite, a malformed
/// statement. A missing MTL or material is a warning.
SourceScene read_obj(const std::filesystem::path& path, const Warn& warn);

}  // namespace bake
