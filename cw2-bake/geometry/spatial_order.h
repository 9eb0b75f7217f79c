// An order in space for triangles that come in none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/index_set.h"

namespace bake {

/// Triangles of one material that lie one behind the other among a scene's corners.
struct TriangleBlock {
    std::uint32_t material;
    std::uint32_t first, size;
    std::uint32_t part;  ///< of those that the corners are cut into, see SpatialOrder
};

/// All triangles in the order of the source, in blocks of at most `most`; in one part.
std::vector<TriangleBlock> blocks_of(const RunVector& materials, std::uint32_t most);

/// Whether the triangles jump about in space, so that those around a vertex come anywhere, as some
/// exporters, decimators and scanners leave them; then all that asks for their vertices waits for
/// the memory. Told by samples of what is large enough for that to matter.
bool jumps_about(const SourceScene& scene, const FirstEqual& positions);

/// The triangles of a scene by material, and within it by the cells of a grid, which follow each
/// other such that most neighbours are near (Morton 1966). Triangles of a material and cell keep
/// the order of the source.
struct SpatialOrder {
    static constexpr std::size_t kMostBlockTriangles = 256;

    /// Where their corners are now.
    std::vector<TriangleBlock> blocks;
    /// Of each triangle, as they lie now, its number in the source less that of the first one of
    /// its part.
    RawVector<std::uint16_t> source_in_part;
    std::vector<std::uint32_t> first_of_part;

    /// Each triangle's number in the source, in the order of the blocks.
    RawVector<std::uint32_t> sources() const;
};

/// Moves the corners of `scene`, and nothing else of it, within small parts of all, so that little
/// memory is needed: those of a cell lie together in each part.
SpatialOrder sort_in_space(SourceScene& scene);

}  // namespace bake
