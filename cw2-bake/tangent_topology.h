// How the corners of a triangle mesh hang together at its vertices, for the tangent generator.
#pragma once

#include <cstdint>
#include <vector>

#include "cw2-bake/tangent_directions.h"

namespace bake {

inline constexpr std::uint32_t kNoSlot = 0xFFFF'FFFF;

/// The corners of the faces that are not degenerate, by vertex, ascending within each: those of
/// vertex v are the slots first[v] .. first[v + 1].
struct CornerSlots {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> corner;
    /// Across the edge that leaves (arrives at) the slot's corner: the slot, at the same vertex,
    /// of the face on the other side, or kNoSlot. Where more than two faces share an edge, the
    /// k-th that leaves along it (in face order) and the k-th that arrives along it are neighbours.
    std::vector<std::uint32_t> across_leaving;
    std::vector<std::uint32_t> across_arriving;
};

CornerSlots make_slots(const TangentInput& mesh, const std::vector<FaceDirections>& faces);

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

/// Gives the faces without usable UVs the winding of the group that reaches them first, with
/// whichever corner; groups grow one after the other, in the order of their first corner.
void settle_windings(const TangentInput& mesh, const CornerSlots& slots,
                     std::vector<FaceDirections>& faces);

}  // namespace bake
