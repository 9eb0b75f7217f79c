#include "cw2-bake/geometry/windings.h"

#include <algorithm>

namespace bake {

Windings::Windings(const SourceScene& scene, const FramedTriangles& triangles,
                   const CornerLists& lists, std::span<const std::uint32_t> mixed) {
    CornerSlots slots;
    slots.assign(triangles, lists, mixed);
    Spokes spokes;
    spokes.make(scene, triangles, slots.slots);
    for (std::uint32_t slot = 0; slot < slots.slots.size(); ++slot)
        if (!spokes.usable(slot)) unusable_.push_back(slots.slots[slot].face);
    std::ranges::sort(unusable_);
    unusable_.erase(std::unique(unusable_.begin(), unusable_.end()), unusable_.end());
    preserving_.assign(unusable_.size(), -1);
    SlotLinks links;
    for (const VertexSlots& vertex : slots.vertices) links.link(slots, vertex);
    grow_groups(triangles, slots, links, spokes);
}

void Windings::grow_groups(const FramedTriangles& triangles, const CornerSlots& slots,
                           const SlotLinks& links, const Spokes& spokes) {
    std::vector<std::uint32_t> starts;
    for (const VertexSlots& vertex : slots.vertices) {
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot)
            if (spokes.usable(slot)) starts.push_back(slot);
    }
    std::ranges::sort(starts, {}, [&](std::uint32_t slot) {
        return triangles.source_of(slots.slots[slot].corner);
    });

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
