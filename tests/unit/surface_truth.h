// The frames that triangles suggest, in double precision; for tests of compressed meshes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh-format/surface.h"

/// Of a vertex; vectors of any length.
struct SurfaceTruth {
    std::array<double, 3> normal{};   ///< of the faces' normals, by area
    std::array<double, 3> tangent{};  ///< of the faces' directions of u, by area in UVs and length
    bool is_mirrored = false;         ///< as most of the area in UVs around the vertex is
};

inline std::vector<SurfaceTruth> surface_truth(std::span<const std::uint16_t> indices,
                                               std::span<const mesh_format::Place> places) {
    using Numbers = std::array<double, 5>;  // x, y, z, u, v
    std::vector<SurfaceTruth> result(places.size());
    std::vector<double> mirrored(places.size());
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const auto edge_to = [&](std::size_t corner) {
            Numbers edge;
            for (std::size_t k = 0; k < edge.size(); ++k)
                edge[k] = double(places[indices[i + corner]][k]) - places[indices[i]][k];
            return edge;
        };
        const Numbers a = edge_to(1), b = edge_to(2);
        const double winding = a[3] * b[4] - b[3] * a[4];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            SurfaceTruth& truth = result[indices[i + corner]];
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
                truth.normal[k] += a[next] * b[last] - a[last] * b[next];
                truth.tangent[k] += (b[4] * a[k] - a[4] * b[k]) * (winding < 0 ? -1 : 1);
            }
            mirrored[indices[i + corner]] += winding;
        }
    }
    for (std::size_t v = 0; v < result.size(); ++v)
        result[v].is_mirrored = mirrored[v] > 0;  // v points down
    return result;
}
