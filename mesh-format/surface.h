// What triangles tell of the tangent frames at their vertices, in integers only: so every processor
// is told the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh-format/rows.h"

namespace mesh_format {

/// What is summed.
struct SurfaceModel {
    bool by_angle;  ///< a triangle counts for normals by its angle at the vertex, else by its area
    bool has_uvs;   ///< else there are no tangents
    /// By area, what normals are in units of: 2^area_shift times the lattice's unit squared.
    int area_shift;
};
inline constexpr int kMaxAreaShift = 15;

/// Of a vertex, the sums over its triangles, modulo 2^32.
struct Surface {
    /// As long as two times the areas, or in units of 2^-14 by angle; the fourth number is 0.
    std::array<std::int32_t, 4> normal;
    /// Along u, by angle, 0 where UVs tell nothing; the fourth number is how much of them is
    /// mirrored, or else below 0.
    std::array<std::int32_t, 4> tangent;
};

/// Sets the surfaces of all vertices; what is behind those becomes 0. Every index is below their
/// number. It does not matter at which corner a triangle starts.
void sum_surfaces(std::span<const std::uint16_t> indices, const Row* vertices,
                  const SurfaceModel& model, std::span<Surface> surfaces);

/// The least SurfaceModel::area_shift with which sums over a hundred of the largest triangles are
/// below 2^31.
int fitting_area_shift(std::span<const std::uint16_t> indices, const Row* vertices);

/// Rotations (t, cross(n, t), n) as quaternions x, y, z, w over their largest components, in units
/// of 2^-15; t is made orthogonal to n.
struct Rotations {
    static constexpr std::size_t kCount = 8;
    using Numbers = std::array<std::int32_t, kCount>;
    Numbers tops;  ///< the number of the largest component, + 4 left-handed
    std::array<Numbers, 4> components;
};

/// Of as many surfaces.
void rotations_of(const Surface* surfaces, Rotations& rotations);

}  // namespace mesh_format
