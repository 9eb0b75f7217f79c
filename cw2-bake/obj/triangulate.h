// Polygons to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cw2-bake/obj/corner_set.h"

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
    /// crosses itself, or has no area, the triangles only connect its corners; so do the last ones
    /// where finding the others took more than kMostSteps steps a corner, which only spirals of
    /// tens of thousands of corners do.
    std::span<const Triangle> triangulate(std::span<const glm::vec3> polygon);

 private:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    static constexpr std::size_t kLeaf = 8;            // corners that are not divided further
    static constexpr std::uint64_t kMostSteps = 2048;  // a corner, on the average

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
    Node node_around(std::size_t begin, std::size_t end) const;
    void build_tree(std::size_t node, std::size_t begin, std::size_t end);
    void stop_blocking(std::uint32_t v);
    std::uint32_t blocker(const Triangle& ear, Rule rule, std::size_t node, std::size_t begin,
                          std::size_t end);
    double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
    std::uint32_t find(std::uint32_t v, Rule rule);
    bool is_ear(std::uint32_t v, Rule rule);
    void sort_in(std::uint32_t v);
    void sort_out(std::uint32_t v);
    void wait_for(std::uint32_t v, std::uint32_t blocker);
    void wait_no_longer(std::uint32_t v);
    bool blocks(std::uint32_t q, const Triangle& ear, Rule rule) const;

    std::vector<Triangle> triangles_;
    std::vector<glm::dvec2> points_;  // counter-clockwise
    std::vector<std::uint32_t> previous_, next_;
    std::vector<char> may_block_;  // not strictly convex, and not yet clipped
    CornerSet convex_;             // strictly, and not yet clipped
    CornerSet flat_;               // without area, and not yet clipped
    CornerSet candidates_;         // of the convex, those that wait for none
    std::uint64_t steps_ = 0;      // nodes of the tree that were looked at
    // A k-d tree of the corners that may block: each node is a half of the part of blockers_ that
    // the node above it is.
    std::vector<Node> tree_;  // from 1
    std::vector<std::uint32_t> blockers_;
    std::vector<std::uint32_t> place_;  // of a corner in blockers_
    // Whom a corner waits for, or kNone: as long as that one blocks, and the corner has the same
    // neighbours, it is no ear. Those that wait for one are a list.
    std::vector<std::uint32_t> blocked_by_;
    std::vector<std::uint32_t> first_waiting_, next_waiting_, previous_waiting_;
};

}  // namespace bake
