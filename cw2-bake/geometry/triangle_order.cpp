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

void TriangleOrder::emit_around(std::uint16_t vertex, std::span<const std::uint16_t> indices) {
    std::size_t used = candidates_ = recent_count_;
    std::uint32_t time = time_;
    const std::size_t end = first_[vertex + 1u];
    for (std::size_t i = first_[vertex]; i < end; ++i) {
        const std::uint16_t triangle = triangles_[i];
        if (done_[triangle]) continue;
        done_[triangle] = true;
        result_[result_count_++] = triangle;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint16_t v = indices[3 * std::size_t{triangle} + corner];
            // No branches on what no one can predict.
            recent_[used] = v;
            used += v != vertex;  // which will be done
            --left_[v];
            const bool enters = time - entered_[v] > kCacheSize;
            entered_[v] = enters ? static_cast<std::uint16_t>(time) : entered_[v];
            time += enters;
        }
    }
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
    recent_count_ = candidates_ = result_count_ = 0;
    scan_ = 0;
    for (std::uint16_t v = next_vertex(vertex_count); v != kNone; v = next_vertex(vertex_count))
        emit_around(v, indices);
    return std::span(result_).first(result_count_);
}

}  // namespace bake
