// A signed distance field to a mesh.
#pragma once

#include <functional>

#include "assets/model.h"

namespace assets {

/// Negative inside; may be smaller in magnitude than the distance, and at most 1.5 times it.
using Field = std::function<float(glm::vec3)>;

/// The surface of `field` as quads of about the size of the lattice's cells (surface nets: Gibson
/// 1998), moved onto the surface, with the field's gradient as normals. The lattice is where the
/// planes x, y and z meet, each rising. Closed where the surface does not leave the lattice. UVs
/// are left at zero.
Mesh polygonise(const Field& field, const std::vector<float>& x, const std::vector<float>& y,
                const std::vector<float>& z);

/// Planes from `low` to at least `high`: `fine` apart from fine_low to fine_high, up to `coarse`
/// apart elsewhere.
std::vector<float> planes(float low, float high, float fine_low, float fine_high, float fine,
                          float coarse);

}  // namespace assets
