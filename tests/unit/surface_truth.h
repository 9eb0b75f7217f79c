// The frames that triangles suggest, in double precision; for tests of compressed meshes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh-format/rows.h"

/// Of a vertex; vectors of any length.
struct SurfaceTruth {
    std::array<double, 3> normal{};
    std::array<double, 3> tangent{};  ///< of the faces' directions of u, by angle
    bool is_mirrored = false;         ///< as most of the angle around the vertex is
};

/// Normals by area or by angle.
inline std::vector<SurfaceTruth> surface_truth(std::span<const std::uint16_t> indices,
                                               std::span<const mesh_format::Row> vertices,
                                               bool by_angle) {
    using Vector = std::array<double, 3>;
    const auto dot = [](const Vector& a, const Vector& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    const auto numbers = [](const mesh_format::Row& row) {
        std::array<double, mesh_format::kRowNumbers> result;
        for (std::size_t k = 0; k < result.size(); ++k) result[k] = row[k];
        return result;
    };
    std::vector<SurfaceTruth> result(vertices.size());
    std::vector<double> mirrored(vertices.size());
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto at = numbers(vertices[indices[i + k]]);
            const auto next = numbers(vertices[indices[i + (k + 1) % 3]]);
            const auto last = numbers(vertices[indices[i + (k + 2) % 3]]);
            Vector a, b;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                a[axis] = next[axis] - at[axis];
                b[axis] = last[axis] - at[axis];
            }
            const Vector normal{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                a[0] * b[1] - a[1] * b[0]};
            const double size = std::sqrt(dot(normal, normal));
            if (size == 0) continue;
            const double angle = std::atan2(size, dot(a, b));
            const double u1 = next[6] - at[6], v1 = next[7] - at[7];
            const double u2 = last[6] - at[6], v2 = last[7] - at[7];
            const double winding = u1 * v2 - u2 * v1;
            Vector along_u;
            for (std::size_t axis = 0; axis < 3; ++axis)
                along_u[axis] = (v2 * a[axis] - v1 * b[axis]) * (winding < 0 ? -1 : 1);
            const double length = std::sqrt(dot(along_u, along_u));
            SurfaceTruth& truth = result[indices[i + k]];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                truth.normal[axis] += normal[axis] * (by_angle ? angle / size : 1);
                if (winding != 0) truth.tangent[axis] += along_u[axis] * angle / length;
            }
            // v of a file points down.
            mirrored[indices[i + k]] += winding > 0 ? angle : winding < 0 ? -angle : 0;
        }
    }
    for (std::size_t v = 0; v < result.size(); ++v) result[v].is_mirrored = mirrored[v] > 0;
    return result;
}
