// Inputs that would be the undoing of a careless reader, in any size.
#pragma once

#include <filesystem>
#include <vector>

struct Input {
    const char* name;
    /// Writes files of about `n` of what makes it hard into an empty folder; returns the scene's.
    std::filesystem::path (*write)(const std::filesystem::path& folder, int n);
    int n;  ///< that takes about a million instructions
};

std::vector<Input> obj_inputs();
/// A sheet of n squares a side, and others of which little is missing.
std::vector<Input> nearly_whole_inputs();
/// Meshes whose nodes take turns, and morph targets, are not here: the numbers that they make a
/// bake read have a bound that does not grow with small files; see GltfPrimitives::expect_node().
std::vector<Input> gltf_inputs();
