#include "cw2-bake/geometry/tangents.h"

#include <tbb/concurrent_queue.h>
#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <numeric>

#include "cw2-bake/geometry/tangent_directions.h"
#include "cw2-bake/geometry/tangent_topology.h"
#include "cw2-bake/geometry/windings.h"

namespace bake {
namespace {

using glm::vec3;
using glm::vec4;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
constexpr vec4 kUnreached{1.0f, 0.0f, 0.0f, -1.0f};
constexpr std::uint32_t kPositionsPerBlock = 256;

bool is_unit(const vec3& v) {
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-3f;
}

/// v in unit length, or v itself where it is too short to have a direction.
vec3 unit_or_zero(const vec3& v) {
    const float squared = glm::dot(v, v);
    return squared > 0.0f ? (1.0f / std::sqrt(squared)) * v : v;
}

/// Whether the angle is clearly below 90 degrees. Two directions that are both close to a third
/// cannot be opposite.
bool close(const vec3& a, const vec3& b) {
    return glm::dot(a, b) > 0.01f;
}

/// Makes the framed vertices at some positions; reused for one block of positions after another.
class FramedBlock {
 public:
    FramedBlock(const SourceScene& scene, const CornerLists& lists, const Windings& windings)
        : scene_(scene), lists_(lists), windings_(windings), links_(slots_) {}

    /// The positions begin .. end.
    void make(std::uint32_t begin, std::uint32_t end) {
        positions_.resize(end - begin);
        std::iota(positions_.begin(), positions_.end(), begin);
        slots_.assign(scene_, lists_, positions_);
        const std::size_t count = slots_.slots.size();
        spokes_.make(scene_, slots_.slots);
        group_.resize(count);
        tangents_.resize(count);
        vertex_.resize(count);
        vertices_.clear();
        colors_.clear();
        for (const VertexSlots& vertex : slots_.vertices) {
            if (!make_plain_vertex(vertex)) make_vertex(vertex);
        }
    }

    std::size_t vertex_count() const { return vertices_.size(); }

    /// Puts the vertices where number `first` is, and tells each corner its own's number.
    void store(std::uint32_t first, FramedTriangles& triangles) const {
        std::copy(vertices_.begin(), vertices_.end(), triangles.vertices.begin() + first);
        std::copy(colors_.begin(), colors_.end(), triangles.colors.begin() + first);
        for (std::size_t slot = 0; slot < vertex_.size(); ++slot)
            triangles.indices[slots_.slots[slot].corner] = first + vertex_[slot];
    }

 private:
    struct Group {
        std::uint32_t first;  ///< the first slot with usable UVs
        bool wide = false;    ///< not shown that no two faces have opposite directions
        vec3 sum{0.0f};
        vec4 tangent{0.0f};
    };

    /// Makes the vertex if all its faces are shown to be one group, no two of them opposite. Else
    /// answers false.
    bool make_plain_vertex(const VertexSlots& vertex) {
        const std::uint32_t count = vertex.degenerate - vertex.first;
        if (count == 0 || count > kFewSlots || !scene_.tangents.empty() || !scene_.colors.empty())
            return false;
        std::uint32_t usable = 0;
        std::uint32_t preserving = 0;
        vec3 sum{0.0f};
        vec3 sum_s{0.0f};
        vec3 sum_t{0.0f};
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot) {
            usable += spokes_.usable(slot);
            preserving += spokes_.preserving(slot);
            sum += spokes_.weighted_s(slot);
            sum_s += spokes_.s(slot);
            sum_t += spokes_.t(slot);
        }
        if (usable != count || (preserving != 0 && preserving != count)) return false;
        // Two opposite ones would leave count - 2 at most of these sums of unit vectors.
        const float enough = std::max(static_cast<float>(count) - 1.9f, 0.0f);
        if (glm::dot(sum_s, sum_s) < enough * enough || glm::dot(sum_t, sum_t) < enough * enough)
            return false;
        if (!hang_together(slots_, vertex.first, count)) return false;
        std::fill_n(vertex_.begin() + vertex.first, vertex.end - vertex.first,
                    static_cast<std::uint32_t>(vertices_.size()));
        vertices_.push_back({slots_.slots[vertex.first].own, tangent(sum, vertex.first)});
        return true;
    }

