// The files that a bake reads, and what depends on knowing them.
#pragma once

#include <filesystem>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/settings.h"

namespace bake {

/// The source, the files it names, and the images of its materials that exist, each once, in the
/// order in which they are met.
std::vector<std::filesystem::path> input_files(const SourceScene& scene);

/// Throws BakeError where the output, or what --stats or --depfile name, is one of `inputs`, or
/// where two of them are one file.
void refuse_overwriting(const Settings& settings, const std::vector<std::filesystem::path>& inputs);

/// Writes the rule "output: inputs" for make and ninja. Throws BakeError for a name that make
/// cannot take (one with a line break), and common::FileError.
void write_depfile(const std::filesystem::path& depfile, const std::filesystem::path& output,
                   const std::vector<std::filesystem::path>& inputs);

}  // namespace bake
