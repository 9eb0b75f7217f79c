// Polygons to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace bake {

/// Cuts one polygon after another; keeps its scratch memory between them.
class Triangulator {
 public:
    using Triangle = std::array<std::uint32_t, 3>;

    /// The n - 2 triangles of a polygon of n >= 3 corners, as indices into it, with the polygon's
    /// orientation; valid until the next call. A quad is cut along the diagonal that lies inside,
    /// of two such the shorter; any other polygon by clipping ears (Meisters 1975). The polygon is
    /// looked at along the axis nearest to its normal by Newell's formula. Corners may be collinear
    /// or coincide, and holes may be joined to the outline by a pair of edges. Where the outline
    /// crosses itself, or has no area, the triangles only connect its corners.
    std::span<const Triangle> triangulate(std::span<const glm::vec3> polygon);

 private:
    /// How willingly a corner is cut off; the next is tried when the last finds none.
    enum class Rule { ear, without_area, clear_inside, convex, any };

    bool project(std::span<const glm::vec3> polygon);
    void quad(std::span<const glm::vec3> polygon);
    void clip_ears();
    void build_grid();
    double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
    bool may_clip(std::uint32_t v, Rule rule) const;
    bool blocks(std::uint32_t q, const Triangle& ear, Rule rule) const;
    std::size_t grid_cell(double offset, double extent) const;

    std::vector<Triangle> triangles_;
    std::vector<glm::dvec2> points_;  // counter-clockwise
    std::vector<std::uint32_t> previous_, next_;
    std::vector<char> may_block_;  // not strictly convex, and not yet clipped
    // The corners that may block, by cells of a square grid over the polygon.
    std::size_t grid_side_ = 1;
    glm::dvec2 grid_min_{}, grid_extent_{};
    std::vector<std::uint32_t> cell_start_, cell_corners_;
};

}  // namespace bake
