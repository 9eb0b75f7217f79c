// One picture to a file, with no display and no window system.
#pragma once

#include "cw2/device.h"
#include "cw2/options.h"

namespace cw2 {

/// Renders options.scene to options.output. Throws what its parts throw; then no file is written.
void render_to_file(const Device& device, const Options& options);

}  // namespace cw2
