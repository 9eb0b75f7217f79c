#include "cw2-bake/obj/triangulate.h"

#include <algorithm>
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

/// A box around blockers_[begin .. end - 1].
Triangulator::Node Triangulator::node_around(std::size_t begin, std::size_t end) const {
    Node node{.low = points_[blockers_[begin]], .count = static_cast<std::uint32_t>(end - begin)};
    node.high = node.low;
    for (std::size_t i = begin; i < end; ++i) {
        const glm::dvec2& p = points_[blockers_[i]];
        node.low = {std::min(node.low.x, p.x), std::min(node.low.y, p.y)};
        node.high = {std::max(node.high.x, p.x), std::max(node.high.y, p.y)};
    }
    return node;
}

/// The node `node` over blockers_[begin .. end - 1]; its halves are the nodes 2 node and 2 node
/// + 1. They are cut apart along its longer axis, but for corners that the other one leaves in much
/// smaller boxes: of two long rows, one beside the other, each half has one, and an ear that
/// reaches across meets few boxes.
void Triangulator::build_tree(std::size_t node, std::size_t begin, std::size_t end) {
    if (tree_.size() <= node) tree_.resize(2 * node + 2);
    tree_[node] = node_around(begin, end);
    if (end - begin <= kLeaf) return;
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&](std::size_t i) {
        return blockers_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    const auto halve = [&](int axis) {
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
            return points_[a][axis] < points_[b][axis];
        });
        const auto area = [](const Node& box) {
            return (box.high.x - box.low.x) * (box.high.y - box.low.y);
        };
        return area(node_around(begin, middle)) + area(node_around(middle, end));
    };
    const glm::dvec2 size = tree_[node].high - tree_[node].low;
    const int longer = size.x < size.y ? 1 : 0;
    if (halve(longer) <= 4 * halve(1 - longer)) halve(longer);
    build_tree(2 * node, begin, middle);
    build_tree(2 * node + 1, middle, end);
}

/// Takes notice in the nodes that corner v blocks no longer.
void Triangulator::stop_blocking(std::uint32_t v) {
    if (!may_block_[v]) return;
    may_block_[v] = 0;
    while (first_waiting_[v] != kNone) wait_no_longer(first_waiting_[v]);
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

/// A corner in `node` that blocks the ear, or kNone. The edges do not tell what lies beyond the tip
/// of a thin ear; its own box does. Sums and products round monotonically, so that
/// a corner of a box that lies behind an edge shows the same of all that is in the box.
std::uint32_t Triangulator::blocker(const Triangle& ear, Rule rule, std::size_t node,
                                    std::size_t begin, std::size_t end) {
    ++steps_;
    const glm::dvec2 &a = points_[ear[0]], &b = points_[ear[1]], &c = points_[ear[2]];
    const Node& box = tree_[node];
    if (box.count == 0) return kNone;
    const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
    const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
    if (box.high.x < low_x || box.low.x > high_x || box.high.y < low_y || box.low.y > high_y)
        return kNone;
    const bool is_point = box.low == box.high;
    if (is_point && (box.low == a || box.low == c)) return kNone;  // see blocks()
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 from = points_[ear[i]];
        const glm::dvec2 edge = points_[ear[(i + 1) % 3]] - from;
        const glm::dvec2 foremost{edge.y < 0 ? box.high.x : box.low.x,
                                  edge.x > 0 ? box.high.y : box.low.y};
        if (edge.x * (foremost.y - from.y) - edge.y * (foremost.x - from.x) < 0) return kNone;
    }
    if (end - begin > kLeaf) {
        const std::size_t middle = (begin + end) / 2;
        // A half that is drawn: of corners that are cut off one after the other, any one blocks for
        // longer, on the average, than the first of them.
        const bool left_first = ((ear[1] ^ node) * 0x9E37'79B9'7F4A'7C15) >> 63 == 0;
        for (const bool left : {left_first, !left_first}) {
            const std::uint32_t found = left ? blocker(ear, rule, 2 * node, begin, middle)
                                             : blocker(ear, rule, 2 * node + 1, middle, end);
            if (found != kNone) return found;
        }
        return kNone;
    }
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t q = blockers_[i];
        if (may_block_[q] && blocks(q, ear, rule)) return q;
    }
    return kNone;
}

