#include "cw2-bake/obj/triangulate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace bake {

/// Drops the axis nearest to the normal, so that coordinates stay what they were and the sign of
/// turn() is exact for floats of similar size. False if the polygon has no area.
bool Triangulator::project(std::span<const glm::vec3> polygon) {
    glm::dvec3 normal{0.0};
    const glm::dvec3 origin{polygon[0]};
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const glm::dvec3 a = glm::dvec3{polygon[i]} - origin;
        const glm::dvec3 b = glm::dvec3{polygon[i + 1]} - origin;
        normal.x += a.y * b.z - a.z * b.y;
        normal.y += a.z * b.x - a.x * b.z;
        normal.z += a.x * b.y - a.y * b.x;
    }
    int axis = std::abs(normal.y) > std::abs(normal.x) ? 1 : 0;
    if (std::abs(normal.z) > std::abs(normal[axis])) axis = 2;
    if (normal[axis] == 0) return false;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    points_.clear();
    for (const glm::vec3& p : polygon) points_.emplace_back(p[u], p[v]);
    return true;
}

/// Twice the signed area of a triangle: positive if it is counter-clockwise.
double Triangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const glm::dvec2 ab = points_[b] - points_[a];
    const glm::dvec2 ac = points_[c] - points_[a];
    return ab.x * ac.y - ab.y * ac.x;
}

std::span<const Triangulator::Triangle> Triangulator::triangulate(
    std::span<const glm::vec3> polygon) {
    triangles_.clear();
    if (polygon.size() > 3 && project(polygon)) {
        if (polygon.size() == 4) {
            quad(polygon);
        } else {
            clip_ears();
        }
    } else {
        for (std::uint32_t i = 2; i < polygon.size(); ++i) triangles_.push_back({0, i - 1, i});
    }
    return triangles_;
}

void Triangulator::quad(std::span<const glm::vec3> polygon) {
    const double worst_02 = std::min(turn(0, 1, 2), turn(0, 2, 3));
    const double worst_13 = std::min(turn(1, 2, 3), turn(1, 3, 0));
    const auto length = [&](int a, int b) {
        const glm::dvec3 d = glm::dvec3{polygon[a]} - glm::dvec3{polygon[b]};
        return d.x * d.x + d.y * d.y + d.z * d.z;
    };
    const bool inside_02 = worst_02 > 0, inside_13 = worst_13 > 0;
    const bool cut_13 = inside_02 == inside_13
                            ? (inside_02 ? length(1, 3) < length(0, 2) : worst_13 > worst_02)
                            : inside_13;
    if (cut_13) {
        triangles_.push_back({0, 1, 3});
        triangles_.push_back({1, 2, 3});
    } else {
        triangles_.push_back({0, 1, 2});
        triangles_.push_back({0, 2, 3});
    }
}

/// The node `node` over blockers_[begin .. end - 1]; its halves are the nodes 2 node and 2 node
/// + 1.
void Triangulator::build_tree(std::size_t node, std::size_t begin, std::size_t end) {
    if (tree_.size() <= node) tree_.resize(2 * node + 2);
    Node built{.low = points_[blockers_[begin]], .count = static_cast<std::uint32_t>(end - begin)};
    built.high = built.low;
    for (std::size_t i = begin; i < end; ++i) {
        const glm::dvec2& p = points_[blockers_[i]];
        built.low = {std::min(built.low.x, p.x), std::min(built.low.y, p.y)};
        built.high = {std::max(built.high.x, p.x), std::max(built.high.y, p.y)};
    }
    tree_[node] = built;
    if (end - begin <= kLeaf) return;
    const int axis = built.high.x - built.low.x < built.high.y - built.low.y ? 1 : 0;
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t i) {
        return blockers_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
        return points_[a][axis] < points_[b][axis];
    });
    build_tree(2 * node, begin, middle);
    build_tree(2 * node + 1, middle, end);
}

/// Takes notice in the nodes that corner v blocks no longer.
void Triangulator::stop_blocking(std::uint32_t v) {
    if (!may_block_[v]) return;
    may_block_[v] = 0;
    std::size_t begin = 0, end = blockers_.size();
    for (std::size_t node = 1;;) {
        --tree_[node].count;
        if (end - begin <= kLeaf) return;
        const std::size_t middle = (begin + end) / 2;
        const bool right = place_[v] >= middle;
        (right ? begin : end) = middle;
        node = 2 * node + (right ? 1 : 0);
    }
}

/// Whether corner q stands against cutting off `ear`, whose middle is convex.
bool Triangulator::blocks(std::uint32_t q, const Triangle& ear, Rule rule) const {
    const auto [a, b, c] = ear;
    if (q == a || q == b || q == c) return false;
    const double along_ab = turn(a, b, q), along_bc = turn(b, c, q), along_ca = turn(c, a, q);
    if (rule == Rule::clear_inside) return along_ab > 0 && along_bc > 0 && along_ca > 0;
    if (along_ab < 0 || along_bc < 0 || along_ca < 0) return false;
    // Where the outline touches itself at an end of the cut, it does not enter the ear from there
    // without a corner that stands in it.
    return points_[q] != points_[a] && points_[q] != points_[c];
}

