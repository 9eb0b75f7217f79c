// Wavefront MTL to source materials.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/file_finder.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/obj/texture_statement.h"

namespace bake {

/// A material, and what it says of the geometry that uses it.
struct MtlMaterial {
    SourceMaterial source;
    MtlTransform transform;     ///< of the UVs, for all its images
    bool states_color = false;  ///< Kd or map_Kd
};

/// Reads the materials of an MTL for whose name `wanted` answers true; of two with one name the
/// first. Throws common::FileError if the file cannot be read. Nothing in it is an error: what is
/// out of range is clamped, what should be a finite number and is none leaves its property at the
/// default, and what changes the look and is not read is left out, each with one warning a kind,
/// with the first place and the number of materials.
///
/// - Kd, map_Kd -> base colour: the factor is 1 beside a map where it is black or not stated.
/// - Pr, map_Pr -> roughness; with neither, from Ns: (2 / (Ns + 2))^(1/4), the alpha whose
///   Blinn-Phong exponent 2 / alpha^4 - 2 is Ns.
/// - Pm, map_Pm -> metalness. A map without its factor has factor 1, a stated factor multiplies.
/// - map_RMA (roughness, metalness, occlusion), map_ORM (occlusion, roughness, metalness) -> the
///   two of them that have no map of their own.
/// - norm, map_Kn (-bm) -> normal map; map_Bump, bump (-bm) -> bump map; map_d -> alpha map.
/// - Ke, map_Ke (map_emissive) -> emission, with factors as those of the base colour.
/// - d, Tr below opaque with no map_d: blend and opacity, with one warning for the file, since
///   it is drawn opaque.
/// - Ka, Ks, Ni, illum 0 to 2, and what states its neutral value (Tf 1 1 1, Pc 0) say nothing.
/// - An image that is outside of where the finder looks counts as absent, with a warning.
/// - Texture options -s, -o, -clamp, -imfchan and -bm are honoured.
std::vector<MtlMaterial> read_mtl(const std::filesystem::path& path,
                                  const std::function<bool(std::string_view)>& wanted,
                                  FileFinder& finder, const Warn& warn);

}  // namespace bake
