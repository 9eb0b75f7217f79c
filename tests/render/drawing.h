// Pictures of small scenes, made by the two programs as a user runs them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/image.h"

/// Writes the scenes of make_test_scenes into `folder`. Throws as those below do.
void make_test_scenes(const std::filesystem::path& folder);

/// Bakes `obj` beside itself, textures lossless unless the options say otherwise, and returns the
/// path of the baked file. Any message is an error.
std::filesystem::path bake_scene(const std::filesystem::path& obj,
                                 const std::vector<std::string>& options = {});

/// Draws `scene` with cw2's `options` into a file beside it and reads that; `extension` is ".png"
/// or
/// ".exr". Vulkan's validation layers watch, and any message is an error.
/// Both throw std::runtime_error with what the program printed.
Picture draw_scene(const std::filesystem::path& scene, const std::string& extension,
                   const std::vector<std::string>& options);
