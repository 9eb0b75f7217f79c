#include "cw2-bake/geometry/chunk_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "common/every_cpu.h"

namespace bake {
namespace {

using glm::dvec3;

/// A sphere about the middle of the bounding box.
void bound_by_sphere(const Box<glm::vec3>& box, std::span<const glm::vec3> positions,
                     mesh_format::ChunkRecord& record) {
    const glm::vec3 center = 0.5f * box.low + 0.5f * box.high;
    double square_radius = 0.0;
    for (const glm::vec3& position : positions) {
        const dvec3 arm = dvec3(position) - dvec3(center);
        square_radius = std::max(square_radius, glm::dot(arm, arm));
    }
    for (int axis = 0; axis < 3; ++axis) record.center[axis] = center[axis];
    const auto radius = static_cast<float>(std::sqrt(square_radius));
    record.radius = std::nextafter(radius, std::numeric_limits<float>::max());
}

constexpr std::size_t kLanes = 8;

/// The normals of triangles, each of length 1, or zero if the triangle has no area; zeros behind
/// them up to a multiple of kLanes.
struct Normals {
    double axis[3][mesh_format::kMaxChunkTriangles];
    std::size_t padded_count = 0;
};
static_assert(mesh_format::kMaxChunkTriangles % kLanes == 0);

/// Coordinates of the corners of some triangles; those that are none lie in the origin.
struct CornerLanes {
    float corner[3][3][kLanes];

    CornerLanes(std::span<const glm::vec3> positions, std::span<const std::uint16_t> indices) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const bool exists = 3 * i < indices.size();
                const glm::vec3 position = exists ? positions[indices[3 * i + k]] : glm::vec3(0.0f);
                for (int c = 0; c < 3; ++c) corner[k][c][i] = position[c];
            }
        }
    }
};

CW2_INLINE void normals_of(const CornerLanes& lanes, std::size_t first, Normals& normals) {
    for (std::size_t i = 0; i < kLanes; ++i) {
        const auto side = [&](int k, int c) {
            return double{lanes.corner[k][c][i]} - double{lanes.corner[0][c][i]};
        };
        const double ax = side(1, 0), ay = side(1, 1), az = side(1, 2);
        const double bx = side(2, 0), by = side(2, 1), bz = side(2, 2);
        const double x = ay * bz - by * az;
        const double y = az * bx - bz * ax;
        const double z = ax * by - bx * ay;
        const double length = std::sqrt(x * x + y * y + z * z);
        const bool has_area = length > 0.0;
        const double divisor = has_area ? length : 1.0;
        normals.axis[0][first + i] = has_area ? x / divisor : 0.0;
        normals.axis[1][first + i] = has_area ? y / divisor : 0.0;
        normals.axis[2][first + i] = has_area ? z / divisor : 0.0;
    }
}

CW2_EVERY_CPU void make_normals(std::span<const glm::vec3> positions,
                                std::span<const std::uint16_t> indices, Normals& normals) {
    const std::size_t count = indices.size() / 3;
    std::size_t first = 0;
    for (; first < count; first += kLanes)
        normals_of(CornerLanes(positions, indices.subspan(3 * first)), first, normals);
    normals.padded_count = first;
}

/// The least cosine of a normal to `axis`; a triangle without area is seen from nowhere.
CW2_EVERY_CPU double least_cosine(const Normals& normals, const glm::vec3& axis) {
    double least[kLanes];
    std::fill_n(least, kLanes, 1.0);
    for (std::size_t first = 0; first < normals.padded_count; first += kLanes) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double x = normals.axis[0][first + i];
            const double y = normals.axis[1][first + i];
            const double z = normals.axis[2][first + i];
            const bool has_area = (x != 0.0) | (y != 0.0) | (z != 0.0);
            const double cosine = has_area ? x * axis.x + y * axis.y + z * axis.z : 1.0;
            least[i] = cosine < least[i] ? cosine : least[i];
        }
    }
    return *std::min_element(least, least + kLanes);
}

/// The cone of the normals about their mean. With d the least cosine of a normal to the axis, the
/// cutoff is sqrt(1 - d^2), see ChunkRecord.
void bound_by_cone(std::span<const glm::vec3> positions, std::span<const std::uint16_t> indices,
                   mesh_format::ChunkRecord& record) {
    // Wider cones reject next to nothing.
    constexpr double kWidest = 0.1;
    record.cone_cutoff = 1.0f;
    Normals normals;
    make_normals(positions, indices, normals);
    dvec3 sum(0.0);
    for (std::size_t i = 0; i < normals.padded_count; ++i)
        sum += dvec3(normals.axis[0][i], normals.axis[1][i], normals.axis[2][i]);
    const double length = glm::length(sum);
    if (!(length > 0.0)) return;
    const glm::vec3 axis(sum / length);
    const double least = least_cosine(normals, axis);
    if (least <= kWidest) return;
    for (int k = 0; k < 3; ++k) record.cone_axis[k] = axis[k];
    // More than what rounding to floats may have taken from it.
    constexpr double kRounding = 1e-6;
    const double cutoff = std::sqrt(std::max(0.0, 1.0 - least * least)) + kRounding;
    record.cone_cutoff = std::min(1.0f, static_cast<float>(cutoff));
}

}  // namespace

mesh_format::ChunkRecord bound_chunk(const Box<glm::vec3>& box,
                                     std::span<const glm::vec3> positions,
                                     std::span<const std::uint16_t> indices) {
    mesh_format::ChunkRecord record{};
    bound_by_sphere(box, positions, record);
    bound_by_cone(positions, indices, record);
    return record;
}

}  // namespace bake
