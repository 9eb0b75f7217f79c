// Equal values to equal indices.
#pragma once

#include "cw2-bake/base/source_scene.h"

namespace bake {

/// Makes corners equal in their indices where they are equal in their values: each then refers to
/// the first position, normal and UV of its value. A corner with no UV gets one of (0, 0), which
/// joins the scene's. Every corner has a normal (see normals.h); nothing else changes.
void weld(SourceScene& scene);

}  // namespace bake
