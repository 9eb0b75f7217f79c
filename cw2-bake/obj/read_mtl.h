// Wavefront MTL to source materials.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"

namespace bake {

/// Reads the materials of an MTL for whose name `wanted` answers true; of two with one name the
/// first. Throws common::FileError if the file cannot be read, and BakeError, with the line,
/// for a malformed number. Warns of what is out of range or left out.
///
/// - Kd, map_Kd -> base colour: the factor is 1 beside a map where it is black or not stated.
/// - Pr, map_Pr -> roughness; with neither, from Ns: (2 / (Ns + 2))^(1/4), the alpha whose
///   Blinn-Phong exponent 2 / alpha^4 - 2 is Ns.
/// - Pm, map_Pm -> metalness. A map without its factor has factor 1, a stated factor multiplies.
/// - norm -> normal map; map_Bump, bump (-bm) -> bump map; map_d -> alpha map.
/// - d, Tr below opaque with no map_d: drawn opaque, with one warning for the file.
/// - Texture options -clamp, -imfchan and -bm are honoured, the others named in one warning.
std::vector<SourceMaterial> read_mtl(const std::filesystem::path& path,
                                     const std::function<bool(std::string_view)>& wanted,
                                     const Warn& warn);

}  // namespace bake
