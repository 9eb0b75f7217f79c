// Cutting triangles into parts that are tight in space.
#pragma once

#include <tbb/parallel_invoke.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "mesh-format/layout.h"

namespace bake {

struct CentredTriangle {
    glm::vec3 centroid;  ///< times 3/4
    std::uint32_t index;
};

/// The number of parts that `count` triangles are halved into.
inline std::size_t part_count(std::size_t count) {
    return count <= mesh_format::kMaxChunkTriangles
               ? 1
               : part_count(count / 2) + part_count(count - count / 2);
}

/// Brings the smaller half of `triangles` along the longest side of their bounding box to the
/// front; of equal ones those of the smaller index.
void halve(std::span<CentredTriangle> triangles);

/// Back to the source's order.
void sort_by_index(std::span<CentredTriangle> triangles);

/// Orders `triangles` so that each part's follow each other, in the source's order, and calls
/// done(part, begin, end) once a part is; in parallel for different parts.
template <typename Done>
void split(std::span<CentredTriangle> triangles, const Done& done, std::size_t first_part = 0,
           std::size_t first_triangle = 0) {
    const std::size_t half = triangles.size() / 2;
    if (part_count(triangles.size()) == 1) {
        // The order must not depend on how the halves were found.
        sort_by_index(triangles);
        done(first_part, first_triangle, first_triangle + triangles.size());
        return;
    }
    halve(triangles);
    const auto low = [&] { split(triangles.first(half), done, first_part, first_triangle); };
    const auto high = [&] {
        split(triangles.subspan(half), done, first_part + part_count(half), first_triangle + half);
    };
    // Below this many triangles a task of its own costs more than it saves.
    constexpr std::size_t kParallel = 4096;
    if (triangles.size() >= kParallel) {
        tbb::parallel_invoke(low, high);
    } else {
        low();
        high();
    }
}

}  // namespace bake
