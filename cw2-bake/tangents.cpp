#include "cw2-bake/tangents.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "cw2-bake/tangent_directions.h"
#include "cw2-bake/tangent_topology.h"
#include "cw2-bake/windings.h"

namespace bake {
namespace {

using glm::vec3;
using glm::vec4;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
constexpr vec4 kUnreached{1.0f, 0.0f, 0.0f, -1.0f};
constexpr std::uint32_t kPositionsPerBlock = 1024;
constexpr std::uint32_t kPositionsAhead = 8;

bool is_unit(const vec3& v) {
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-3f;
}

/// Whether the angle is clearly below 90 degrees. Two directions that are both close to a third
/// cannot be opposite.
bool close(const vec3& a, const vec3& b) {
    return glm::dot(a, b) > 0.01f;
}

/// Makes the tangents of the corners at some vertices; reused from block to block by one thread.
class SlotTangents {
 public:
    SlotTangents(const SourceScene& scene, const Windings& windings)
        : scene_(scene), windings_(windings) {}

    /// The tangent of the corner of each slot; valid until the next call.
    std::span<const vec4> make(const CornerSlots& slots) {
        const std::size_t count = slots.corner.size();
        spokes_.resize(count);
        group_.assign(count, kNone);
        tangents_.assign(count, kUnreached);
        make_spokes(scene_, slots.corner, spokes_.data());
        windings_.settle(slots.corner, spokes_);
        for (const VertexSlots& vertex : slots.vertices) make_vertex(slots, vertex);
        if (!scene_.tangents.empty()) take_given(slots);
        return tangents_;
    }

 private:
    struct Group {
        std::uint32_t first;  ///< the first slot with usable UVs
        bool wide = false;    ///< not shown that no two faces have opposite directions
        vec3 sum{0.0f};
        vec4 tangent{0.0f};
    };

    void take_given(const CornerSlots& slots) {
        for (std::size_t slot = 0; slot < slots.corner.size(); ++slot) {
            const vec4& given = scene_.tangents[slots.corner[slot]];
            if (given.w != 0.0f) tangents_[slot] = given;
        }
    }

    void make_vertex(const CornerSlots& slots, const VertexSlots& vertex) {
        const std::uint32_t begin = vertex.first;
        const std::uint32_t end = vertex.degenerate;
        find_groups(slots, begin, end);
        sum_groups(begin, end);
        for (std::uint32_t slot = begin; slot < end; ++slot)
            if (group_[slot] != kNone) tangents_[slot] = groups_[group_[slot]].tangent;
        exclude_opposites(begin, end);
        // A degenerate face takes what the first other one at the vertex has.
        if (begin < end) std::fill_n(&tangents_[end], vertex.end - end, tangents_[begin]);
    }

    /// The faces of one winding that hang together across the edges at the vertex.
    void find_groups(const CornerSlots& slots, std::uint32_t begin, std::uint32_t end) {
        groups_.clear();
        for (std::uint32_t start = begin; start < end; ++start) {
            if (group_[start] != kNone || !spokes_[start].usable) continue;
            const auto index = static_cast<std::uint32_t>(groups_.size());
            const bool preserving = spokes_[start].preserving;
            groups_.push_back({.first = start});
            group_[start] = index;
            walk_around(slots, start, [&](std::uint32_t slot) {
                if (group_[slot] != kNone || spokes_[slot].preserving != preserving) return false;
                group_[slot] = index;
                return true;
            });
        }
    }

    void sum_groups(std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            const Spoke& spoke = spokes_[slot];
            if (!spoke.usable) continue;
            Group& group = groups_[group_[slot]];
            const Spoke& first = spokes_[group.first];
            group.wide |=
                slot != group.first && !(close(first.s, spoke.s) && close(first.t, spoke.t));
            group.sum += spoke.angle * spoke.s;
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
                if (group_[slot] == index && spokes_[slot].usable) members_.push_back(slot);
            for (const std::uint32_t slot : members_) exclude_opposites_of(slot);
        }
    }

    void exclude_opposites_of(std::uint32_t slot) {
        const Spoke& own = spokes_[slot];
        bool whole = true;
        vec3 sum{0.0f};
        for (const std::uint32_t other : members_) {
            const Spoke& its = spokes_[other];
            if (other == slot || (glm::dot(own.s, its.s) > -1.0f && glm::dot(own.t, its.t) > -1.0f))
                sum += its.angle * its.s;
            else
                whole = false;
        }
        if (!whole) tangents_[slot] = tangent(sum, slot);
    }

