// Tangents by MikkTSpace's rules.
#pragma once

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/weld.h"

namespace bake {

/// Gives the vertices of a welded scene tangents: those that the source gives, else those of
/// MikkTSpace (Mikkelsen 2008) with its default angular threshold of 180 degrees for the triangles
/// of each material by itself. Corners that differ in tangent or colour no longer share a vertex:
/// those that differ from the first one at theirs have others, behind those that were there.
///
/// A tangent's xyz has unit length and, where the UVs allow it, is orthogonal to the vertex's
/// normal; w = +1 or -1, so that the bitangent is w * cross(normal, tangent), along +v (up).
void add_tangents(const SourceScene& scene, FramedTriangles& triangles,
                  const Advance& advance = kUnwatched);

}  // namespace bake
