// Normals for corners that state none.
#pragma once

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/index_set.h"

namespace bake {

/// Gives every corner of `scene` a normal; corners that have one keep it.
///
/// A triangle of smoothing group 0 gets its own normal. In any other group a corner gets the sum,
/// normalised, of the normals of the group's triangles around its position, each weighted by the
/// triangle's angle there (Thuermer and Wuethrich 1998); positions are one where their values are
/// equal, as `positions` tells. Where that sum vanishes the triangle's own normal serves, and +Y
/// where that has no area. Triangles that follow each other and face one way, to within 1e-4
/// radians, share one normal.
void generate_normals(SourceScene& scene, const FirstEqual& positions,
                      const Advance& advance = kUnwatched);

}  // namespace bake
