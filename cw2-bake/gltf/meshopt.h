// EXT_meshopt_compression.
#pragma once

#include <cstddef>
#include <vector>

#include "cw2-bake/gltf/file.h"

namespace bake {

inline constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";

/// The contents of a buffer view that the extension compresses. Throws BakeError with the JSON
/// pointer for a damaged stream, and for what the extension does not allow.
std::vector<std::byte> decode_meshopt(const GltfFile& file, std::size_t view);

}  // namespace bake
