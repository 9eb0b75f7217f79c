// What a glTF says of where a viewer starts: its camera and its light.
#pragma once

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/gltf/file.h"
#include "cw2-bake/gltf/nodes.h"

namespace bake {

/// Sets the camera to the first in perspective that is shown, and the light to the first that
/// is, a directional one far away (see light.h for its brightness). The scene must have positions.
/// Warns of what cannot be as the file says it.
void take_camera_and_light(const GltfFile& file, const GltfNodes& nodes, const Warn& warn,
                           SourceScene& scene);

}  // namespace bake