/// A corner in `node` that blocks the ear, or kNone. Sums and products round monotonically, so that
/// a corner of a box that lies behind an edge shows the same of all that is in the box.
std::uint32_t Triangulator::blocker(const Triangle& ear, Rule rule, std::size_t node,
                                    std::size_t begin, std::size_t end) const {
    const Node& box = tree_[node];
    if (box.count == 0) return kNone;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 from = points_[ear[i]];
        const glm::dvec2 edge = points_[ear[(i + 1) % 3]] - from;
        const glm::dvec2 foremost{edge.y < 0 ? box.high.x : box.low.x,
                                  edge.x > 0 ? box.high.y : box.low.y};
        if (edge.x * (foremost.y - from.y) - edge.y * (foremost.x - from.x) < 0) return kNone;
    }
    if (end - begin > kLeaf) {
        const std::size_t middle = (begin + end) / 2;
        const std::uint32_t found = blocker(ear, rule, 2 * node, begin, middle);
        return found != kNone ? found : blocker(ear, rule, 2 * node + 1, middle, end);
    }
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t q = blockers_[i];
        if (may_block_[q] && blocks(q, ear, rule)) return q;
    }
    return kNone;
}

bool Triangulator::is_ear(std::uint32_t v, Rule rule) {
    if (rule == Rule::convex || blockers_.empty()) return true;
    const Triangle ear{previous_[v], v, next_[v]};
    std::uint32_t& known = blocked_by_[v];
    if (known != kNone && may_block_[known] && blocks(known, ear, rule)) return false;
    known = blocker(ear, rule, 1, 0, blockers_.size());
    return known == kNone;
}

void Triangulator::set_convex(std::uint32_t v, bool convex) {
    const std::uint64_t bit = std::uint64_t{1} << v % 64;
    convex_[v / 64] = convex ? convex_[v / 64] | bit : convex_[v / 64] & ~bit;
}

/// The first of corners begin .. end - 1 that is convex and satisfies the rule, else `end`.
std::uint32_t Triangulator::first_ear(std::uint32_t begin, std::uint32_t end, Rule rule) {
    for (std::uint32_t v = begin; v < end; ++v) {
        const std::uint64_t word = convex_[v / 64] >> v % 64;
        if (word == 0) {
            v |= 63;
            continue;
        }
        v += static_cast<std::uint32_t>(std::countr_zero(word));
        if (v < end && is_ear(v, rule)) return v;
    }
    return end;
}

/// The corner to cut off by this rule that comes first from v on, once around; kNone if none does.
std::uint32_t Triangulator::find(std::uint32_t v, Rule rule) {
    if (rule == Rule::any) return v;
    if (rule == Rule::without_area) {
        const std::uint32_t start = v;
        do {
            if (turn(previous_[v], v, next_[v]) == 0) return v;
            v = next_[v];
        } while (v != start);
        return kNone;
    }
    const auto count = static_cast<std::uint32_t>(points_.size());
    const std::uint32_t after = first_ear(v, count, rule);
    if (after < count) return after;
    const std::uint32_t before = first_ear(0, v, rule);
    return before < v ? before : kNone;
}

void Triangulator::clip_ears() {
    const auto count = static_cast<std::uint32_t>(points_.size());
    previous_.resize(count);
    next_.resize(count);
    may_block_.resize(count);
    convex_.assign(count / 64 + 1, 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        previous_[i] = (i + count - 1) % count;
        next_[i] = (i + 1) % count;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const bool convex = turn(previous_[i], i, next_[i]) > 0;
        may_block_[i] = !convex;
        set_convex(i, convex);
    }
    blockers_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        if (may_block_[i]) blockers_.push_back(i);
    }
    if (!blockers_.empty()) build_tree(1, 0, blockers_.size());
    blocked_by_.assign(count, kNone);
    place_.resize(count);
    for (std::uint32_t i = 0; i < blockers_.size(); ++i) place_[blockers_[i]] = i;

    std::uint32_t left = count, v = 0;
    Rule rule = Rule::ear;
    while (left > 3) {
        const std::uint32_t found = find(v, rule);
        if (found == kNone) {
            rule = static_cast<Rule>(static_cast<int>(rule) + 1);
            continue;
        }
        const std::uint32_t a = previous_[found], c = next_[found];
        triangles_.push_back({a, found, c});
        next_[a] = c;
        previous_[c] = a;
        stop_blocking(found);
        set_convex(found, false);
        for (const std::uint32_t end : {a, c}) {
            const bool convex = turn(previous_[end], end, next_[end]) > 0;
            if (convex) stop_blocking(end);
            set_convex(end, convex);
        }
        --left;
        // An outline that needed a later rule is no polygon: the strict one gains nothing.
        if (rule == Rule::without_area) rule = Rule::ear;
        v = next_[c];  // taking every other corner makes fewer slivers
    }
    triangles_.push_back({previous_[v], v, next_[v]});
}

}  // namespace bake
