// What triangles tell of the tangent frames at their vertices, in integers only: so every processor
// is told the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh-format/layout.h"
#include "mesh-format/rows.h"

namespace mesh_format {

/// A vertex as x, y, z, u, v of its quantised position and UV, and three numbers of no meaning.
using Place = Row;

/// What is summed, in units of 2^shift.
struct SurfaceModel {
    bool has_uvs;  ///< else there are no tangents
    int normal_shift;
    int tangent_shift;
};
inline constexpr int kMaxSurfaceShift = 15;

/// Of a vertex, the sums over its triangles, modulo 2^32.
struct Surface {
    /// As long as twice the areas; the fourth number has no meaning.
    std::array<std::int32_t, 4> normal;
    /// Along u, as long as twice the areas in UVs times lengths along u; the fourth number is those
    /// areas, below 0 for a left-handed frame.
    std::array<std::int32_t, 4> tangent;
};

/// Sets the surfaces of all vertices; what is behind those becomes 0. Every index is below their
/// number. Differences of places are modulo 2^16: triangles larger than half of that tell nothing.
void sum_surfaces(std::span<const std::uint16_t> indices, const Place* places,
                  const SurfaceModel& model, std::span<Surface> surfaces);

/// The least shifts with which sums over a hundred of the largest triangles are below 2^31.
SurfaceModel fitting_model(std::span<const std::uint16_t> indices, const Place* places,
                           bool has_uvs);

/// How many frames are expected at once.
inline constexpr std::size_t kFrameLanes = 8;

/// The frames of as many surfaces: the normal is that of the sum, the tangent its tangent (the x
/// axis if that is 0), made orthogonal to the normal. In quat48, the first words of all, the second
/// and the third; in quat32, the codes.
void expect_quat48(const Surface* surfaces, std::array<Row, 3>& words);
void expect_quat32(const Surface* surfaces, std::array<std::uint32_t, kFrameLanes>& codes);

}  // namespace mesh_format
