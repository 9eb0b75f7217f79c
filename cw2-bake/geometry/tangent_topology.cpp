#include "cw2-bake/geometry/tangent_topology.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <tuple>

#include "common/every_cpu.h"

namespace bake {
namespace {

auto as_tuple(const Corner& corner) {
    return std::tie(corner.position, corner.normal, corner.uv);
}

/// 0 if they are equal.
CW2_INLINE std::uint32_t difference(const Corner& a, const Corner& b) {
    return (a.position ^ b.position) | (a.normal ^ b.normal) | (a.uv ^ b.uv);
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

void CornerSlots::assign(const SourceScene& scene, const CornerLists& lists,
                         std::span<const std::uint32_t> positions) {
    constexpr std::size_t kAhead = 8;
    std::size_t count = 0;
    for (const std::uint32_t position : positions) count += lists.at(position).size();
    vertices.clear();
    slots.resize(count);
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        // What is first asked of the corners' faces lies all over the memory.
        for (const std::uint32_t corner :
             lists.at(positions[std::min(i + kAhead, positions.size() - 1)]))
            __builtin_prefetch(&scene.corners[corner]);
        const auto corners = lists.at(positions[i]);
        add(scene, corners, first);
        first += static_cast<std::uint32_t>(corners.size());
    }
    leaving.resize(count + kFewSlots);
    arriving.resize(count + kFewSlots);
    for (std::size_t i = 0; i < count; ++i) {
        leaving[i] = static_cast<std::uint16_t>(slots[i].next.position);
        arriving[i] = static_cast<std::uint16_t>(slots[i].previous.position);
    }
}

/// The slots of a position, from `first` on, and its vertices; `corners` are all those there,
/// ascending.
void CornerSlots::add(const SourceScene& scene, std::span<const std::uint32_t> corners,
                      std::uint32_t first) {
    // Tables, as no processor foresees which of its face's corners the next one is.
    constexpr std::uint32_t kNext[] = {1, 2, 0};
    constexpr std::uint32_t kPrevious[] = {2, 0, 1};
    const std::uint32_t end = first + static_cast<std::uint32_t>(corners.size());
    Slot* slot = slots.data() + first;
    std::uint32_t differences = 0;
    for (const std::uint32_t corner : corners) {
        const std::uint32_t face = corner / 3;
        const Corner* const of_face = &scene.corners[3 * std::size_t{face}];
        const std::uint32_t k = corner - 3 * face;
        slot->own = of_face[k];
        slot->next = of_face[kNext[k]];
        slot->previous = of_face[kPrevious[k]];
        slot->face = face;
        slot->corner = corner;
        slot->material = scene.triangle_material[face];
        differences |= (slot->own.normal ^ slots[first].own.normal) |
                       (slot->own.uv ^ slots[first].own.uv) |
                       (slot->material ^ slots[first].material) | std::uint32_t{slot->degenerate()};
        ++slot;
    }
    if (differences != 0)
        sort(first, end);
    else if (first < end)
        vertices.push_back({first, end, end});
}

/// Sorts slots of one position into its vertices.
void CornerSlots::sort(std::uint32_t first, std::uint32_t end) {
    const auto vertex_of = [](const Slot& slot) {
        return std::tie(slot.own.normal, slot.own.uv, slot.material);
    };
    std::sort(slots.begin() + first, slots.begin() + end, [&](const Slot& a, const Slot& b) {
        return std::tuple_cat(vertex_of(a), std::tuple(a.degenerate(), a.corner)) <
               std::tuple_cat(vertex_of(b), std::tuple(b.degenerate(), b.corner));
    });
    while (first < end) {
        VertexSlots vertex{first, first, first};
        const auto is_same = [&] {
            return vertex.end < end && vertex_of(slots[vertex.end]) == vertex_of(slots[first]);
        };
        for (; is_same(); ++vertex.end)
            if (!slots[vertex.end].degenerate()) vertex.degenerate = vertex.end + 1;
        vertices.push_back(vertex);
        first = vertex.end;
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

CW2_EVERY_CPU bool hang_together(const CornerSlots& all, std::uint32_t first, std::uint32_t count) {
    // Half a position tells which faces may be neighbours: bit i of candidates[j], whether j
    // arrives from where i leaves to.
    using Few = std::uint16_t __attribute__((vector_size(2 * kFewSlots)));
    Few from;
    std::memcpy(&from, &all.arriving[first], sizeof(from));
    Few candidates{};
    Few bit = Few{} + 1;
    for (std::size_t i = 0; i < count; ++i) {
        candidates |= (from == Few{} + all.leaving[first + i]) & bit;
        bit += bit;
    }
    const Slot* const slots = &all.slots[first];
    constexpr std::size_t kNobody = kFewSlots;
    std::uint8_t next[kFewSlots + 1];
    std::fill(std::begin(next), std::end(next), kNobody);
    std::uint32_t doubts = 0;
    std::uint32_t ends = 0;
    std::size_t start = 0;
    for (std::size_t j = 0; j < count; ++j) {
        const std::uint32_t matches = candidates[j];
        const auto i = static_cast<std::size_t>(std::countr_zero(matches | 1u << kNobody));
        const bool is_end = matches == 0;
        const Corner& from_j = slots[j].previous;
        const Corner& to_j = is_end ? from_j : slots[i].next;
        doubts |= (matches & (matches - 1)) | difference(from_j, to_j);
        next[i] = static_cast<std::uint8_t>(j);
        ends += is_end;
        start = is_end ? j : start;
    }
    if (doubts != 0 || ends > 1) return false;
    std::size_t at = start;
    for (std::size_t step = 1; step < count; ++step) {
        at = next[at];
        if (at == start || at == kNobody) return false;
    }
    return ends == 1 || next[at] == start;
}

}  // namespace bake
