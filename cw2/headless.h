// Pictures to files and pixels to numbers, with no display and no window system.
#pragma once

#include "cw2/options/options.h"

namespace cw2 {

/// Renders options.scene to options.output, or to a file for each of options.frames, and prints
/// what options.pixel shows. Throws what its parts throw; then the file at hand is not written, and
/// no file of statistics. Returns the program's exit status: 1 after messages of the validation
/// layers.
int render_headless(const Options& options);

}  // namespace cw2
