#include "cw2-bake/geometry/tangents.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "cw2-bake/geometry/fan.h"
#include "cw2-bake/geometry/plain_tangents.h"
#include "cw2-bake/geometry/tangent_directions.h"
#include "cw2-bake/geometry/tangent_topology.h"
#include "cw2-bake/geometry/windings.h"

namespace bake {
namespace {

using glm::vec3;
using glm::vec4;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
constexpr vec4 kUnreached{1.0f, 0.0f, 0.0f, -1.0f};
constexpr std::size_t kVerticesPerBlock = 256;

std::size_t block_count(std::size_t vertices) {
    return (vertices + kVerticesPerBlock - 1) / kVerticesPerBlock;
}

/// Whether the angle is clearly below 90 degrees. Two directions that are both close to a third
/// cannot be opposite.
bool close(const vec3& a, const vec3& b) {
    return glm::dot(a, b) > 0.01f;
}

/// Vertices that some corners have instead of those they shared with others.
struct Splits {
    std::vector<FramedVertex> vertices;
    std::vector<std::uint32_t> colors;  ///< one a vertex; empty if the scene has none
    struct Moved {
        std::uint32_t corner, vertex;  ///< the latter in `vertices`
    };
    std::vector<Moved> moved;
};

/// What a block of vertices leaves to be done.
struct Rest {
    Splits splits;
    /// Vertices that got no tangent yet: faces with usable UVs meet faces without there.
    std::vector<std::uint32_t> mixed;
};

/// Gives some vertices their tangents; reused for one block of vertices after another.
class TangentBlock {
 public:
    TangentBlock(const SourceScene& scene, const CornerLists& lists, FramedTriangles& triangles)
        : scene_(scene), lists_(lists), triangles_(triangles) {}

    /// Without `windings` the mixed vertices are left out.
    Rest make(std::span<const std::uint32_t> vertices, const Windings* windings = nullptr) {
        slots_.assign(triangles_, lists_, vertices);
        const std::size_t count = slots_.slots.size();
        spokes_.make(scene_, triangles_, slots_.slots);
        group_.resize(count);
        tangents_.resize(count);
        for (const VertexSlots& vertex : slots_.vertices) {
            if (make_plain_vertex(vertex)) continue;
            if (is_mixed(vertex)) {
                if (!windings) {
                    rest_.mixed.push_back(slots_.slots[vertex.first].own);
                    continue;
                }
                settle_windings(vertex, *windings);
            }
            make_vertex(vertex);
        }
        return std::exchange(rest_, {});
    }

 private:
    struct Group {
        std::uint32_t first;  ///< the first slot with usable UVs
        bool wide = false;    ///< not shown that no two faces have opposite directions
        vec3 sum{0.0f};
        vec4 tangent{0.0f};
    };

    /// Sets the tangent, if all faces are one group. Else answers false.
    bool make_plain_vertex(const VertexSlots& vertex) {
        if (!may_be_plain(scene_)) return false;
        fan_.clear();
        for (std::uint32_t i = vertex.first; i < vertex.degenerate; ++i)
            fan_.add(spokes_.lanes(i), i % kLanes, slots_.slots[i].next, slots_.slots[i].previous,
                     0);
        const auto tangent = fan_.tangent();
        if (tangent) triangles_.vertices[slots_.slots[vertex.first].own].tangent = *tangent;
        return tangent.has_value();
    }

    bool is_mixed(const VertexSlots& vertex) const {
        std::uint32_t usable = 0;
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot)
            usable += spokes_.usable(slot);
        return usable != 0 && usable != vertex.degenerate - vertex.first;
    }

    void settle_windings(const VertexSlots& vertex, const Windings& windings) {
        for (std::uint32_t slot = vertex.first; slot < vertex.degenerate; ++slot) {
            if (!spokes_.usable(slot))
                spokes_.set_preserving(
                    slot, windings.preserving(slots_.slots[slot].face, spokes_.preserving(slot)));
        }
    }

    void make_vertex(const VertexSlots& vertex) {
        const std::uint32_t begin = vertex.first;
        const std::uint32_t end = vertex.degenerate;
        std::fill(tangents_.begin() + begin, tangents_.begin() + vertex.end, kUnreached);
        std::fill(group_.begin() + begin, group_.begin() + vertex.end, kNone);
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
        links_.link(slots_, vertex);
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
            const vec4& given = scene_.tangents[triangles_.source_of(slots_.slots[slot].corner)];
            if (given.w != 0.0f) tangents_[slot] = given;
        }
    }

