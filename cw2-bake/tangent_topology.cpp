#include "cw2-bake/tangent_topology.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <tuple>

namespace bake {
namespace {

auto as_tuple(const Corner& corner) {
    return std::tie(corner.position, corner.normal, corner.uv);
}

bool equal(const Corner& a, const Corner& b) {
    return ((a.position ^ b.position) | (a.normal ^ b.normal) | (a.uv ^ b.uv)) == 0;
}

}  // namespace

/// Each task lists the corners of its own range of positions, and reads all corners to find them:
/// so the lists are ascending, and no task waits for another's counts but at the one barrier.
CornerLists list_corners(const SourceScene& scene) {
    const auto position_count = static_cast<std::uint32_t>(scene.positions.size());
    const std::size_t tasks =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const auto first_position = [&](std::size_t task) {
        return static_cast<std::uint32_t>(std::uint64_t{position_count} * task / tasks);
    };
    const auto for_own_corners = [&](std::size_t task, auto&& visit) {
        const std::uint32_t begin = first_position(task);
        const std::uint32_t size = first_position(task + 1) - begin;
        const auto count = static_cast<std::uint32_t>(scene.corners.size());
        for (std::uint32_t c = 0; c < count; ++c) {
            const std::uint32_t position = scene.corners[c].position;
            if (position - begin < size) visit(position, c);
        }
    };

    CornerLists lists;
    lists.first.resize(position_count + 1);
    lists.first[0] = 0;
    std::vector<std::uint32_t> totals(tasks + 1);
    // In place of position + 1: how many corners, then where the next of them goes, which is at
    // last where the next position's list starts.
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
        std::fill(lists.first.begin() + 1 + first_position(task),
                  lists.first.begin() + 1 + first_position(task + 1), 0);
        std::uint32_t total = 0;
        for_own_corners(task, [&](std::uint32_t position, std::uint32_t) {
            ++lists.first[position + 1];
            ++total;
        });
        totals[task + 1] = total;
    });
    for (std::size_t task = 0; task < tasks; ++task) totals[task + 1] += totals[task];
    lists.corner.resize(scene.corners.size());
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
        std::uint32_t start = totals[task];
        for (std::uint32_t p = first_position(task); p < first_position(task + 1); ++p)
            start += std::exchange(lists.first[p + 1], start);
        for_own_corners(task, [&](std::uint32_t position, std::uint32_t corner) {
            lists.corner[lists.first[position + 1]++] = corner;
        });
    });
    return lists;
}

void CornerSlots::add(const SourceScene& scene, std::span<const std::uint32_t> corners) {
    // Tables, as no processor foresees which of its face's corners the next one is.
    constexpr std::uint32_t kNext[] = {1, 2, 0};
    constexpr std::uint32_t kPrevious[] = {2, 0, 1};
    const std::size_t first = slots.size();
    slots.resize(first + corners.size());
    Slot* slot = &slots[first];
    std::uint32_t differences = 0;
    for (const std::uint32_t corner : corners) {
        const std::uint32_t face = corner / 3;
        const Corner* const of_face = &scene.corners[3 * std::size_t{face}];
        const std::uint32_t k = corner % 3;
        *slot = {of_face[k],
                 of_face[kNext[k]],
                 of_face[kPrevious[k]],
                 scene.triangle_material[face],
                 face,
                 corner};
        differences |= (slot->own.normal ^ slots[first].own.normal) |
                       (slot->own.uv ^ slots[first].own.uv) |
                       (slot->material ^ slots[first].material) | std::uint32_t{slot->degenerate()};
        ++slot;
    }
    const auto begin = static_cast<std::uint32_t>(first);
    const auto end = static_cast<std::uint32_t>(slots.size());
    if (differences != 0)
        add_vertices(begin);
    else if (begin < end)
        vertices.push_back({begin, end, end});
}