    void make_vertex(const VertexSlots& vertex) {
        const std::uint32_t begin = vertex.first;
        const std::uint32_t end = vertex.degenerate;
        std::fill(tangents_.begin() + begin, tangents_.begin() + vertex.end, kUnreached);
        std::fill(group_.begin() + begin, group_.begin() + vertex.end, kNone);
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            if (!spokes_.usable(slot))
                spokes_.set_preserving(
                    slot, windings_.preserving(slots_.slots[slot].face, spokes_.preserving(slot)));
        }
        find_groups(vertex);
        sum_groups(begin, end);
        for (std::uint32_t slot = begin; slot < end; ++slot)
            if (group_[slot] != kNone) tangents_[slot] = groups_[group_[slot]].tangent;
        exclude_opposites(begin, end);
        // A degenerate face takes what the first other one at the vertex has.
        if (begin < end) std::fill_n(tangents_.begin() + end, vertex.end - end, tangents_[begin]);
        if (!scene_.tangents.empty()) take_given(vertex);
        split(vertex);
    }

    /// The faces of one winding that hang together across the edges at the vertex.
    void find_groups(const VertexSlots& vertex) {
        groups_.clear();
        links_.link(vertex);
        for (std::uint32_t start = vertex.first; start < vertex.degenerate; ++start) {
            if (group_[start] != kNone || !spokes_.usable(start)) continue;
            const auto index = static_cast<std::uint32_t>(groups_.size());
            const bool preserving = spokes_.preserving(start);
            groups_.push_back({.first = start});
            group_[start] = index;
            links_.walk_around(start, [&](std::uint32_t slot) {
                if (group_[slot] != kNone || spokes_.preserving(slot) != preserving) return false;
                group_[slot] = index;
                return true;
            });
        }
    }

    void sum_groups(std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            if (!spokes_.usable(slot)) continue;
            Group& group = groups_[group_[slot]];
            group.wide |= slot != group.first && !(close(spokes_.s(group.first), spokes_.s(slot)) &&
                                                   close(spokes_.t(group.first), spokes_.t(slot)));
            group.sum += spokes_.weighted_s(slot);
        }
        for (Group& group : groups_) group.tangent = tangent(group.sum, group.first);
    }

    /// At MikkTSpace's threshold of 180 degrees a face leaves out of its own sum those faces of
    /// its group whose direction is, in float, exactly opposite.
    void exclude_opposites(std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t index = 0; index < groups_.size(); ++index) {
            if (!groups_[index].wide) continue;
            members_.clear();
            for (std::uint32_t slot = begin; slot < end; ++slot)
                if (group_[slot] == index && spokes_.usable(slot)) members_.push_back(slot);
            for (const std::uint32_t slot : members_) exclude_opposites_of(slot);
        }
    }

    void exclude_opposites_of(std::uint32_t slot) {
        const vec3 s = spokes_.s(slot);
        const vec3 t = spokes_.t(slot);
        bool whole = true;
        vec3 sum{0.0f};
        for (const std::uint32_t other : members_) {
            if (other == slot ||
                (glm::dot(s, spokes_.s(other)) > -1.0f && glm::dot(t, spokes_.t(other)) > -1.0f))
                sum += spokes_.weighted_s(other);
            else
                whole = false;
        }
        if (!whole) tangents_[slot] = tangent(sum, slot);
    }

    /// Where a sum has no direction MikkTSpace answers a zero vector or worse; here that of `slot`,
    /// one of those summed, stands in.
    vec4 tangent(const vec3& sum, std::uint32_t slot) const {
        vec3 unit = unit_or_zero(sum);
        if (!is_unit(unit)) unit = spokes_.s(slot);
        if (!is_unit(unit)) unit = vec3(kUnreached);
        return {unit, spokes_.preserving(slot) ? 1.0f : -1.0f};
    }

    void take_given(const VertexSlots& vertex) {
        for (std::uint32_t slot = vertex.first; slot < vertex.end; ++slot) {
            const vec4& given = scene_.tangents[slots_.slots[slot].corner];
            if (given.w != 0.0f) tangents_[slot] = given;
        }
    }

    /// One framed vertex for each tangent and colour.
    void split(const VertexSlots& vertex) {
        const std::size_t first = vertices_.size();
        const bool colored = !scene_.colors.empty();
        for (std::uint32_t slot = vertex.first; slot < vertex.end; ++slot) {
            const std::uint32_t color = colored ? scene_.colors[slots_.slots[slot].corner] : 0;
            std::size_t v = first;
            while (v < vertices_.size() &&
                   (vertices_[v].tangent != tangents_[slot] || (colored && colors_[v] != color)))
                ++v;
            if (v == vertices_.size()) {
                vertices_.push_back({slots_.slots[slot].own, tangents_[slot]});
                if (colored) colors_.push_back(color);
            }
            vertex_[slot] = static_cast<std::uint32_t>(v);
        }
    }

    const SourceScene& scene_;
    const CornerLists& lists_;
    const Windings& windings_;
    std::vector<std::uint32_t> positions_;
    CornerSlots slots_;
    SlotLinks links_;
    std::vector<FramedVertex> vertices_;
    std::vector<std::uint32_t> colors_;  // one a vertex; empty if the scene has none
    // Of each slot:
    Spokes spokes_;
    std::vector<std::uint32_t> group_;  // kNone if none reached it
    std::vector<vec4> tangents_;
    std::vector<std::uint32_t> vertex_;
    // Of one vertex:
    std::vector<Group> groups_;
    std::vector<std::uint32_t> members_;  // the slots of one group that have usable UVs
};

}  // namespace

