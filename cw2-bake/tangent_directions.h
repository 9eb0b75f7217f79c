// The arithmetic of the tangent generator: directions of a face, and what it adds at a vertex.
//
// It is float, and in MikkTSpace's order, on purpose: which faces count as opposite, and what is
// left where directions cancel (the pole of a fan), hang on single roundings.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace bake {

struct TangentInput {
    std::span<const glm::vec3> positions;
    std::span<const glm::vec3> normals;
    std::span<const glm::vec2> uvs;
    std::span<const std::uint32_t> indices;
};

inline std::uint32_t next_corner(std::uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

inline std::uint32_t previous_corner(std::uint32_t corner) {
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

struct FaceDirections {
    glm::vec3 s;      ///< unit direction of growing u, zero if there is none
    glm::vec3 t;      ///< unit direction of growing v, zero if there is none
    bool preserving;  ///< the UVs wind as the positions do
    bool usable;      ///< the UVs span an area: the face has directions and a winding of its own
    bool degenerate;  ///< two corners at one position
};

std::vector<FaceDirections> make_face_directions(const TangentInput& mesh);

/// A face seen from one of its corners.
struct Spoke {
    glm::vec3 s;  ///< the face's, in the plane of the vertex normal, in unit length again
    glm::vec3 t;
    float angle;  ///< the corner's in that plane, radians
    bool preserving;
    bool usable;
};

/// spokes[i] of corners[i].
void make_spokes(const TangentInput& mesh, const std::vector<FaceDirections>& faces,
                 std::span<const std::uint32_t> corners, Spoke* spokes);

/// v in unit length, or v itself where it is too short to have a direction.
glm::vec3 unit_or_zero(const glm::vec3& v);

}  // namespace bake
