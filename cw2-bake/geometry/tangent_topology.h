// How the corners of triangles hang together at their vertices, for the tangent generator.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/geometry/weld.h"

namespace bake {

inline constexpr std::uint32_t kNoSlot = 0xFFFF'FFFF;

struct VertexRange {
    std::uint32_t low, high;
};

/// Of at least one vertex the lowest and the highest.
VertexRange range_of(const std::uint32_t* vertices, std::size_t count);

/// The corners at each vertex: those of vertex v, ascending, are corner[first[v]] ..
/// corner[first[v + 1]].
struct CornerLists {
    RawVector<std::uint32_t> first;
    RawVector<std::uint32_t> corner;

    std::span<const std::uint32_t> at(std::uint32_t vertex) const {
        return std::span(corner).subspan(first[vertex], first[vertex + 1] - first[vertex]);
    }
};

/// Of the vertices of which `wanted` holds a 1, not a 0; the others' are empty.
CornerLists list_corners(const FramedTriangles& triangles, std::span<const std::uint8_t> wanted);

/// A corner, and what its face has to do with others there.
struct Slot {
    std::uint32_t own;   ///< vertex
    std::uint32_t next;  ///< the face's
    std::uint32_t previous;
    std::uint32_t face;
    std::uint32_t corner;      ///< 3 face + 0, 1 or 2
    std::uint32_t degenerate;  ///< 1 if two corners of the face are at one position, or 0
};

/// The corners of a vertex: the slots first .. end. Degenerate faces take no part: theirs come
/// last.
struct VertexSlots {
    std::uint32_t first;  ///< corners of other faces, ascending
    std::uint32_t degenerate;
    std::uint32_t end;
};

struct CornerSlots {
    std::vector<VertexSlots> vertices;
    RawVector<Slot> slots;

    /// Takes these vertices, which all have corners, instead of those it has.
    void assign(const FramedTriangles& triangles, const CornerLists& lists,
                std::span<const std::uint32_t> of_vertices);

 private:
    std::span<const std::uint32_t> in_source_order(const FramedTriangles& triangles,
                                                   std::span<const std::uint32_t> corners);
    void add(const FramedTriangles& triangles, std::span<const std::uint32_t> corners,
             std::uint32_t first);

    // Of one vertex:
    std::vector<std::uint64_t> ordered_;  ///< a face's number in the source, below it its corner
    std::vector<std::uint32_t> corners_;
};

/// Which slots at a vertex are neighbours: faces that share an edge there, one leaving along it and
/// one arriving.
class SlotLinks {
 public:
    /// Where more than two faces share an edge, the k-th that leaves along it (in face order) and
    /// the k-th that arrives along it are neighbours.
    void link(const CornerSlots& slots, const VertexSlots& vertex);

    /// Walks from `start`, of a vertex that is linked, across the edges at the vertex, both ways
    /// round, and calls visit(slot) for each slot; a false answer ends the way. As each slot has
    /// one neighbour either way, this reaches all that hangs together with `start`.
    template <typename Visit>
    void walk_around(std::uint32_t start, Visit&& visit) const {
        for (std::uint32_t slot = across_leaving_[start]; slot != kNoSlot && visit(slot);)
            slot = across_leaving_[slot];
        for (std::uint32_t slot = across_arriving_[start]; slot != kNoSlot && visit(slot);)
            slot = across_arriving_[slot];
    }

 private:
    struct Edge {
        std::uint32_t end;  ///< the other vertex
        std::uint32_t slot;
        auto operator<=>(const Edge&) const = default;
    };

    // Across the edge that leaves (arrives at) the slot's corner: the slot, at the same vertex, of
    // the face on the other side, or kNoSlot.
    std::vector<std::uint32_t> across_leaving_;
    std::vector<std::uint32_t> across_arriving_;
    std::vector<Edge> leaving_;
    std::vector<Edge> arriving_;
};

}  // namespace bake
