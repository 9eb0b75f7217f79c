#include "cw2/render/visibility.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <tuple>

namespace cw2 {

namespace {

bool faces_away(const SceneChunk& chunk, const glm::vec3& camera_position) {
    const glm::vec3 to_center = chunk.center - camera_position;
    return glm::dot(to_center, chunk.cone_axis) >=
           chunk.cone_cutoff * glm::length(to_center) + chunk.radius;
}

}  // namespace

// Gribb and Hartmann 2001.
FrustumPlanes frustum_planes(const glm::mat4& clip) {
    const glm::vec4 x = glm::row(clip, 0);
    const glm::vec4 y = glm::row(clip, 1);
    const glm::vec4 z = glm::row(clip, 2);
    const glm::vec4 w = glm::row(clip, 3);
    // Reversed depth: the near plane is z = w.
    FrustumPlanes planes{w + x, w - x, w + y, w - y, w - z};
    for (glm::vec4& plane : planes) plane /= glm::length(glm::vec3(plane));
    return planes;
}

bool is_outside(const FrustumPlanes& planes, const glm::vec3& center, float radius) {
    return std::ranges::any_of(planes, [&](const glm::vec4& plane) {
        return glm::dot(glm::vec3(plane), center) + plane.w < -radius;
    });
}

CutTriangle cut(const std::array<glm::vec3, 3>& triangle, std::span<const glm::vec4> planes) {
    CutTriangle polygon{{triangle[0], triangle[1], triangle[2]}, 3};
    for (const glm::vec4& plane : planes) {
        const CutTriangle whole = polygon;
        polygon.count = 0;
        for (std::size_t i = 0; i < whole.count; ++i) {
            const glm::vec3& p = whole.corners[i];
            const glm::vec3& q = whole.corners[(i + 1) % whole.count];
            const float inside = glm::dot(plane, glm::vec4(p, 1.0f));
            const float next_inside = glm::dot(plane, glm::vec4(q, 1.0f));
            if (inside >= 0.0f) polygon.corners[polygon.count++] = p;
            if ((inside >= 0.0f) != (next_inside >= 0.0f))
                polygon.corners[polygon.count++] = p + inside / (inside - next_inside) * (q - p);
        }
    }
    return polygon;
}

void find_visible(std::span<const SceneChunk> chunks, std::span<const Draw> draws,
                  const glm::mat4& clip_from_world, const glm::vec3& camera_position,
                  std::vector<std::uint32_t>& visible) {
    using Rank = std::tuple<Shading, float, std::uint32_t>;
    const FrustumPlanes planes = frustum_planes(clip_from_world);
    std::vector<Rank> ranks;
    for (std::uint32_t i = 0; i < chunks.size(); ++i) {
        const SceneChunk& chunk = chunks[i];
        const Draw& draw = draws[chunk.draw];
        if (is_outside(planes, chunk.center, chunk.radius) ||
            (draw.cull_back && faces_away(chunk, camera_position)))
            continue;
        // By the farthest point: near parts of large walls may hide nothing of what is before the
        // rest of them. Measured in Sponza: 1.6 fragments a pixel, by the nearest point 4.0.
        ranks.emplace_back(draw.shading,
                           glm::distance(chunk.center, camera_position) + chunk.radius, i);
    }
    std::sort(ranks.begin(), ranks.end());
    visible.clear();
    for (const Rank& rank : ranks) visible.push_back(std::get<2>(rank));
}

}  // namespace cw2