    /// Where a sum has no direction MikkTSpace answers a zero vector or worse; here that of `slot`,
    /// one of those summed, stands in.
    vec4 tangent(const vec3& sum, std::uint32_t slot) const {
        vec3 unit = unit_or_zero(sum);
        if (!is_unit(unit)) unit = spokes_[slot].s;
        if (!is_unit(unit)) unit = vec3(kUnreached);
        return {unit, spokes_[slot].preserving ? 1.0f : -1.0f};
    }

    const SourceScene& scene_;
    const Windings& windings_;
    // Of each slot:
    std::vector<Spoke> spokes_;
    std::vector<std::uint32_t> group_;  // kNone if none reached it
    std::vector<vec4> tangents_;
    // Of one vertex:
    std::vector<Group> groups_;
    std::vector<std::uint32_t> members_;  // the slots of one group that have usable UVs
};

/// Appends the framed vertices at the slots' vertices, and tells each corner its own's number.
void make_vertices(const SourceScene& scene, const CornerSlots& slots,
                   std::span<const vec4> tangents, std::vector<FramedVertex>& vertices,
                   std::span<std::uint32_t> indices) {
    vertices.reserve(slots.vertices.size() * 5 / 4);
    for (const VertexSlots& vertex : slots.vertices) {
        const std::size_t first = vertices.size();
        for (std::uint32_t slot = vertex.first; slot < vertex.end; ++slot) {
            const std::uint32_t corner = slots.corner[slot];
            std::size_t v = first;
            while (v < vertices.size() && vertices[v].tangent != tangents[slot]) ++v;
            if (v == vertices.size()) vertices.push_back({scene.corners[corner], tangents[slot]});
            indices[corner] = static_cast<std::uint32_t>(v);
        }
    }
}

/// One after the other in one array; frees each part once it is copied.
RawVector<FramedVertex> concatenate(std::vector<std::vector<FramedVertex>>& blocks,
                                    const std::vector<std::uint32_t>& first) {
    RawVector<FramedVertex> vertices(first.back());
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
        std::copy(blocks[i].begin(), blocks[i].end(), vertices.begin() + first[i]);
        std::vector<FramedVertex>().swap(blocks[i]);
    });
    return vertices;
}

/// Starts to fetch what is first asked of the corners' faces: they lie all over the memory.
void prefetch_faces(const SourceScene& scene, std::span<const std::uint32_t> corners) {
    for (const std::uint32_t corner : corners) __builtin_prefetch(&scene.corners[corner]);
}

}  // namespace

FramedTriangles add_tangents(const SourceScene& scene) {
    FramedTriangles result;
    const CornerLists lists = list_corners(scene);
    const Windings windings(scene, lists);

    struct Scratch {
        Scratch(const SourceScene& scene, const Windings& windings)
            : slot_maker(scene, slots), tangents(scene, windings) {}
        CornerSlots slots;
        SlotMaker slot_maker;
        SlotTangents tangents;
    };
    tbb::enumerable_thread_specific<Scratch> scratches(std::cref(scene), std::cref(windings));
    const auto position_count = static_cast<std::uint32_t>(scene.positions.size());
    std::vector<std::vector<FramedVertex>> blocks((position_count + kPositionsPerBlock - 1) /
                                                  kPositionsPerBlock);
    result.indices.resize(scene.corners.size());
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
        Scratch& scratch = scratches.local();
        scratch.slots.clear();
        const auto begin = static_cast<std::uint32_t>(block) * kPositionsPerBlock;
        const std::uint32_t end = std::min(begin + kPositionsPerBlock, position_count);
        for (std::uint32_t p = begin; p < end; ++p) {
            prefetch_faces(scene, lists.at(std::min(p + kPositionsAhead, position_count - 1)));
            scratch.slot_maker.add(lists.at(p));
        }
        make_vertices(scene, scratch.slots, scratch.tangents.make(scratch.slots), blocks[block],
                      result.indices);
    });

    std::vector<std::uint32_t> first{0};
    for (const auto& block : blocks)
        first.push_back(first.back() + static_cast<std::uint32_t>(block.size()));
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, scene.corners.size(), 1 << 14), [&](const auto& range) {
            for (std::size_t c = range.begin(); c < range.end(); ++c)
                result.indices[c] += first[scene.corners[c].position / kPositionsPerBlock];
        });
    result.vertices = concatenate(blocks, first);
    return result;
}

}  // namespace bake
