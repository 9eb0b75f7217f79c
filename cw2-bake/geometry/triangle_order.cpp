#include "cw2-bake/geometry/triangle_order.h"

#include <algorithm>
#include <cassert>

namespace bake {

void TriangleOrder::list_triangles(std::span<const std::uint16_t> indices,
                                   std::size_t vertex_count) {
    std::fill_n(left_.begin(), vertex_count, std::uint16_t{0});
    for (const std::uint16_t index : indices) ++left_[index];
    std::uint16_t sum = 0;
    for (std::size_t v = 0; v < vertex_count; ++v) {
        sum = static_cast<std::uint16_t>(sum + left_[v]);
        first_[v] = sum;
    }
    first_[vertex_count] = sum;
    // Backwards, so that each vertex's triangles ascend and first_ ends at the first.
    for (std::size_t triangle = indices.size() / 3; triangle-- > 0;) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            triangles_[--first_[indices[3 * triangle + corner]]] =
                static_cast<std::uint16_t>(triangle);
        }
    }
}

/// Returns how many.
std::size_t TriangleOrder::gather_fan(std::uint16_t vertex,
                                      std::span<const std::uint16_t> indices) {
    std::size_t count = 0;
    const std::size_t end = first_[vertex + 1u];
    for (std::size_t i = first_[vertex]; i < end; ++i) {
        fan_[count].triangle = triangles_[i];
        count += !done_[triangles_[i]];
    }
    for (std::size_t i = 0; i < count; ++i) {
        Blade& blade = fan_[i];
        const std::uint16_t* const corners = &indices[3 * std::size_t{blade.triangle}];
        const std::size_t corner = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
        blade.first = corners[corner == 2 ? 0 : corner + 1];
        blade.last = corners[corner == 0 ? 2 : corner - 1];
        blade.goes_on = false;
        blades_[blade.first] = static_cast<std::uint16_t>(i);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t next = blades_[fan_[i].last];
        if (next < count && fan_[next].first == fan_[i].last) fan_[next].goes_on = true;
    }
    return count;
}

void TriangleOrder::emit_around(std::uint16_t vertex, std::span<const std::uint16_t> indices) {
    std::size_t used = candidates_ = recent_count_;
    std::uint32_t time = time_;
    // Without a branch on what no one can predict.
    const auto use = [&](std::uint16_t v) {
        const bool enters = time - entered_[v] > kCacheSize;
        entered_[v] = enters ? static_cast<std::uint16_t>(time) : entered_[v];
        time += enters;
    };
    const std::size_t count = gather_fan(vertex, indices);
    // Those that go on from none are the starts; what is left then goes round. A triangle with two
    // equal corners is there twice.
    std::size_t left = count;
    for (std::size_t i = 0; i < 2 * count && left > 0; ++i) {
        std::size_t next = i < count ? i : i - count;
        if (done_[fan_[next].triangle] || (fan_[next].goes_on && i < count)) continue;
        use(fan_[next].first);
        recent_[used++] = fan_[next].first;
        Blade blade;
        do {
            blade = fan_[next];
            done_[blade.triangle] = true;
            result_[result_count_++] = blade.triangle;
            --left;
            use(vertex);
            use(blade.last);
            recent_[used++] = blade.last;
            --left_[blade.first];
            --left_[blade.last];
            next = blades_[blade.last];
        } while (next < count && fan_[next].first == blade.last && !done_[fan_[next].triangle]);
    }
    left_[vertex] = 0;
    recent_count_ = used;
    time_ = time;
}

/// The vertex in the cache that entered it first and will still be there once its own triangles
/// are drawn; else one used lately; else the first that is left. kNone if none is.
std::uint16_t TriangleOrder::next_vertex(std::size_t vertex_count) {
    // A score, and below it a number that is larger for vertices that come earlier.
    std::uint32_t best = 0xFFFF;
    for (std::size_t i = candidates_; i < recent_count_; ++i) {
        const std::uint16_t v = recent_[i];
        const std::uint32_t age = time_ - entered_[v];
        const std::uint32_t stays = age + 2u * left_[v] <= kCacheSize ? age + 1 : 1;
        const std::uint32_t score = left_[v] > 0 ? stays : 0;
        best = std::max(best, score << 16 | static_cast<std::uint32_t>(0xFFFF - i));
    }
    if (best > 0xFFFF) return recent_[0xFFFF - (best & 0xFFFF)];
    while (recent_count_ > 0) {
        const std::uint16_t v = recent_[--recent_count_];
        if (left_[v] > 0) return v;
    }
    for (; scan_ < vertex_count; ++scan_)
        if (left_[scan_] > 0) return scan_;
    return kNone;
}

std::span<const std::uint16_t> TriangleOrder::order(std::span<const std::uint16_t> indices,
                                                    std::size_t vertex_count) {
    assert(indices.size() <= kMaxCorners && vertex_count <= kMaxCorners);
    list_triangles(indices, vertex_count);
    time_ = kCacheSize + 1;
    std::fill_n(entered_.begin(), vertex_count, std::uint16_t{0});
    std::fill_n(done_.begin(), indices.size() / 3, false);
    std::fill_n(blades_.begin(), vertex_count, std::uint16_t{0});
    recent_count_ = candidates_ = result_count_ = 0;
    scan_ = 0;
    for (std::uint16_t v = next_vertex(vertex_count); v != kNone; v = next_vertex(vertex_count))
        emit_around(v, indices);
    return std::span(result_).first(result_count_);
}

}  // namespace bake
