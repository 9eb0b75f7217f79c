// The frames that triangles suggest, in double precision; for tests of compressed meshes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh-format/surface.h"

/// Of a vertex; vectors of any length.
struct SurfaceTruth {
    std::array<double, 3> normal{};   ///< of the faces' normals, by area or angle
    std::array<double, 3> tangent{};  ///< of the faces' directions of u, by area in UVs and length
    bool is_mirrored = false;         ///< as most of the area in UVs, or angles, at the vertex is
};

inline double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline std::vector<SurfaceTruth> surface_truth(std::span<const std::uint16_t> indices,
                                               std::span<const mesh_format::Place> places,
                                               bool by_angle = false) {
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
        std::array<double, 3> normal, tangent;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
            normal[k] = a[next] * b[last] - a[last] * b[next];
            tangent[k] = (b[4] * a[k] - a[4] * b[k]) * (winding < 0 ? -1 : 1);
        }
        const auto at = [&](std::size_t corner) {
            const auto& place = places[indices[i + corner % 3]];
            return std::array{double(place[0]), double(place[1]), double(place[2])};
        };
        for (std::size_t corner = 0; corner < 3; ++corner) {
            double weight = 1, tangent_weight = 1, area_weight = std::abs(winding);
            if (by_angle) {
                std::array<double, 3> to_next = at(corner + 1), to_last = at(corner + 2);
                for (std::size_t k = 0; k < 3; ++k) {
                    to_next[k] -= at(corner)[k];
                    to_last[k] -= at(corner)[k];
                }
                const double angle =
                    std::acos(dot(to_next, to_last) /
                              std::sqrt(dot(to_next, to_next) * dot(to_last, to_last)));
                weight = angle / std::sqrt(dot(normal, normal));
                tangent_weight = angle / std::sqrt(dot(tangent, tangent));
                area_weight = angle;
            }
            SurfaceTruth& truth = result[indices[i + corner]];
            for (std::size_t k = 0; k < 3; ++k) {
                truth.normal[k] += normal[k] * weight;
                truth.tangent[k] += tangent[k] * tangent_weight;
            }
            if (winding != 0)
                mirrored[indices[i + corner]] += winding < 0 ? -area_weight : area_weight;
        }
    }
    for (std::size_t v = 0; v < result.size(); ++v)
        result[v].is_mirrored = mirrored[v] > 0;  // v points down
    return result;
}
