#include "cw2-bake/chunk_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace bake {
namespace {

using glm::dvec3;

/// Of length 1; zero if the triangle has no area.
dvec3 normal_of(std::span<const glm::vec3> positions, std::span<const std::uint16_t> triangle) {
    const dvec3 origin(positions[triangle[0]]);
    const dvec3 normal =
        glm::cross(dvec3(positions[triangle[1]]) - origin, dvec3(positions[triangle[2]]) - origin);
    const double length = glm::length(normal);
    return length > 0.0 ? normal / length : dvec3(0.0);
}

/// A sphere about the middle of the bounding box.
void bound_by_sphere(std::span<const glm::vec3> positions, mesh_format::ChunkRecord& record) {
    glm::vec3 low(std::numeric_limits<float>::infinity());
    glm::vec3 high = -low;
    for (const glm::vec3& position : positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    const glm::vec3 center = 0.5f * low + 0.5f * high;
    double square_radius = 0.0;
    for (const glm::vec3& position : positions) {
        const dvec3 arm = dvec3(position) - dvec3(center);
        square_radius = std::max(square_radius, glm::dot(arm, arm));
    }
    for (int axis = 0; axis < 3; ++axis) record.center[axis] = center[axis];
    const auto radius = static_cast<float>(std::sqrt(square_radius));
    record.radius = std::nextafter(radius, std::numeric_limits<float>::max());
}

/// The cone of the normals about their mean. With d the least cosine of a normal to the axis, the
/// cutoff is sqrt(1 - d^2), see ChunkRecord.
void bound_by_cone(std::span<const glm::vec3> positions, std::span<const std::uint16_t> indices,
                   mesh_format::ChunkRecord& record) {
    // Wider cones reject next to nothing.
    constexpr double kWidest = 0.1;
    record.cone_cutoff = 1.0f;
    std::array<dvec3, mesh_format::kMaxChunkTriangles> normals;
    const std::size_t count = indices.size() / 3;
    dvec3 sum(0.0);
    for (std::size_t i = 0; i < count; ++i) {
        normals[i] = normal_of(positions, indices.subspan(3 * i, 3));
        sum += normals[i];
    }
    const double length = glm::length(sum);
    if (!(length > 0.0)) return;
    const glm::vec3 axis(sum / length);
    double least = 1.0;
    for (std::size_t i = 0; i < count; ++i) {
        // A triangle without area is seen from nowhere.
        if (normals[i] != dvec3(0.0)) least = std::min(least, glm::dot(normals[i], dvec3(axis)));
    }
    if (least <= kWidest) return;
    for (int k = 0; k < 3; ++k) record.cone_axis[k] = axis[k];
    // More than what rounding to floats may have taken from it.
    constexpr double kRounding = 1e-6;
    const double cutoff = std::sqrt(std::max(0.0, 1.0 - least * least)) + kRounding;
    record.cone_cutoff = std::min(1.0f, static_cast<float>(cutoff));
}

}  // namespace

mesh_format::ChunkRecord bound_chunk(std::span<const glm::vec3> positions,
                                     std::span<const std::uint16_t> indices) {
    mesh_format::ChunkRecord record{};
    bound_by_sphere(positions, record);
    bound_by_cone(positions, indices, record);
    return record;
}

}  // namespace bake