/// Blocks of positions are made in parallel, numbered in their order, and stored in parallel.
FramedTriangles add_tangents(const SourceScene& scene) {
    const CornerLists lists = list_corners(scene);
    const Windings windings(scene, lists);
    FramedTriangles result;
    result.indices.resize(scene.corners.size());
    result.vertices.resize(scene.corners.size());  // at most; what is left over is never touched
    if (!scene.colors.empty()) result.colors.resize(scene.corners.size());

    struct Work {
        FramedBlock* block;
        std::uint32_t begin;  ///< the first position; then the number of the first vertex
    };
    const std::size_t at_once =
        2 * tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    std::deque<FramedBlock> blocks;
    tbb::concurrent_queue<FramedBlock*> idle;
    for (std::size_t i = 0; i < at_once; ++i)
        idle.push(&blocks.emplace_back(scene, lists, windings));
    const auto position_count = static_cast<std::uint32_t>(scene.positions.size());
    std::uint32_t next_position = 0;
    std::uint32_t next_vertex = 0;
    const auto take = [&](tbb::flow_control& flow) {
        Work work{nullptr, next_position};
        if (next_position == position_count)
            flow.stop();
        else
            idle.try_pop(work.block);
        next_position += std::min(kPositionsPerBlock, position_count - next_position);
        return work;
    };
    const auto make = [&](const Work& work) {
        work.block->make(work.begin,
                         work.begin + std::min(kPositionsPerBlock, position_count - work.begin));
        return work;
    };
    const auto number = [&](const Work& work) {
        const std::uint32_t first = next_vertex;
        next_vertex += static_cast<std::uint32_t>(work.block->vertex_count());
        return Work{work.block, first};
    };
    const auto store = [&](const Work& work) {
        work.block->store(work.begin, result);
        idle.push(work.block);
    };
    using tbb::filter_mode;
    tbb::parallel_pipeline(at_once,
                           tbb::make_filter<void, Work>(filter_mode::serial_in_order, take) &
                               tbb::make_filter<Work, Work>(filter_mode::parallel, make) &
                               tbb::make_filter<Work, Work>(filter_mode::serial_in_order, number) &
                               tbb::make_filter<Work, void>(filter_mode::parallel, store));
    result.vertices.resize(next_vertex);
    if (!scene.colors.empty()) result.colors.resize(next_vertex);
    return result;
}

}  // namespace bake
