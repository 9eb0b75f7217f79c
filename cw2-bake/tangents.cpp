#include "cw2-bake/tangents.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>

#include "cw2-bake/tangent_directions.h"
#include "cw2-bake/tangent_topology.h"

namespace bake {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
constexpr vec4 kUnreached{1.0f, 0.0f, 0.0f, -1.0f};
constexpr std::uint32_t kVerticesPerBlock = 512;

bool is_unit(const vec3& v) {
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-3f;
}

/// Whether the angle is clearly below 90 degrees. Two directions that are both close to a third
/// cannot be opposite.
bool close(const vec3& a, const vec3& b) {
    return glm::dot(a, b) > 0.01f;
}

/// Makes the tangents of the corners at the vertices of one block.
class BlockTangents {
 public:
    BlockTangents(const CornerSlots& slots, std::vector<vec4>& tangents)
        : slots_(slots), tangents_(tangents) {}

    void make(const TangentInput& mesh, const std::vector<FaceDirections>& faces,
              std::uint32_t begin_vertex, std::uint32_t end_vertex) {
        block_ = slots_.first[begin_vertex];
        const std::uint32_t count = slots_.first[end_vertex] - block_;
        spokes_.resize(count);
        group_.assign(count, kNone);
        make_spokes(mesh, faces, std::span(slots_.corner).subspan(block_, count), spokes_.data());
        for (std::uint32_t v = begin_vertex; v < end_vertex; ++v)
            make_vertex(slots_.first[v], slots_.first[v + 1]);
    }

 private:
    struct Group {
        std::uint32_t first;  ///< the first slot with usable UVs
        bool wide = false;    ///< not shown that no two faces have opposite directions
        vec3 sum{0.0f};
        vec4 tangent{0.0f};
    };

    const Spoke& spoke(std::uint32_t slot) const { return spokes_[slot - block_]; }
    std::uint32_t& group(std::uint32_t slot) { return group_[slot - block_]; }

    void make_vertex(std::uint32_t begin, std::uint32_t end) {
        find_groups(begin, end);
        sum_groups(begin, end);
        for (std::uint32_t slot = begin; slot < end; ++slot)
            if (group(slot) != kNone) tangents_[slots_.corner[slot]] = groups_[group(slot)].tangent;
        exclude_opposites(begin, end);
    }

    /// The faces of one winding that hang together across the edges at the vertex.
    void find_groups(std::uint32_t begin, std::uint32_t end) {
        groups_.clear();
        for (std::uint32_t start = begin; start < end; ++start) {
            if (group(start) != kNone || !spoke(start).usable) continue;
            const auto index = static_cast<std::uint32_t>(groups_.size());
            const bool preserving = spoke(start).preserving;
            groups_.push_back({.first = start});
            group(start) = index;
            walk_around(slots_, start, [&](std::uint32_t slot) {
                if (group(slot) != kNone || spoke(slot).preserving != preserving) return false;
                group(slot) = index;
                return true;
            });
        }
    }

    void sum_groups(std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            if (!spoke(slot).usable) continue;
            Group& g = groups_[group(slot)];
            g.wide |= slot != g.first && !(close(spoke(g.first).s, spoke(slot).s) &&
                                           close(spoke(g.first).t, spoke(slot).t));
            g.sum += spoke(slot).angle * spoke(slot).s;
        }
        for (Group& g : groups_) g.tangent = tangent(g.sum, g.first);
    }

    /// At MikkTSpace's threshold of 180 degrees a face leaves out of its own sum those faces of
    /// its group whose direction is, in float, exactly opposite.
    void exclude_opposites(std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t index = 0; index < groups_.size(); ++index) {
            if (!groups_[index].wide) continue;
            members_.clear();
            for (std::uint32_t slot = begin; slot < end; ++slot)
                if (group(slot) == index && spoke(slot).usable) members_.push_back(slot);
            for (const std::uint32_t slot : members_) exclude_opposites_of(slot);
        }
    }

    void exclude_opposites_of(std::uint32_t slot) {
        const Spoke& own = spoke(slot);
        bool whole = true;
        vec3 sum{0.0f};
        for (const std::uint32_t other : members_) {
            const Spoke& its = spoke(other);
            if (other == slot || (glm::dot(own.s, its.s) > -1.0f && glm::dot(own.t, its.t) > -1.0f))
                sum += its.angle * its.s;
            else
                whole = false;
        }
        if (!whole) tangents_[slots_.corner[slot]] = tangent(sum, slot);
    }

    /// Where a sum has no direction MikkTSpace answers a zero vector or worse; here that of `slot`,
    /// one of those summed, stands in.
    vec4 tangent(const vec3& sum, std::uint32_t slot) const {
        vec3 unit = unit_or_zero(sum);
        if (!is_unit(unit)) unit = spoke(slot).s;
        if (!is_unit(unit)) unit = vec3(kUnreached);
        return {unit, spoke(slot).preserving ? 1.0f : -1.0f};
    }

    const CornerSlots& slots_;
    std::vector<vec4>& tangents_;

    std::uint32_t block_ = 0;             ///< the block's first slot
    std::vector<Spoke> spokes_;           ///< of each slot of the block
    std::vector<std::uint32_t> group_;    ///< of each slot of the block, kNone if none reached it
    std::vector<Group> groups_;           ///< of one vertex
    std::vector<std::uint32_t> members_;  ///< the slots of one group that have usable UVs
};

}  // namespace

std::vector<vec4> generate_tangents(std::span<const vec3> positions, std::span<const vec3> normals,
                                    std::span<const vec2> uvs,
                                    std::span<const std::uint32_t> indices) {
    assert(normals.size() == positions.size() && uvs.size() == positions.size());
    assert(indices.size() % 3 == 0);
    const TangentInput mesh{positions, normals, uvs, indices};
    std::vector<FaceDirections> faces = make_face_directions(mesh);
    const CornerSlots slots = make_slots(mesh, faces);
    if (!std::ranges::all_of(faces, &FaceDirections::usable)) settle_windings(mesh, slots, faces);

    std::vector<vec4> tangents(indices.size(), kUnreached);
    const auto vertices = static_cast<std::uint32_t>(positions.size());
    tbb::parallel_for(
        tbb::blocked_range<std::uint32_t>(0, vertices, kVerticesPerBlock),
        [&](const auto& block) {
            BlockTangents(slots, tangents).make(mesh, faces, block.begin(), block.end());
        },
        tbb::simple_partitioner());

    for (std::size_t corner = 0; corner < indices.size(); ++corner) {
        if (!faces[corner / 3].degenerate) continue;
        const std::uint32_t slot = slots.first[indices[corner]];
        if (slot < slots.first[indices[corner] + 1])
            tangents[corner] = tangents[slots.corner[slot]];
    }
    return tangents;
}

}  // namespace bake
