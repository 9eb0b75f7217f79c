// The bake: the order of its stages.
#pragma once

#include <string>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/settings.h"

namespace bake {

/// Bakes settings.input into settings.output and returns the closing summary. Throws BakeError or
/// common::FileError; the output is then as it was.
std::string bake(const Settings& settings, const Warn& warn);

/// Writes settings.input, a .cw2mesh file, as a glTF to settings.output and returns a summary.
/// Throws as bake() does.
std::string export_baked(const Settings& settings, const Warn& warn);

}  // namespace bake
