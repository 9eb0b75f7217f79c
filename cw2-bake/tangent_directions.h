// The arithmetic of the tangent generator: directions of a face, and what it adds at a vertex.
//
// It is float, and in MikkTSpace's order, on purpose: which faces count as opposite, and what is
// left where directions cancel (the pole of a fan), hang on single roundings.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cw2-bake/source_scene.h"

namespace bake {

/// A face seen from one of its corners.
struct Spoke {
    glm::vec3 s;      ///< unit direction of growing u in the plane of the corner's normal, or zero
    glm::vec3 t;      ///< that of growing v
    float angle;      ///< the corner's in that plane, radians
    bool preserving;  ///< the UVs wind as the positions do
    bool usable;      ///< the UVs span an area: the face has directions and a winding of its own
};

/// spokes[i] of corners[i].
void make_spokes(const SourceScene& scene, std::span<const std::uint32_t> corners, Spoke* spokes);

/// The faces whose UVs span no area, ascending.
std::vector<std::uint32_t> find_unusable_faces(const SourceScene& scene);

/// v in unit length, or v itself where it is too short to have a direction.
glm::vec3 unit_or_zero(const glm::vec3& v);

}  // namespace bake
