#include "cw2-bake/chunk_split.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <vector>

namespace bake {
namespace {

constexpr std::size_t kBins = 256;

/// Sorts coordinates roughly: of two bins, all of one come before all of the other.
class Bins {
 public:
    Bins(float low, float high)
        : low_(low), scale_(high > low ? static_cast<float>(kBins - 1) / (high - low) : 0.0f) {}

    std::size_t of(float coordinate) const {
        return std::min(static_cast<std::size_t>((coordinate - low_) * scale_), kBins - 1);
    }

 private:
    float low_, scale_;
};

struct Key {
    float coordinate;
    std::uint32_t index;
    auto operator<=>(const Key&) const = default;
};

/// The key that `rank` others come before.
Key nth_key(std::span<const CentredTriangle> triangles, int axis, const Bins& bins,
            std::size_t rank) {
    std::array<std::uint32_t, kBins> counts{};
    for (const CentredTriangle& triangle : triangles) ++counts[bins.of(triangle.centroid[axis])];
    std::size_t bin = 0;
    for (; rank >= counts[bin]; ++bin) rank -= counts[bin];
    std::vector<Key> keys;
    keys.reserve(counts[bin]);
    for (const CentredTriangle& triangle : triangles) {
        const float coordinate = triangle.centroid[axis];
        if (bins.of(coordinate) == bin) keys.push_back({coordinate, triangle.index});
    }
    const auto nth = keys.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(keys.begin(), nth, keys.end());
    return *nth;
}

}  // namespace

void halve(std::span<const CentredTriangle> triangles, std::span<CentredTriangle> out) {
    glm::vec3 low(std::numeric_limits<float>::infinity());
    glm::vec3 high = -low;
    for (const CentredTriangle& triangle : triangles) {
        low = glm::min(low, triangle.centroid);
        high = glm::max(high, triangle.centroid);
    }
    const glm::vec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                     : extent.y >= extent.z                       ? 1
                                                                  : 2;
    const std::size_t half = triangles.size() / 2;
    const Key first_high = nth_key(triangles, axis, Bins(low[axis], high[axis]), half);

    // No branch on what no one can predict.
    std::array<CentredTriangle*, 2> next{out.data(), out.data() + half};
    for (const CentredTriangle& triangle : triangles) {
        const float coordinate = triangle.centroid[axis];
        const bool is_high =
            coordinate > first_high.coordinate ||
            (coordinate == first_high.coordinate && triangle.index >= first_high.index);
        *next[is_high]++ = triangle;
    }
}

}  // namespace bake
