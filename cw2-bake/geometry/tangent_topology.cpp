#include "cw2-bake/geometry/tangent_topology.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "common/every_cpu.h"

namespace bake {
namespace {

constexpr std::size_t kBlockCorners = 1 << 11;

/// Of each block of corners the range of its vertices.
std::vector<VertexRange> ranges_of_blocks(std::span<const std::uint32_t> indices) {
    std::vector<VertexRange> ranges((indices.size() + kBlockCorners - 1) / kBlockCorners);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ranges.size(), 8), [&](const auto& some) {
        for (std::size_t i = some.begin(); i < some.end(); ++i) {
            const auto block = indices.subspan(i * kBlockCorners);
            ranges[i] = range_of(block.data(), std::min(block.size(), kBlockCorners));
        }
    });
    return ranges;
}

}  // namespace

CW2_EVERY_CPU VertexRange range_of(const std::uint32_t* vertices, std::size_t count) {
    VertexRange range{vertices[0], vertices[0]};
    for (std::size_t i = 1; i < count; ++i) {
        range.low = vertices[i] < range.low ? vertices[i] : range.low;
        range.high = vertices[i] > range.high ? vertices[i] : range.high;
    }
    return range;
}

/// Each task lists the corners of its own range of vertices, and reads all blocks of corners where
/// one may be: so the lists are ascending, and no task waits for another's counts but at the one
/// barrier.
CornerLists list_corners(const FramedTriangles& triangles, std::span<const std::uint8_t> wanted) {
    const auto vertex_count = static_cast<std::uint32_t>(triangles.vertices.size());
    const std::size_t tasks =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const auto first_vertex = [&](std::size_t task) {
        return static_cast<std::uint32_t>(std::uint64_t{vertex_count} * task / tasks);
    };
    const std::vector<VertexRange> ranges = ranges_of_blocks(triangles.indices);
    const auto for_own_corners = [&](std::size_t task, auto&& visit) {
        const std::uint32_t begin = first_vertex(task);
        const std::uint32_t size = first_vertex(task + 1) - begin;
        for (std::size_t block = 0; block < ranges.size(); ++block) {
            if (ranges[block].high < begin || ranges[block].low >= begin + size) continue;
            const auto first = static_cast<std::uint32_t>(block * kBlockCorners);
            const auto end = static_cast<std::uint32_t>(
                std::min<std::size_t>(first + kBlockCorners, triangles.indices.size()));
            for (std::uint32_t c = first; c < end; ++c) {
                const std::uint32_t vertex = triangles.indices[c];
                if (vertex - begin < size && wanted[vertex]) visit(vertex, c);
            }
        }
    };

    CornerLists lists;
    lists.first.resize(std::size_t{vertex_count} + 1);
    lists.first[0] = 0;
    std::vector<std::uint32_t> totals(tasks + 1);
    // In place of vertex + 1: how many corners, then where the next of them goes, which is at last
    // where the next vertex's list starts.
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
        std::fill(lists.first.begin() + 1 + first_vertex(task),
                  lists.first.begin() + 1 + first_vertex(task + 1), 0);
        std::uint32_t total = 0;
        for_own_corners(task, [&](std::uint32_t vertex, std::uint32_t) {
            ++lists.first[vertex + 1];
            ++total;
        });
        totals[task + 1] = total;
    });
    for (std::size_t task = 0; task < tasks; ++task) totals[task + 1] += totals[task];
    lists.corner.resize(totals.back());
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
        std::uint32_t start = totals[task];
        for (std::uint32_t v = first_vertex(task); v < first_vertex(task + 1); ++v)
            start += std::exchange(lists.first[v + 1], start);
        for_own_corners(task, [&](std::uint32_t vertex, std::uint32_t corner) {
            lists.corner[lists.first[vertex + 1]++] = corner;
        });
    });
    return lists;
}

