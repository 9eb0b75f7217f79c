// Tangents of vertices whose faces plainly are one group, which nearly all are.
#pragma once

#include <cstdint>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/weld.h"

namespace bake {

/// What the faces at a vertex tell is not all where the source gives tangents or colours.
bool may_be_plain(const SourceScene& scene);

/// Sets the tangents of the vertices of which one pass over the faces shows that all of theirs are
/// one of MikkTSpace's groups, no two opposite. Returns, by vertex, whether it is left as it was: 1
/// or 0.
RawVector<std::uint8_t> add_plain_tangents(const SourceScene& scene, FramedTriangles& triangles,
                                           const Advance& advance);

}  // namespace bake