    /// One vertex for each tangent and colour.
    void split(const VertexSlots& vertex) {
        const std::uint32_t own = slots_.slots[vertex.first].own;
        const bool colored = !scene_.colors.empty();
        const auto color_of = [&](std::uint32_t slot) {
            return scene_.colors[triangles_.source_of(slots_.slots[slot].corner)];
        };
        FramedVertex& kept = triangles_.vertices[own];
        kept.tangent = tangents_[vertex.first];
        if (colored) triangles_.colors[own] = color_of(vertex.first);
        Splits& splits = rest_.splits;
        const std::size_t first = splits.vertices.size();
        for (std::uint32_t slot = vertex.first + 1; slot < vertex.end; ++slot) {
            const std::uint32_t color = colored ? color_of(slot) : 0;
            if (kept.tangent == tangents_[slot] && (!colored || triangles_.colors[own] == color))
                continue;
            std::size_t v = first;
            while (v < splits.vertices.size() && (splits.vertices[v].tangent != tangents_[slot] ||
                                                  (colored && splits.colors[v] != color)))
                ++v;
            if (v == splits.vertices.size()) {
                splits.vertices.push_back({kept.corner, tangents_[slot]});
                if (colored) splits.colors.push_back(color);
            }
            splits.moved.push_back({slots_.slots[slot].corner, static_cast<std::uint32_t>(v)});
        }
    }

    const SourceScene& scene_;
    const CornerLists& lists_;
    FramedTriangles& triangles_;
    CornerSlots slots_;
    SlotLinks links_;
    Rest rest_;
    // Of each slot:
    Spokes spokes_;
    std::vector<std::uint32_t> group_;  // kNone if none reached it
    std::vector<vec4> tangents_;
    // Of one vertex:
    Fan fan_;
    std::vector<Group> groups_;
    std::vector<std::uint32_t> members_;  // the slots of one group that have usable UVs
};

/// The new vertices come in the order of the blocks.
void add_splits(std::vector<Rest>& rests, FramedTriangles& triangles) {
    for (Rest& rest : rests) {
        Splits& splits = rest.splits;
        const auto first = static_cast<std::uint32_t>(triangles.vertices.size());
        triangles.vertices.insert(triangles.vertices.end(), splits.vertices.begin(),
                                  splits.vertices.end());
        triangles.colors.insert(triangles.colors.end(), splits.colors.begin(), splits.colors.end());
        for (const Splits::Moved& moved : splits.moved)
            triangles.indices[moved.corner] = first + moved.vertex;
        splits = {};
    }
}

}  // namespace

void add_tangents(const SourceScene& scene, FramedTriangles& triangles, const Advance& advance) {
    if (!scene.colors.empty()) triangles.colors.resize(triangles.vertices.size());
    std::vector<Rest> rests;
    std::vector<Rest> rests_of_mixed;
    {
        constexpr double kPlainShare = 0.7;  // of the time
        const RawVector<std::uint8_t> is_left =
            add_plain_tangents(scene, triangles, [&](double part) { advance(kPlainShare * part); });
        std::vector<std::uint32_t> left;
        for (std::uint32_t v = 0; v < is_left.size(); ++v)
            if (is_left[v]) left.push_back(v);
        const CornerLists lists = list_corners(triangles, is_left);
        tbb::enumerable_thread_specific<TangentBlock> blocks(
            [&] { return TangentBlock(scene, lists, triangles); });
        const auto block_of = [](std::span<const std::uint32_t> vertices, std::size_t i) {
            const std::size_t begin = i * kVerticesPerBlock;
            return vertices.subspan(begin, std::min(kVerticesPerBlock, vertices.size() - begin));
        };
        rests.resize(block_count(left.size()));
        tbb::parallel_for(std::size_t{0}, rests.size(), [&](std::size_t i) {
            rests[i] = blocks.local().make(block_of(left, i));
            advance((1.0 - kPlainShare) / static_cast<double>(rests.size()));
        });
        std::vector<std::uint32_t> mixed;
        for (const Rest& rest : rests)
            mixed.insert(mixed.end(), rest.mixed.begin(), rest.mixed.end());
        const Windings windings(scene, triangles, lists, mixed);
        rests_of_mixed.resize(block_count(mixed.size()));
        tbb::parallel_for(std::size_t{0}, rests_of_mixed.size(), [&](std::size_t i) {
            rests_of_mixed[i] = blocks.local().make(block_of(mixed, i), &windings);
        });
    }
    add_splits(rests, triangles);
    add_splits(rests_of_mixed, triangles);
}

}  // namespace bake
