// Pictures in a window, steered by keys and mouse.
#pragma once

#include <filesystem>

#include "cw2/options/options.h"

namespace cw2 {

/// Shows options.scene until the user ends it. `sources` is the repository's root, where the
/// shaders are reloaded from. Gives the exit status: 1 after any message of the validation layers,
/// else 0. Throws what its parts throw.
int run_window(const Options& options, const std::filesystem::path& sources);

}  // namespace cw2
