// Where a scene's vertices are, on the host.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "mesh-format/file.h"

namespace cw2 {

/// The positions of all vertices, mesh after mesh, as the vertex shader unpacks them, scene units.
std::vector<glm::vec3> vertex_positions(const mesh_format::Document& document);

}  // namespace cw2