/// Corner v is looked at again only when `blocker` blocks no longer, or v's neighbours change: else
/// a comb's teeth would all be looked at for each that is cut off.
void Triangulator::wait_for(std::uint32_t v, std::uint32_t blocker) {
    wait_no_longer(v);
    candidates_.erase(v);
    blocked_by_[v] = blocker;
    previous_waiting_[v] = kNone;
    next_waiting_[v] = first_waiting_[blocker];
    if (next_waiting_[v] != kNone) previous_waiting_[next_waiting_[v]] = v;
    first_waiting_[blocker] = v;
}

void Triangulator::wait_no_longer(std::uint32_t v) {
    const std::uint32_t blocker = blocked_by_[v];
    if (blocker == kNone) return;
    const std::uint32_t before = previous_waiting_[v], after = next_waiting_[v];
    (before == kNone ? first_waiting_[blocker] : next_waiting_[before]) = after;
    if (after != kNone) previous_waiting_[after] = before;
    blocked_by_[v] = kNone;
    candidates_.insert(v);
}

bool Triangulator::is_ear(std::uint32_t v, Rule rule) {
    if (rule == Rule::convex || blockers_.empty()) return true;
    const std::uint32_t found = blocker({previous_[v], v, next_[v]}, rule, 1, 0, blockers_.size());
    if (found != kNone) wait_for(v, found);
    return found == kNone;
}

/// Takes notice of the shape of a corner whose neighbours are new.
void Triangulator::sort_in(std::uint32_t v) {
    sort_out(v);
    const double area = turn(previous_[v], v, next_[v]);
    if (area > 0) {
        convex_.insert(v);
        candidates_.insert(v);
    } else if (area == 0) {
        flat_.insert(v);
    }
}

void Triangulator::sort_out(std::uint32_t v) {
    wait_no_longer(v);
    convex_.erase(v);
    candidates_.erase(v);
    flat_.erase(v);
}

/// The corner to cut off by this rule that comes first from v on, once around; kNone if none does.
std::uint32_t Triangulator::find(std::uint32_t v, Rule rule) {
    if (rule == Rule::any) return v;
    const CornerSet& set = rule == Rule::without_area ? flat_ : candidates_;
    const auto first_in = [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = set.next(begin); i < end; i = set.next(i + 1)) {
            if (rule == Rule::without_area || is_ear(i, rule)) return i;
        }
        return kNone;
    };
    const std::uint32_t after = first_in(v, static_cast<std::uint32_t>(points_.size()));
    return after != kNone ? after : first_in(0, v);
}

void Triangulator::clip_ears() {
    const auto count = static_cast<std::uint32_t>(points_.size());
    previous_.resize(count);
    next_.resize(count);
    may_block_.resize(count);
    for (CornerSet* set : {&convex_, &flat_, &candidates_}) set->clear(count);
    for (std::vector<std::uint32_t>* list :
         {&blocked_by_, &first_waiting_, &next_waiting_, &previous_waiting_})
        list->assign(count, kNone);
    for (std::uint32_t i = 0; i < count; ++i) {
        previous_[i] = (i + count - 1) % count;
        next_[i] = (i + 1) % count;
    }
    blockers_.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        sort_in(i);
        may_block_[i] = !convex_.contains(i);
        if (may_block_[i]) blockers_.push_back(i);
    }
    if (!blockers_.empty()) build_tree(1, 0, blockers_.size());
    place_.resize(count);
    for (std::uint32_t i = 0; i < blockers_.size(); ++i) place_[blockers_[i]] = i;

    std::uint32_t left = count, v = 0;
    Rule rule = Rule::ear;
    steps_ = 0;
    while (left > 3) {
        if (steps_ > kMostSteps * count && rule != Rule::any && rule != Rule::convex) {
            rule = Rule::convex;
            candidates_ = convex_;
        }
        const std::uint32_t found = find(v, rule);
        if (found == kNone) {
            rule = static_cast<Rule>(static_cast<int>(rule) + 1);
            // What blocked by the strict rule need not by a later one.
            if (rule == Rule::clear_inside || rule == Rule::convex) candidates_ = convex_;
            continue;
        }
        const std::uint32_t a = previous_[found], c = next_[found];
        triangles_.push_back({a, found, c});
        next_[a] = c;
        previous_[c] = a;
        stop_blocking(found);
        sort_out(found);
        for (const std::uint32_t end : {a, c}) {
            sort_in(end);
            if (convex_.contains(end)) stop_blocking(end);
        }
        --left;
        // An outline that needed a later rule is no polygon: the strict one gains nothing.
        if (rule == Rule::without_area) rule = Rule::ear;
        v = next_[c];  // taking every other corner makes fewer slivers
    }
    triangles_.push_back({previous_[v], v, next_[v]});
}

}  // namespace bake