/// Sorts the slots from `first` on.
void CornerSlots::add_vertices(std::uint32_t first) {
    const auto vertex_of = [](const Slot& slot) {
        return std::tie(slot.own.normal, slot.own.uv, slot.material);
    };
    std::sort(slots.begin() + first, slots.end(), [&](const Slot& a, const Slot& b) {
        return std::tuple_cat(vertex_of(a), std::tuple(a.degenerate(), a.corner)) <
               std::tuple_cat(vertex_of(b), std::tuple(b.degenerate(), b.corner));
    });
    for (std::uint32_t i = first; i < slots.size();) {
        VertexSlots vertex{.first = i};
        const auto is_same = [&] {
            return i < slots.size() && vertex_of(slots[i]) == vertex_of(slots[vertex.first]);
        };
        while (is_same() && !slots[i].degenerate()) ++i;
        vertex.degenerate = i;
        while (is_same()) ++i;
        vertex.end = i;
        vertices.push_back(vertex);
    }
}

void SlotLinks::link(const VertexSlots& vertex) {
    across_leaving_.resize(slots_.slots.size());
    across_arriving_.resize(slots_.slots.size());
    leaving_.clear();
    arriving_.clear();
    for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot) {
        leaving_.push_back({slots_.slots[slot].next, slot});
        arriving_.push_back({slots_.slots[slot].previous, slot});
        across_leaving_[slot] = across_arriving_[slot] = kNoSlot;
    }
    const auto before = [](const Edge& a, const Edge& b) {
        return std::tuple_cat(as_tuple(a.end), std::tie(a.slot)) <
               std::tuple_cat(as_tuple(b.end), std::tie(b.slot));
    };
    std::sort(leaving_.begin(), leaving_.end(), before);
    std::sort(arriving_.begin(), arriving_.end(), before);
    auto leaving = leaving_.begin();
    auto arriving = arriving_.begin();
    while (leaving != leaving_.end() && arriving != arriving_.end()) {
        if (as_tuple(leaving->end) < as_tuple(arriving->end)) {
            ++leaving;
        } else if (as_tuple(arriving->end) < as_tuple(leaving->end)) {
            ++arriving;
        } else {
            across_leaving_[leaving->slot] = arriving->slot;
            across_arriving_[arriving->slot] = leaving->slot;
            ++leaving;
            ++arriving;
        }
    }
}

bool hang_together(std::span<const Slot> slots) {
    // 16 bits of a position tell which faces may be neighbours: bit i of candidates[j], whether j
    // arrives from where i leaves to.
    using Few = std::uint16_t __attribute__((vector_size(2 * kFewSlots)));
    Few from{};
    Few candidates{};
    const std::size_t count = slots.size();
    for (std::size_t i = 0; i < count; ++i)
        from[i] = static_cast<std::uint16_t>(slots[i].previous.position);
    for (std::size_t i = 0; i < count; ++i) {
        const Few to = Few{} + static_cast<std::uint16_t>(slots[i].next.position);
        candidates |= (from == to) & static_cast<std::uint16_t>(1u << i);
    }
    constexpr std::size_t kNobody = kFewSlots;
    std::uint8_t next[kFewSlots + 1];
    std::fill(std::begin(next), std::end(next), kNobody);
    std::uint32_t taken = 0;
    std::uint32_t shared = 0;
    std::size_t ends = 0;
    std::size_t start = 0;
    for (std::size_t j = 0; j < count; ++j) {
        const std::uint32_t matches = candidates[j];
        shared |= matches & (taken | (matches - 1));
        taken |= matches;
        const std::size_t i = static_cast<std::size_t>(std::countr_zero(matches | 0x100)) % 8;
        const bool linked = matches != 0 && equal(slots[i].next, slots[j].previous);
        next[linked ? i : kNobody] = static_cast<std::uint8_t>(linked ? j : kNobody);
        ends += !linked;
        start = linked ? start : j;
    }
    if (shared != 0 || ends > 1) return false;
    std::size_t at = start;
    for (std::size_t step = 1; step < count; ++step) {
        at = next[at];
        if (at == start || at == kNobody) return false;
    }
    return true;
}

}  // namespace bake