void CornerSlots::assign(const FramedTriangles& triangles, const CornerLists& lists,
                         std::span<const std::uint32_t> of_vertices) {
    constexpr std::size_t kAhead = 8;
    std::size_t count = 0;
    for (const std::uint32_t vertex : of_vertices) count += lists.at(vertex).size();
    vertices.clear();
    slots.resize(count);
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < of_vertices.size(); ++i) {
        // What is first asked of the corners' faces lies all over the memory.
        for (const std::uint32_t corner :
             lists.at(of_vertices[std::min(i + kAhead, of_vertices.size() - 1)]))
            __builtin_prefetch(&triangles.indices[corner]);
        const auto corners = lists.at(of_vertices[i]);
        add(triangles, corners, first);
        first += static_cast<std::uint32_t>(corners.size());
    }
}

/// MikkTSpace's answers hang on the order of the faces in the source.
std::span<const std::uint32_t> CornerSlots::in_source_order(
    const FramedTriangles& triangles, std::span<const std::uint32_t> corners) {
    const std::uint32_t* const sources = triangles.sources.data();
    std::uint32_t before = 0;
    bool in_order = true;
    for (const std::uint32_t corner : corners) {
        const std::uint32_t source = sources[corner / 3];
        in_order &= source >= before;
        before = source;
    }
    if (in_order) return corners;
    ordered_.clear();
    for (const std::uint32_t corner : corners)
        ordered_.push_back(std::uint64_t{sources[corner / 3]} << 32 | corner);
    std::ranges::sort(ordered_);
    corners_.clear();
    for (const std::uint64_t corner : ordered_)
        corners_.push_back(static_cast<std::uint32_t>(corner));
    return corners_;
}

/// The slots of a vertex, from `first` on; `corners` are all those there, ascending.
void CornerSlots::add(const FramedTriangles& triangles, std::span<const std::uint32_t> corners,
                      std::uint32_t first) {
    // Tables, as no processor foresees which of its face's corners the next one is.
    constexpr std::uint32_t kNext[] = {1, 2, 0};
    constexpr std::uint32_t kPrevious[] = {2, 0, 1};
    const std::uint32_t end = first + static_cast<std::uint32_t>(corners.size());
    if (!triangles.sources.empty()) corners = in_source_order(triangles, corners);
    Slot* slot = slots.data() + first;
    std::uint32_t degenerate = 0;
    for (const std::uint32_t corner : corners) {
        const std::uint32_t face = corner / 3;
        const std::uint32_t* const of_face = &triangles.indices[3 * std::size_t{face}];
        const std::uint32_t k = corner - 3 * face;
        slot->own = of_face[k];
        slot->next = of_face[kNext[k]];
        slot->previous = of_face[kPrevious[k]];
        slot->face = face;
        slot->corner = corner;
        const std::uint32_t a = triangles.vertices[of_face[0]].corner.position;
        const std::uint32_t b = triangles.vertices[of_face[1]].corner.position;
        const std::uint32_t c = triangles.vertices[of_face[2]].corner.position;
        // Not ||: no processor foresees such faces.
        slot->degenerate = std::uint32_t{a == b} | std::uint32_t{b == c} | std::uint32_t{c == a};
        degenerate += slot->degenerate;
        ++slot;
    }
    if (degenerate != 0)
        std::stable_sort(slots.begin() + first, slots.begin() + end,
                         [](const Slot& a, const Slot& b) { return a.degenerate < b.degenerate; });
    vertices.push_back({first, end - degenerate, end});
}

void SlotLinks::link(const CornerSlots& slots, const VertexSlots& vertex) {
    across_leaving_.resize(slots.slots.size());
    across_arriving_.resize(slots.slots.size());
    leaving_.clear();
    arriving_.clear();
    for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot) {
        leaving_.push_back({slots.slots[slot].next, slot});
        arriving_.push_back({slots.slots[slot].previous, slot});
        across_leaving_[slot] = across_arriving_[slot] = kNoSlot;
    }
    std::ranges::sort(leaving_);
    std::ranges::sort(arriving_);
    auto leaving = leaving_.begin();
    auto arriving = arriving_.begin();
    while (leaving != leaving_.end() && arriving != arriving_.end()) {
        if (leaving->end < arriving->end) {
            ++leaving;
        } else if (arriving->end < leaving->end) {
            ++arriving;
        } else {
            across_leaving_[leaving->slot] = arriving->slot;
            across_arriving_[arriving->slot] = leaving->slot;
            ++leaving;
            ++arriving;
        }
    }
}

}  // namespace bake
