#include "cw2-bake/geometry/origin.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "cw2-bake/geometry/box.h"

namespace bake {
namespace {

/// Floats are 2^-24 of the largest coordinate apart, points of a mesh's lattice 2^-16 of its
/// extent: up to this ratio of the two, floats are at least 16 times as fine.
constexpr double kDistant = 16.0;

struct Reach {
    glm::dvec3 center;
    double extent;   ///< the longest side of the box
    double largest;  ///< magnitude of a coordinate
};

/// Of the positions of every `stride`th corner.
Reach reach_of(std::span<const glm::vec3> positions, std::span<const Corner> corners,
               std::size_t stride) {
    Box<glm::vec3> box;
    for (std::size_t i = 0; i < corners.size(); i += stride)
        box.add(positions[corners[i].position]);
    const glm::dvec3 low(box.low), high(box.high);
    const glm::dvec3 side = high - low;
    const glm::dvec3 farthest = glm::max(glm::abs(low), glm::abs(high));
    return {0.5 * (low + high), std::max({side.x, side.y, side.z}),
            std::max({farthest.x, farthest.y, farthest.z})};
}

}  // namespace

std::optional<glm::dvec3> distant_origin(std::span<const glm::vec3> positions,
                                         std::span<const Corner> corners) {
    if (corners.empty()) return std::nullopt;
    // Of fewer positions the extent can only be smaller, and each is at most one extent nearer.
    constexpr std::size_t kLooks = 1024;
    const Reach some = reach_of(positions, corners, corners.size() / kLooks + 1);
    if (some.largest < (kDistant - 1.0) * some.extent) return std::nullopt;
    const Reach all = reach_of(positions, corners, 1);
    if (all.largest <= kDistant * all.extent) return std::nullopt;
    if (all.extent == 0.0) {
        // Floats do not tell them apart, or they are one point.
        const auto is_first = [&](const Corner& corner) {
            return corner.position == corners.front().position;
        };
        return std::ranges::all_of(corners, is_first) ? std::nullopt : std::optional(all.center);
    }
    const double unit = std::exp2(std::ceil(std::log2(all.extent)));
    return glm::round(all.center / unit) * unit;
}

}  // namespace bake
