// How the corners of triangles hang together at their vertices, for the tangent generator.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cw2-bake/raw_vector.h"
#include "cw2-bake/source_scene.h"

namespace bake {

inline constexpr std::uint32_t kNoSlot = 0xFFFF'FFFF;

inline std::uint32_t next_corner(std::uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

inline std::uint32_t previous_corner(std::uint32_t corner) {
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/// The corners at each position of a welded scene: those of position p, ascending, are
/// corner[first[p]] .. corner[first[p + 1]].
struct CornerLists {
    std::vector<std::uint32_t> first;
    RawVector<std::uint32_t> corner;

    std::span<const std::uint32_t> at(std::uint32_t position) const {
        return std::span(corner).subspan(first[position], first[position + 1] - first[position]);
    }
};

CornerLists list_corners(const SourceScene& scene);

/// The corners of some vertices: those of vertex v are the slots first .. end. Faces with two
/// corners at one position are degenerate and take no part: theirs come last.
struct VertexSlots {
    std::uint32_t first;  ///< corners of other faces, ascending
    std::uint32_t degenerate;
    std::uint32_t end;
};

struct CornerSlots {
    std::vector<VertexSlots> vertices;
    std::vector<std::uint32_t> corner;
    /// Across the edge that leaves (arrives at) the slot's corner: the slot, at the same vertex,
    /// of the face on the other side, or kNoSlot. Where more than two faces share an edge, the
    /// k-th that leaves along it (in face order) and the k-th that arrives along it are neighbours.
    std::vector<std::uint32_t> across_leaving;
    std::vector<std::uint32_t> across_arriving;

    void clear();
};

/// Adds the vertices at one position after another to `slots`, linked.
class SlotMaker {
 public:
    SlotMaker(const SourceScene& scene, CornerSlots& slots) : scene_(scene), slots_(slots) {}

    /// `corners` are all those at one position, ascending.
    void add(std::span<const std::uint32_t> corners);

 private:
    struct Key {
        std::uint32_t normal, uv, material;
        bool degenerate;
        std::uint32_t corner;

        bool same_vertex(const Key& other) const {
            return normal == other.normal && uv == other.uv && material == other.material;
        }
        auto operator<=>(const Key&) const = default;
    };
    struct Spoke {
        Corner end;  ///< the edge's other end
        std::uint32_t slot;
    };

    void make_keys(std::span<const std::uint32_t> corners);
    void link(const VertexSlots& vertex);
    void link_by_search();
    void link_by_sorting();
    void join(const Spoke& leaving, const Spoke& arriving) {
        slots_.across_leaving[leaving.slot] = arriving.slot;
        slots_.across_arriving[arriving.slot] = leaving.slot;
    }

    const SourceScene& scene_;
    CornerSlots& slots_;
    std::vector<Key> keys_;
    std::vector<Spoke> leaving_;
    std::vector<Spoke> arriving_;
};

/// Walks from `start` across the edges at its vertex, both ways round, and calls visit(slot) for
/// each slot; a false answer ends the way. As each slot has one neighbour either way, this reaches
/// all that hangs together with `start`.
template <typename Visit>
void walk_around(const CornerSlots& slots, std::uint32_t start, Visit&& visit) {
    for (std::uint32_t slot = slots.across_leaving[start]; slot != kNoSlot && visit(slot);)
        slot = slots.across_leaving[slot];
    for (std::uint32_t slot = slots.across_arriving[start]; slot != kNoSlot && visit(slot);)
        slot = slots.across_arriving[slot];
}

}  // namespace bake
