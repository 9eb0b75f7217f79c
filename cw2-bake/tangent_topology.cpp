#include "cw2-bake/tangent_topology.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace bake {
namespace {

constexpr std::uint32_t kVerticesPerBlock = 2048;

class SlotLinker {
 public:
    SlotLinker(const TangentInput& mesh, CornerSlots& slots) : mesh_(mesh), slots_(slots) {}

    void link(std::uint32_t vertex) {
        const std::uint32_t begin = slots_.first[vertex];
        const std::uint32_t end = slots_.first[vertex + 1];
        leaving_.clear();
        arriving_.clear();
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            const std::uint32_t corner = slots_.corner[slot];
            leaving_.push_back({mesh_.indices[next_corner(corner)], slot});
            arriving_.push_back({mesh_.indices[previous_corner(corner)], slot});
        }
        if (end - begin <= kFew)
            link_by_search();
        else
            link_by_sorting();
    }

 private:
    static constexpr std::uint32_t kFew = 24;

    struct Spoke {
        std::uint32_t vertex;  ///< the edge's other end
        std::uint32_t slot;
        auto operator<=>(const Spoke&) const = default;
    };

    void join(const Spoke& leaving, const Spoke& arriving) {
        slots_.across_leaving[leaving.slot] = arriving.slot;
        slots_.across_arriving[arriving.slot] = leaving.slot;
    }

    void link_by_search() {
        for (const Spoke& leaving : leaving_) {
            for (const Spoke& arriving : arriving_) {
                if (arriving.vertex != leaving.vertex ||
                    slots_.across_arriving[arriving.slot] != kNoSlot)
                    continue;
                join(leaving, arriving);
                break;
            }
        }
    }

    void link_by_sorting() {
        std::ranges::sort(leaving_);
        std::ranges::sort(arriving_);
        auto leaving = leaving_.begin();
        auto arriving = arriving_.begin();
        while (leaving != leaving_.end() && arriving != arriving_.end()) {
            if (leaving->vertex < arriving->vertex)
                ++leaving;
            else if (arriving->vertex < leaving->vertex)
                ++arriving;
            else
                join(*leaving++, *arriving++);
        }
    }

    const TangentInput& mesh_;
    CornerSlots& slots_;
    std::vector<Spoke> leaving_;
    std::vector<Spoke> arriving_;
};

void link_slots(const TangentInput& mesh, CornerSlots& slots) {
    slots.across_leaving.assign(slots.corner.size(), kNoSlot);
    slots.across_arriving.assign(slots.corner.size(), kNoSlot);
    const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, vertices, kVerticesPerBlock),
                      [&](const auto& block) {
                          SlotLinker linker(mesh, slots);
                          for (std::uint32_t v = block.begin(); v < block.end(); ++v)
                              linker.link(v);
                      });
}

}  // namespace

CornerSlots make_slots(const TangentInput& mesh, const std::vector<FaceDirections>& faces) {
    CornerSlots slots;
    slots.first.assign(mesh.positions.size() + 2, 0);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (faces[f].degenerate) continue;
        for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) ++slots.first[mesh.indices[c] + 2];
    }
    for (std::size_t v = 2; v < slots.first.size(); ++v) slots.first[v] += slots.first[v - 1];
    slots.corner.resize(slots.first.back());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (faces[f].degenerate) continue;
        // first[v + 1] is where v's next corner goes, and so ends up as where v + 1 begins.
        for (std::size_t c = 3 * f; c < 3 * f + 3; ++c)
            slots.corner[slots.first[mesh.indices[c] + 1]++] = static_cast<std::uint32_t>(c);
    }
    slots.first.pop_back();
    link_slots(mesh, slots);
    return slots;
}

void settle_windings(const TangentInput& mesh, const CornerSlots& slots,
                     std::vector<FaceDirections>& faces) {
    std::vector<std::uint32_t> slot_of_corner(mesh.indices.size(), kNoSlot);
    for (std::size_t v = 0; v + 1 < slots.first.size(); ++v) {
        const auto begin = slots.corner.begin() + slots.first[v];
        const auto end = slots.corner.begin() + slots.first[v + 1];
        if (std::all_of(begin, end, [&](std::uint32_t corner) { return faces[corner / 3].usable; }))
            continue;
        for (std::uint32_t slot = slots.first[v]; slot < slots.first[v + 1]; ++slot)
            slot_of_corner[slots.corner[slot]] = slot;
    }

    std::vector<bool> grouped(slots.corner.size(), false);
    std::vector<bool> settled(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) settled[f] = faces[f].usable;
    for (std::size_t corner = 0; corner < slot_of_corner.size(); ++corner) {
        const std::uint32_t start = slot_of_corner[corner];
        if (start == kNoSlot || grouped[start] || !faces[corner / 3].usable) continue;
        const bool preserving = faces[corner / 3].preserving;
        grouped[start] = true;
        walk_around(slots, start, [&](std::uint32_t slot) {
            const std::uint32_t f = slots.corner[slot] / 3;
            if (grouped[slot]) return false;
            if (!settled[f]) {
                settled[f] = true;
                faces[f].preserving = preserving;
            }
            const bool joins = faces[f].preserving == preserving;
            grouped[slot] = joins;
            return joins;
        });
    }
}

}  // namespace bake
