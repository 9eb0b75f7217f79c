#include "cw2-bake/tangent_topology.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>

namespace bake {
namespace {

auto as_tuple(const Corner& corner) {
    return std::tie(corner.position, corner.normal, corner.uv);
}

bool equal(const Corner& a, const Corner& b) {
    return as_tuple(a) == as_tuple(b);
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
    std::vector<std::uint32_t> totals(tasks + 1);
    // Counts in place of position + 1: where the next position's list starts, within the task's.
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
        std::uint32_t total = 0;
        for_own_corners(task, [&](std::uint32_t position, std::uint32_t) {
            ++lists.first[position + 1];
            ++total;
        });
        totals[task + 1] = total;
    });
    for (std::size_t task = 0; task < tasks; ++task) totals[task + 1] += totals[task];
    lists.corner.resize(scene.corners.size());
    RawVector<std::uint32_t> next(position_count);
    tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
        std::uint32_t start = totals[task];
        for (std::uint32_t p = first_position(task); p < first_position(task + 1); ++p) {
            next[p] = start;
            start += lists.first[p + 1];
            lists.first[p + 1] = start;
        }
        for_own_corners(task, [&](std::uint32_t position, std::uint32_t corner) {
            lists.corner[next[position]++] = corner;
        });
    });
    return lists;
}

void CornerSlots::clear() {
    vertices.clear();
    corner.clear();
    across_leaving.clear();
    across_arriving.clear();
}

void SlotMaker::make_keys(std::span<const std::uint32_t> corners) {
    keys_.clear();
    bool sorted = true;
    for (const std::uint32_t c : corners) {
        const Corner* face = &scene_.corners[c - c % 3];
        const bool degenerate = face[0].position == face[1].position ||
                                face[0].position == face[2].position ||
                                face[1].position == face[2].position;
        const Corner& own = scene_.corners[c];
        keys_.push_back({own.normal, own.uv, scene_.triangle_material[c / 3], degenerate, c});
        sorted &= keys_.size() == 1 || keys_[keys_.size() - 2] < keys_.back();
    }
    if (!sorted) std::sort(keys_.begin(), keys_.end());
}

void SlotMaker::add(std::span<const std::uint32_t> corners) {
    make_keys(corners);
    for (std::size_t i = 0; i < keys_.size();) {
        const Key& key = keys_[i];
        VertexSlots vertex{.first = static_cast<std::uint32_t>(slots_.corner.size())};
        for (; i < keys_.size() && keys_[i].same_vertex(key) && !keys_[i].degenerate; ++i)
            slots_.corner.push_back(keys_[i].corner);
        vertex.degenerate = static_cast<std::uint32_t>(slots_.corner.size());
        for (; i < keys_.size() && keys_[i].same_vertex(key); ++i)
            slots_.corner.push_back(keys_[i].corner);
        vertex.end = static_cast<std::uint32_t>(slots_.corner.size());
        slots_.vertices.push_back(vertex);
        slots_.across_leaving.resize(vertex.end, kNoSlot);
        slots_.across_arriving.resize(vertex.end, kNoSlot);
        link(vertex);
    }
}

void SlotMaker::link(const VertexSlots& vertex) {
    constexpr std::uint32_t kFew = 24;
    leaving_.clear();
    arriving_.clear();
    for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot) {
        const std::uint32_t corner = slots_.corner[slot];
        leaving_.push_back({scene_.corners[next_corner(corner)], slot});
        arriving_.push_back({scene_.corners[previous_corner(corner)], slot});
    }
    if (leaving_.size() <= kFew)
        link_by_search();
    else
        link_by_sorting();
}

void SlotMaker::link_by_search() {
    for (const Spoke& leaving : leaving_) {
        for (const Spoke& arriving : arriving_) {
            if (!equal(arriving.end, leaving.end) ||
                slots_.across_arriving[arriving.slot] != kNoSlot)
                continue;
            join(leaving, arriving);
            break;
        }
    }
}

void SlotMaker::link_by_sorting() {
    const auto before = [](const Spoke& a, const Spoke& b) {
        return std::tuple_cat(as_tuple(a.end), std::tie(a.slot)) <
               std::tuple_cat(as_tuple(b.end), std::tie(b.slot));
    };
    std::sort(leaving_.begin(), leaving_.end(), before);
    std::sort(arriving_.begin(), arriving_.end(), before);
    auto leaving = leaving_.begin();
    auto arriving = arriving_.begin();
    while (leaving != leaving_.end() && arriving != arriving_.end()) {
        if (as_tuple(leaving->end) < as_tuple(arriving->end))
            ++leaving;
        else if (as_tuple(arriving->end) < as_tuple(leaving->end))
            ++arriving;
        else
            join(*leaving++, *arriving++);
    }
}

}  // namespace bake
