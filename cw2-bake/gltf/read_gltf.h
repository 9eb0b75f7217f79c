// glTF 2.0, .gltf and .glb, to a SourceScene.
#pragma once

#include <filesystem>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"

namespace bake {

/// Reads what the default scene's nodes show, else what all root nodes show: triangles, strips and
/// fans, in world space. Throws BakeError "PATH: /json/pointer: what is wrong" for what is
/// malformed, for an extension that is required and unknown, and where there is no triangle. What
/// else is left out is a warning; skins, morph targets and animations are, in their rest pose.
///
/// - Corners without normals get those of their triangles; given tangents are kept.
/// - UVs are turned to v up, and hold KHR_texture_transform.
/// - The first perspective camera and the first point light of KHR_lights_punctual (see
///   gltf_light.h) become the scene's.
/// - What it names is looked for as FileFinder does with `root`; an image outside counts as absent,
///   with a warning.
SourceScene read_gltf(const std::filesystem::path& path, const Warn& warn,
                      const std::filesystem::path& root = {});

}  // namespace bake
