#include "cw2-bake/geometry/windings.h"

#include <algorithm>

namespace bake {
namespace {

/// The vertices where both kinds of faces meet: nothing passes from face to face elsewhere.
void keep_mixed_vertices(CornerSlots& slots, const Spokes& spokes) {
    std::erase_if(slots.vertices, [&](const VertexSlots& vertex) {
        std::uint32_t usable = 0;
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot)
            usable += spokes.usable(slot);
        return usable == 0 || usable == vertex.degenerate - vertex.first;
    });
}

}  // namespace

Windings::Windings(const SourceScene& scene, const FramedTriangles& triangles,
                   const CornerLists& lists)
    : unusable_(find_unusable_faces(scene, triangles)), preserving_(unusable_.size(), -1) {
    if (unusable_.empty() || unusable_.size() == triangles.indices.size() / 3) return;
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t face : unusable_) {
        for (std::size_t c = 0; c < 3; ++c)
            vertices.push_back(triangles.indices[3 * std::size_t{face} + c]);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

    CornerSlots slots;
    slots.assign(triangles, lists, vertices);
    Spokes spokes;
    spokes.make(scene, triangles, slots.slots);
    keep_mixed_vertices(slots, spokes);
    SlotLinks links;
    for (const VertexSlots& vertex : slots.vertices) links.link(slots, vertex);
    grow_groups(slots, links, spokes);
}

void Windings::grow_groups(const CornerSlots& slots, const SlotLinks& links, const Spokes& spokes) {
    std::vector<std::uint32_t> starts;
    for (const VertexSlots& vertex : slots.vertices) {
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot)
            if (spokes.usable(slot)) starts.push_back(slot);
    }
    std::ranges::sort(starts, {}, [&](std::uint32_t slot) { return slots.slots[slot].corner; });

    std::vector<bool> grouped(slots.slots.size(), false);
    for (const std::uint32_t start : starts) {
        if (grouped[start]) continue;
        const bool preserving = spokes.preserving(start);
        grouped[start] = true;
        links.walk_around(start, [&](std::uint32_t slot) {
            if (grouped[slot]) return false;
            bool joins = spokes.preserving(slot) == preserving;
            if (!spokes.usable(slot)) {
                signed char& settled = preserving_[find(slots.slots[slot].face)];
                if (settled < 0) settled = preserving;
                joins = settled == static_cast<signed char>(preserving);
            }
            grouped[slot] = joins;
            return joins;
        });
    }
}

bool Windings::preserving(std::uint32_t face, bool otherwise) const {
    const signed char settled = preserving_[find(face)];
    return settled < 0 ? otherwise : settled != 0;
}

std::size_t Windings::find(std::uint32_t face) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(unusable_, face) - unusable_.begin());
}

}  // namespace bake
