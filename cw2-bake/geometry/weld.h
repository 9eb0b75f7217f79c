// Corners that are equal become one vertex.
#pragma once

#include <cstdint>
#include <glm/vec4.hpp>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/index_set.h"

namespace bake {

struct FramedVertex {
    Corner corner;      ///< indices into the scene's attributes
    glm::vec4 tangent;  ///< see add_tangents(), which sets it
};

/// The triangles of a scene over vertices.
struct FramedTriangles {
    RawVector<FramedVertex> vertices;
    RawVector<std::uint32_t> colors;   ///< one a vertex, as in SourceScene; empty if that has none
    RawVector<std::uint32_t> indices;  ///< one a corner of the scene
    /// Each triangle's number in the source; empty if they are in that order.
    RawVector<std::uint32_t> sources;

    /// Which corner of the source a corner is.
    std::uint32_t source_of(std::uint32_t corner) const {
        const std::uint32_t triangle = corner / 3;
        return sources.empty() ? corner : corner + 3 * (sources[triangle] - triangle);
    }
};

/// Corners share a vertex where they are equal in position, normal, UV and material. Equal
/// positions have one index; a missing UV is 0. Every corner has a normal; `positions` tells which
/// of the scene's are equal. The scene's corners go: what is made of them takes the place of their
/// memory, bit by bit. Attributes that lie in no order are put into that of the vertices.
FramedTriangles weld(SourceScene& scene, const FirstEqual& positions,
                     const Advance& advance = kUnwatched);

/// The same for triangles in an order of space, see SpatialOrder. The scene's materials of
/// triangles are in that order then, too, not what it has one a corner.
FramedTriangles weld_in_space(SourceScene& scene, const FirstEqual& positions,
                              const Advance& advance = kUnwatched);

}  // namespace bake
