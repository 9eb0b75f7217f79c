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
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    static constexpr std::size_t kLeaf = 8;  // corners that are not divided further

    /// A box around corners, and how many of them still block.
    struct Node {
        glm::dvec2 low, high;
        std::uint32_t count;
    };

    /// How willingly a corner is cut off; the next is tried when the last finds none.
    enum class Rule { ear, without_area, clear_inside, convex, any };

    bool project(std::span<const glm::vec3> polygon);
    void quad(std::span<const glm::vec3> polygon);
    void clip_ears();
    void build_tree(std::size_t node, std::size_t begin, std::size_t end);
    void stop_blocking(std::uint32_t v);
    std::uint32_t blocker(const Triangle& ear, Rule rule, std::size_t node, std::size_t begin,
                          std::size_t end) const;
    double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
    std::uint32_t find(std::uint32_t v, Rule rule);
    std::uint32_t first_ear(std::uint32_t begin, std::uint32_t end, Rule rule);
    bool is_ear(std::uint32_t v, Rule rule);
    void set_convex(std::uint32_t v, bool convex);
    bool blocks(std::uint32_t q, const Triangle& ear, Rule rule) const;

    std::vector<Triangle> triangles_;
    std::vector<glm::dvec2> points_;  // counter-clockwise
    std::vector<std::uint32_t> previous_, next_;
    std::vector<char> may_block_;        // not strictly convex, and not yet clipped
    std::vector<std::uint64_t> convex_;  // a bit a corner: strictly convex, and not yet clipped
    // A k-d tree of the corners that may block: each node is a half of the part of blockers_ that
    // the node above it is.
    std::vector<Node> tree_;  // from 1
    std::vector<std::uint32_t> blockers_;
    std::vector<std::uint32_t> place_;       // of a corner in blockers_
    std::vector<std::uint32_t> blocked_by_;  // who kept a corner from being cut off, or kNone
};

}  // namespace bake
