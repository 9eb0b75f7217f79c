#include "cw2-bake/triangulate.h"

#include <algorithm>
#include <cmath>

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

std::size_t Triangulator::grid_cell(double offset, double extent) const {
    if (!(extent > 0)) return 0;
    const double cell = offset / extent * static_cast<double>(grid_side_);
    return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(grid_side_ - 1)));
}

void Triangulator::build_grid() {
    glm::dvec2 low = points_[0], high = points_[0];
    for (const glm::dvec2& p : points_) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    grid_min_ = low;
    grid_extent_ = high - low;
    const auto blocking = std::count(may_block_.begin(), may_block_.end(), 1);
    grid_side_ = 1 + static_cast<std::size_t>(std::sqrt(static_cast<double>(blocking) / 2));

    const auto cell_of = [&](std::uint32_t v) {
        const glm::dvec2 offset = points_[v] - grid_min_;
        return grid_cell(offset.y, grid_extent_.y) * grid_side_ +
               grid_cell(offset.x, grid_extent_.x);
    };
    cell_start_.assign(grid_side_ * grid_side_ + 1, 0);
    for (std::uint32_t v = 0; v < points_.size(); ++v) {
        if (may_block_[v]) ++cell_start_[cell_of(v) + 1];
    }
    for (std::size_t i = 1; i < cell_start_.size(); ++i) cell_start_[i] += cell_start_[i - 1];
    cell_corners_.resize(static_cast<std::size_t>(blocking));
    std::vector<std::uint32_t> place(cell_start_.begin(), cell_start_.end() - 1);
    for (std::uint32_t v = 0; v < points_.size(); ++v) {
        if (may_block_[v]) cell_corners_[place[cell_of(v)]++] = v;
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

bool Triangulator::may_clip(std::uint32_t v, Rule rule) const {
    const Triangle ear{previous_[v], v, next_[v]};
    if (rule == Rule::any) return true;
    const double area = turn(ear[0], ear[1], ear[2]);
    if (rule == Rule::without_area) return area == 0;
    if (area <= 0) return false;
    if (rule == Rule::convex) return true;

    glm::dvec2 low = points_[v], high = points_[v];
    for (const std::uint32_t corner : {ear[0], ear[2]}) {
        low = {std::min(low.x, points_[corner].x), std::min(low.y, points_[corner].y)};
        high = {std::max(high.x, points_[corner].x), std::max(high.y, points_[corner].y)};
    }
    low -= grid_min_;
    high -= grid_min_;
    const std::size_t x0 = grid_cell(low.x, grid_extent_.x);
    const std::size_t x1 = grid_cell(high.x, grid_extent_.x);
    const std::size_t y1 = grid_cell(high.y, grid_extent_.y);
    for (std::size_t y = grid_cell(low.y, grid_extent_.y); y <= y1; ++y) {
        const std::uint32_t begin = cell_start_[y * grid_side_ + x0];
        const std::uint32_t end = cell_start_[y * grid_side_ + x1 + 1];
        for (std::uint32_t i = begin; i < end; ++i) {
            if (may_block_[cell_corners_[i]] && blocks(cell_corners_[i], ear, rule)) return false;
        }
    }
    return true;
}

void Triangulator::clip_ears() {
    const auto count = static_cast<std::uint32_t>(points_.size());
    previous_.resize(count);
    next_.resize(count);
    may_block_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        previous_[i] = (i + count - 1) % count;
        next_[i] = (i + 1) % count;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        may_block_[i] = turn(previous_[i], i, next_[i]) <= 0;
    }
    build_grid();

    std::uint32_t left = count, v = 0;
    const auto clip = [&] {
        const std::uint32_t a = previous_[v], c = next_[v];
        triangles_.push_back({a, v, c});
        next_[a] = c;
        previous_[c] = a;
        may_block_[v] = 0;
        for (const std::uint32_t end : {a, c}) {
            may_block_[end] = may_block_[end] && turn(previous_[end], end, next_[end]) <= 0;
        }
        --left;
    };
    Rule rule = Rule::ear;
    for (std::uint32_t refused = 0; left > 3;) {
        if (may_clip(v, rule)) {
            clip();
            refused = 0;
            // An outline that needed a later rule is no polygon: the strict one gains nothing.
            if (rule == Rule::without_area) rule = Rule::ear;
            v = next_[next_[v]];  // taking every other corner makes fewer slivers
        } else {
            v = next_[v];
            if (++refused < left) continue;
            refused = 0;
            rule = static_cast<Rule>(static_cast<int>(rule) + 1);
        }
    }
    triangles_.push_back({previous_[v], v, next_[v]});
}

}  // namespace bake
