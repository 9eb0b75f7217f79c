// The arithmetic of the tangent generator: directions of a face, and what it adds at a vertex.
//
// It is float, and in MikkTSpace's order, on purpose: which faces count as opposite, and what is
// left where directions cancel (the pole of a fan), hang on single roundings.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/tangent_topology.h"

namespace bake {

/// Spokes are made kLanes at a time, in loops that compilers turn into vector instructions.
inline constexpr std::size_t kLanes = 16;

struct Lanes {
    float x[kLanes];
    float y[kLanes];
    float z[kLanes];

    void set(std::size_t i, const glm::vec3& v) {
        x[i] = v.x;
        y[i] = v.y;
        z[i] = v.z;
    }
    glm::vec3 get(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

struct SpokeLanes {
    Lanes s, t, weighted_s;
    std::uint32_t preserving[kLanes];  ///< 1 or 0
    std::uint32_t usable[kLanes];      ///< 1 or 0
};

/// Up to kLanes successive faces, seen from each of their corners; see Spokes.
class FaceSpokes {
 public:
    void make(const SourceScene& scene, const FramedTriangles& triangles, std::size_t first_face,
              std::size_t count);

    /// By face.
    const SpokeLanes& at_corner(std::size_t corner) const { return at_corner_[corner]; }
    /// Two corners of the face are at one position.
    bool is_degenerate(std::size_t face) const { return degenerate_[face]; }

 private:
    SpokeLanes at_corner_[3];
    bool degenerate_[kLanes];
};

/// Faces seen from one of their corners each.
class Spokes {
 public:
    void make(const SourceScene& scene, const FramedTriangles& triangles,
              std::span<const Slot> slots);

    /// Unit direction of growing u (v) in the plane of the corner's normal, or zero.
    glm::vec3 s(std::size_t i) const { return lanes(i).s.get(i % kLanes); }
    glm::vec3 t(std::size_t i) const { return lanes(i).t.get(i % kLanes); }
    /// s times the corner's angle in that plane, in radians.
    glm::vec3 weighted_s(std::size_t i) const { return lanes(i).weighted_s.get(i % kLanes); }
    /// The UVs wind as the positions do.
    bool preserving(std::size_t i) const { return lanes(i).preserving[i % kLanes] != 0; }
    void set_preserving(std::size_t i, bool value) {
        lanes_[i / kLanes].preserving[i % kLanes] = value;
    }
    /// The UVs span an area: the face has directions and a winding of its own.
    bool usable(std::size_t i) const { return lanes(i).usable[i % kLanes] != 0; }
    /// Where spoke i is lane i % kLanes.
    const SpokeLanes& lanes(std::size_t i) const { return lanes_[i / kLanes]; }

 private:
    std::vector<SpokeLanes> lanes_;
};

inline bool is_unit(const glm::vec3& v) {
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-3f;
}

/// v in unit length, or v itself where it is too short to have a direction.
inline glm::vec3 unit_or_zero(const glm::vec3& v) {
    const float squared = glm::dot(v, v);
    return squared > 0.0f ? (1.0f / std::sqrt(squared)) * v : v;
}

}  // namespace bake
