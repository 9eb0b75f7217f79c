// Which way is up.
#pragma once

#include "cw2-bake/base/source_scene.h"

namespace bake {

/// Turns a scene whose up is +Z so that it is +Y: (x, y, z) becomes (x, z, -y).
void turn_z_up(SourceScene& scene);

}  // namespace bake
