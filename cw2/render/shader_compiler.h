// GLSL to SPIR-V while the program runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "cw2/render/pipelines.h"

namespace cw2 {

/// GLSL that does not compile; what() is one line "PATH:LINE: what is wrong".
class ShaderError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// SPIR-V of the three shaders.
struct CompiledShaders {
    std::vector<std::uint32_t> vertex;
    std::vector<std::uint32_t> opaque_fragment;
    std::vector<std::uint32_t> alpha_mask_fragment;

    ShaderCode code() const { return {vertex, opaque_fragment, alpha_mask_fragment}; }
};

/// Compiles the shaders of `root`/shaders, as the build does; `root` is where their includes are
/// looked up too. Throws ShaderError, or common::FileError where a file cannot be read.
CompiledShaders compile_shaders(const std::filesystem::path& root);

}  // namespace cw2
