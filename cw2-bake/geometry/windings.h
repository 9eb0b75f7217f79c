// Which way UVs wind on faces whose UVs cannot tell, for the tangent generator.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/tangent_directions.h"
#include "cw2-bake/geometry/tangent_topology.h"

namespace bake {

/// Faces without usable UVs have the winding of the group that reaches them first, with whichever
/// corner; groups grow one after the other, in the order of their first corner in
/// the source.
class Windings {
 public:
    /// `mixed` are the vertices, ascending, where faces with usable UVs meet faces without: nothing
    /// passes from face to face elsewhere.
    Windings(const SourceScene& scene, const FramedTriangles& triangles, const CornerLists& lists,
             std::span<const std::uint32_t> mixed);

    /// Whether the UVs of such a face, which is at one of those vertices, wind as its positions do;
    /// `otherwise` where no group reaches it.
    bool preserving(std::uint32_t face, bool otherwise) const;

 private:
    void grow_groups(const FramedTriangles& triangles, const CornerSlots& slots,
                     const SlotLinks& links, const Spokes& spokes);
    /// Where the face is in unusable_, or its end.
    std::size_t find(std::uint32_t face) const;

    std::vector<std::uint32_t> unusable_;  // faces, ascending
    std::vector<signed char> preserving_;  // of each: 1, 0, or -1 if none has reached it
};

}  // namespace bake
