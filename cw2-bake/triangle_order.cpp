#include "cw2-bake/triangle_order.h"

#include <cassert>

namespace bake {

void TriangleOrder::list_triangles(std::span<const std::uint16_t> indices,
                                   std::size_t vertex_count) {
    left_.assign(vertex_count, 0);
    for (const std::uint16_t index : indices) ++left_[index];
    first_.resize(vertex_count);
    std::uint16_t sum = 0;
    for (std::size_t v = 0; v < vertex_count; ++v) {
        first_[v] = sum;
        sum = static_cast<std::uint16_t>(sum + left_[v]);
    }
    triangles_.resize(indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i)
        triangles_[first_[indices[i]]++] = static_cast<std::uint16_t>(i / 3);
    for (std::size_t v = 0; v < vertex_count; ++v)
        first_[v] = static_cast<std::uint16_t>(first_[v] - left_[v]);
}

void TriangleOrder::emit_around(std::uint16_t vertex, std::span<const std::uint16_t> indices) {
    candidates_.clear();
    const std::size_t begin = first_[vertex];
    const std::size_t end = vertex + 1u < first_.size() ? first_[vertex + 1] : triangles_.size();
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint16_t triangle = triangles_[i];
        if (done_[triangle]) continue;
        done_[triangle] = true;
        result_.push_back(triangle);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint16_t v = indices[3 * std::size_t{triangle} + corner];
            candidates_.push_back(v);
            recent_.push_back(v);
            --left_[v];
            if (time_ - entered_[v] > kCacheSize) entered_[v] = time_++;
        }
    }
}

/// The vertex in the cache that entered it first and will still be there once its own triangles
/// are drawn; else one used lately; else the first that is left. kNone if none is.
std::uint16_t TriangleOrder::next_vertex(std::size_t vertex_count) {
    std::uint16_t best = kNone;
    std::uint32_t best_age = 0;
    for (const std::uint16_t v : candidates_) {
        if (left_[v] == 0) continue;
        const std::uint32_t age = time_ - entered_[v];
        const std::uint32_t score = age + 2u * left_[v] <= kCacheSize ? age + 1 : 1;
        if (score > best_age) {
            best_age = score;
            best = v;
        }
    }
    if (best != kNone) return best;
    while (!recent_.empty()) {
        const std::uint16_t v = recent_.back();
        recent_.pop_back();
        if (left_[v] > 0) return v;
    }
    for (; scan_ < vertex_count; ++scan_)
        if (left_[scan_] > 0) return scan_;
    return kNone;
}

std::span<const std::uint16_t> TriangleOrder::order(std::span<const std::uint16_t> indices,
                                                    std::size_t vertex_count) {
    assert(indices.size() < 0x10000 && vertex_count < kNone);
    list_triangles(indices, vertex_count);
    entered_.assign(vertex_count, 0);
    time_ = kCacheSize + 1;
    done_.assign(indices.size() / 3, false);
    recent_.clear();
    result_.clear();
    scan_ = 0;
    candidates_.clear();
    for (std::uint16_t v = next_vertex(vertex_count); v != kNone; v = next_vertex(vertex_count))
        emit_around(v, indices);
    return result_;
}

}  // namespace bake
