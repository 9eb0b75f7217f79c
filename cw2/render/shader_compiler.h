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

/// SPIR-V of the shaders.
struct CompiledShaders {
    PerShader<std::vector<std::uint32_t>> words;

    ShaderCode code() const {
        ShaderCode code;
        for (std::size_t i = 0; i < code.size(); ++i) {
            code[i] = {words[i][false], words[i][true]};
        }
        return code;
    }
};

/// Compiles the shaders of `root`/shaders, as the build does; `root` is where their includes are
/// looked up too. Throws ShaderError, or common::FileError where a file cannot be read.
CompiledShaders compile_shaders(const std::filesystem::path& root);

}  // namespace cw2
