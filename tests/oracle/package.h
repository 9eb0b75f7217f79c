// Runs the npm package `mikktspace` over meshes, by mikktspace.mjs.
#pragma once

#include <filesystem>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "tests/oracle/corner_mesh.h"

namespace oracle {

using Tangents = std::vector<glm::vec4>;  ///< one a corner

struct Package {
    std::string node;           ///< the executable
    std::string script;         ///< mikktspace.mjs
    std::filesystem::path dir;  ///< holds node_modules
};

struct PackageResult {
    std::vector<Tangents> tangents;    ///< of each mesh
    std::vector<double> milliseconds;  ///< the package's own time for it
};

/// Leaves its files in `work_dir`. Throws std::runtime_error if Node fails.
PackageResult run_package(const Package& package, const std::vector<CornerMesh>& meshes,
                          const std::filesystem::path& work_dir);

}  // namespace oracle
