// Pictures to files and pixels to numbers, with no display and no window system.
#pragma once

#include "cw2/options/options.h"
#include "cw2/vulkan/device.h"

namespace cw2 {

/// Renders options.scene to options.output, or to a file for each of options.frames, and prints
/// what options.pixel shows. Throws what its parts throw; then the file at hand is not written, and
/// no file of statistics.
void render_headless(const Device& device, const Options& options);

}  // namespace cw2
