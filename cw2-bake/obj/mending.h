// Corners whose UV or normal is no number, or not there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/obj/chunk.h"

namespace bake {

/// `ranges` ascend; one that touches the last becomes one with it.
void add_range(std::vector<TriangleRange>& ranges, TriangleRange range);

/// Both lists as one, ascending.
std::vector<TriangleRange> joined(const std::vector<TriangleRange>& a,
                                  const std::vector<TriangleRange>& b);

/// What lost an index: corners as the text states them, and where they may come to lie when their
/// polygons are triangulated.
struct Mended {
    std::size_t count = 0, first_triangle = 0;
    std::vector<TriangleRange> ranges{};
};

/// Makes the index of corners whose element is NaN, or not there, absent. `bad` are the elements
/// that are NaN, ascending; `all_in_range` says that no index is above the last element. Where both
/// say that all is well there is nothing to mend.
template <typename T>
Mended mend_corners(const std::vector<T>& elements, std::span<const std::uint32_t> bad,
                    bool all_in_range, std::uint32_t Corner::*index,
                    std::span<const ObjPolygon> polygons, std::vector<Corner>& corners);

}  // namespace bake
