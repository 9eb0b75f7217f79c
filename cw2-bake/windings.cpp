#include "cw2-bake/windings.h"

#include <algorithm>
#include <numeric>

namespace bake {
namespace {

/// The vertices where both kinds of faces meet: nothing passes from face to face elsewhere.
void keep_mixed_vertices(CornerSlots& slots, std::span<const Spoke> spokes) {
    std::erase_if(slots.vertices, [&](const VertexSlots& vertex) {
        const auto own = spokes.subspan(vertex.first, vertex.degenerate - vertex.first);
        const auto usable = std::ranges::count(own, true, &Spoke::usable);
        return usable == 0 || usable == static_cast<std::ptrdiff_t>(own.size());
    });
}

}  // namespace

Windings::Windings(const SourceScene& scene, const CornerLists& lists)
    : unusable_(find_unusable_faces(scene)), preserving_(unusable_.size(), -1) {
    if (unusable_.empty() || unusable_.size() == scene.corners.size() / 3) return;
    std::vector<std::uint32_t> positions;
    for (const std::uint32_t face : unusable_) {
        for (std::size_t c = 0; c < 3; ++c)
            positions.push_back(scene.corners[3 * std::size_t{face} + c].position);
    }
    std::sort(positions.begin(), positions.end());
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());

    CornerSlots slots;
    SlotMaker maker(scene, slots);
    for (const std::uint32_t position : positions) maker.add(lists.at(position));
    std::vector<Spoke> spokes(slots.corner.size());
    make_spokes(scene, slots.corner, spokes.data());
    keep_mixed_vertices(slots, spokes);
    grow_groups(slots, spokes);
}

void Windings::grow_groups(const CornerSlots& slots, std::span<const Spoke> spokes) {
    std::vector<std::uint32_t> starts;
    for (const VertexSlots& vertex : slots.vertices) {
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot)
            if (spokes[slot].usable) starts.push_back(slot);
    }
    std::ranges::sort(starts, {}, [&](std::uint32_t slot) { return slots.corner[slot]; });

    std::vector<bool> grouped(slots.corner.size(), false);
    for (const std::uint32_t start : starts) {
        if (grouped[start]) continue;
        const bool preserving = spokes[start].preserving;
        grouped[start] = true;
        walk_around(slots, start, [&](std::uint32_t slot) {
            if (grouped[slot]) return false;
            bool joins = spokes[slot].preserving == preserving;
            if (!spokes[slot].usable) {
                signed char& settled = preserving_[find(slots.corner[slot] / 3)];
                if (settled < 0) settled = preserving;
                joins = settled == static_cast<signed char>(preserving);
            }
            grouped[slot] = joins;
            return joins;
        });
    }
}

void Windings::settle(std::span<const std::uint32_t> corners, std::span<Spoke> spokes) const {
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (spokes[i].usable) continue;
        const signed char settled = preserving_[find(corners[i] / 3)];
        if (settled >= 0) spokes[i].preserving = settled != 0;
    }
}

std::size_t Windings::find(std::uint32_t face) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(unusable_, face) - unusable_.begin());
}

}  // namespace bake
