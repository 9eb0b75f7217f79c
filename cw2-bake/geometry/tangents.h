// Tangents by MikkTSpace's rules, and the vertices that result.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>

#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/source_scene.h"

namespace bake {

struct FramedVertex {
    Corner corner;      ///< indices into the scene's attributes
    glm::vec4 tangent;  ///< see FramedTriangles
};

/// The triangles of a scene over vertices that have one tangent each.
///
/// A tangent's xyz has unit length and, where the UVs allow it, is orthogonal to the vertex's
/// normal; w = +1 or -1, so that the bitangent is w * cross(normal, tangent), along +v (up).
struct FramedTriangles {
    RawVector<FramedVertex> vertices;
    RawVector<std::uint32_t> colors;   ///< one a vertex, as in SourceScene; empty if that has none
    RawVector<std::uint32_t> indices;  ///< one a corner of the scene
};

/// Corners share a vertex where they are equal in position, normal, UV, colour, material and
/// tangent. The tangents are those that the source gives, else those of MikkTSpace (Mikkelsen 2008)
/// with its default angular threshold of 180 degrees for the triangles of each material by itself.
/// `scene` is welded (see weld.h).
FramedTriangles add_tangents(const SourceScene& scene);

}  // namespace bake
