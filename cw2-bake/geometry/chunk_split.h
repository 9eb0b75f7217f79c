// Cutting triangles into parts that are tight in space.
#pragma once

#include <tbb/parallel_invoke.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "mesh-format/layout.h"

namespace bake {

struct alignas(16) CentredTriangle {
    glm::vec3 centroid;  ///< times 3/4
    std::uint32_t index;
};

/// The number of parts that `count` triangles are halved into.
inline std::size_t part_count(std::size_t count) {
    return count <= mesh_format::kMaxChunkTriangles
               ? 1
               : part_count(count / 2) + part_count(count - count / 2);
}

/// Copies the half of `triangles` that comes first along the longest side of their bounding box
/// (of equal ones those of smaller index) to the front of `out`, and the others behind it; each
/// half keeps its order. The indices ascend.
void halve(std::span<const CentredTriangle> triangles, std::span<CentredTriangle> out);

/// Halves `triangles`, whose indices ascend, until they are parts of at most kMaxChunkTriangles,
/// and calls done(part, triangles, begin) for each, where the parts before it hold `begin`
/// triangles; in parallel for different parts. `spare` is as large as `triangles`; both are
/// overwritten. Indices ascend within a part, too.
template <typename Done>
void split(std::span<CentredTriangle> triangles, std::span<CentredTriangle> spare, const Done& done,
           std::size_t part = 0, std::size_t begin = 0) {
    const std::size_t size = triangles.size();
    if (part_count(size) == 1) return done(part, triangles, begin);
    halve(triangles, spare);
    const std::size_t half = size / 2;
    const auto low = [&] { split(spare.first(half), triangles.first(half), done, part, begin); };
    const auto high = [&] {
        split(spare.subspan(half), triangles.subspan(half), done, part + part_count(half),
              begin + half);
    };
    // Below this many triangles a task of its own costs more than it saves.
    constexpr std::size_t kParallel = 4096;
    if (size >= kParallel) {
        tbb::parallel_invoke(low, high);
    } else {
        low();
        high();
    }
}

}  // namespace bake
