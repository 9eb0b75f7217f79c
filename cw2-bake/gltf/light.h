// How bright a light of glTF is without its falloff.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace bake {

/// glTF's point light gives intensity / distance^2, ours the same everywhere: what glTF's gives at
/// this distance. It is that of the scene's centre, but at least half the half diagonal of its box.
inline double light_distance(const glm::dvec3& light, const glm::dvec3& center,
                             double half_diagonal) {
    return std::max({glm::length(light - center), 0.5 * half_diagonal, 1e-30});
}

}  // namespace bake
