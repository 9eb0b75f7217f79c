// KHR_draco_mesh_compression.
#pragma once

#include <set>

#include "cw2-bake/gltf/file.h"

namespace bake {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

/// Puts what Draco holds in place of the accessors of each triangle primitive of the meshes. Throws
/// BakeError with the JSON pointer for damaged data, and where Draco's library cannot be loaded.
void decode_draco(GltfFile& file, const std::set<int>& meshes);

}  // namespace bake
