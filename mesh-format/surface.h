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

/// What is summed: by area in units of 2^shift, which takes less time, or by angle.
struct SurfaceModel {
    bool has_uvs;  ///< else there are no tangents
    bool by_angle;
    int normal_shift;
    int tangent_shift;
};
inline constexpr int kMaxSurfaceShift = 15;

/// Modulo 2^32, over the triangles of a vertex. By area, of normals: as long as twice the areas;
/// the fourth number has no meaning. Of tangents: along u, as long as twice the areas in UVs times
/// lengths along u; the fourth number is those areas, below 0 for a left-handed frame. By angle,
/// all are as long as the triangle's angle at the vertex in units of 2^-14, and the fourth number
/// of tangents has the sign of the area.
using Sum = std::array<std::int32_t, 4>;

/// Of normals, and if there are UVs of tangents.
constexpr std::size_t sums_of_vertex(const SurfaceModel& model) {
    return model.has_uvs ? 2 : 1;
}

/// Sets sums_of_vertex() for each vertex; what is behind those becomes 0. Every index is below
/// their number. Differences of places are modulo 2^16: triangles larger than half of that tell
/// nothing.
void sum_surfaces(std::span<const std::uint16_t> indices, const Place* places,
                  const SurfaceModel& model, std::span<Sum> sums);

/// By area, with the least shifts with which sums over a hundred of the largest triangles are below
/// 2^31.
SurfaceModel fitting_model(std::span<const std::uint16_t> indices, const Place* places,
                           bool has_uvs);

/// How many frames are expected at once.
inline constexpr std::size_t kFrameLanes = 32;
/// A number of each.
using Words = std::array<Row, kFrameLanes / kRowNumbers>;

/// The frames that the sums of as many vertices suggest: the normal is their normal, the tangent
/// theirs, or the x axis if that is 0 or there are none, made orthogonal to the normal. In quat48,
/// the first words of all, the second and the third; in quat32, the codes.
void expect_quat48(const Sum* sums, bool has_uvs, std::array<Words, 3>& words);
void expect_quat32(const Sum* sums, bool has_uvs, std::array<std::uint32_t, kFrameLanes>& codes);

}  // namespace mesh_format
