// The files that a bake reads, and what depends on knowing them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/settings.h"

namespace bake {

/// The source, the files it names, and the images of its materials; each once, in the order in
/// which they are met. Some may be missing; none that is not asked for.
std::vector<std::filesystem::path> input_files(const SourceScene& scene, const Settings& settings);

/// Throws BakeError where the output, or what --stats or --depfile name, is one of `inputs`, or
/// where two of them are one file.
void refuse_overwriting(const Settings& settings, const std::vector<std::filesystem::path>& inputs);

/// Throws common::FileError where one of them cannot be written, unless the input is missing, which
/// is worth more to know.
void require_writable(const Settings& settings);

/// The rule "output: inputs" for make and ninja, and for make an empty rule for all inputs but the
/// first: one that is missing makes the output stale, and is no error. Throws BakeError for a name
/// that make or ninja would take for something else. `inputs` is not empty.
std::string depfile_text(const std::filesystem::path& output,
                         const std::vector<std::filesystem::path>& inputs);

/// Throws common::FileError.
void write_depfile(const std::filesystem::path& depfile, const std::string& text);

}  // namespace bake
