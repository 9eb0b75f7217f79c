#include "cw2-bake/chunk_split.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>

namespace bake {

void halve(std::span<CentredTriangle> triangles) {
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
    std::nth_element(
        triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2),
        triangles.end(), [axis](const CentredTriangle& a, const CentredTriangle& b) {
            return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis]
                                                        : a.index < b.index;
        });
}

void sort_by_index(std::span<CentredTriangle> triangles) {
    std::ranges::sort(triangles, {}, &CentredTriangle::index);
}

}  // namespace bake
