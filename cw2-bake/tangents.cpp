#include "cw2-bake/tangents.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

// The arithmetic is float, and in MikkTSpace's order, on purpose: which faces count as opposite and
// what is left where directions cancel (the pole of a fan) hang on single roundings.

namespace bake {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;
constexpr vec4 kUnreached{1.0f, 0.0f, 0.0f, -1.0f};
constexpr std::uint32_t kFacesPerBlock = 4096;
constexpr std::uint32_t kVerticesPerBlock = 2048;

struct Mesh {
    std::span<const vec3> positions;
    std::span<const vec3> normals;
    std::span<const vec2> uvs;
    std::span<const std::uint32_t> indices;
};

struct Face {
    vec3 s;           ///< unit direction of growing u, zero if there is none
    vec3 t;           ///< unit direction of growing v, zero if there is none
    bool preserving;  ///< the UVs wind as the positions do
    bool usable;      ///< the UVs span an area: the face has directions and a winding of its own
    bool degenerate;  ///< two corners at one position
};

/// The corners of the faces that are not degenerate, by vertex, ascending within each: those of
/// vertex v are the slots first[v] .. first[v + 1].
struct Slots {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> corner;
    /// Across the edge that leaves (arrives at) the slot's corner: the slot, at the same vertex,
    /// of the face on the other side, or kNone.
    std::vector<std::uint32_t> across_leaving;
    std::vector<std::uint32_t> across_arriving;
};

std::uint32_t next_corner(std::uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

std::uint32_t previous_corner(std::uint32_t corner) {
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

bool not_zero(float x) {
    return std::abs(x) > FLT_MIN;
}

/// v in unit length, or v itself where it is too short to have a direction.
vec3 unit_or_zero(const vec3& v) {
    const float squared = glm::dot(v, v);
    return squared > 0.0f ? (1.0f / std::sqrt(squared)) * v : v;
}

/// (asin(sqrt(z)) / sqrt(z) - 1) / z for z in [0, 1/4], highest power first; Chebyshev fit, off by
/// less than 1e-12.
constexpr double kArcSine[] = {0.028346745231833329, 0.0010675063150363118, 0.01686409027396012,
                               0.016902683886393575, 0.022412417726695433,  0.030379945210024933,
                               0.044642906474584963, 0.074999999534297119,  0.16666666666738632};

/// acos of x in [-1, 1], rounded to float from an error below 1e-12. Inline, it takes a third of
/// the library's time.
float arc_cosine(float x) {
    constexpr double kPi = std::numbers::pi;
    const double size = std::abs(static_cast<double>(x));
    const bool outer = size > 0.5;  // acos(x) = 2 asin(sqrt((1 - x) / 2)), else pi/2 - asin(x)
    const double z = outer ? 0.5 - 0.5 * size : size * size;
    double series = kArcSine[0];
    for (std::size_t i = 1; i < std::size(kArcSine); ++i) series = series * z + kArcSine[i];
    const double root = outer ? std::sqrt(z) : size;
    const double arc = root + root * z * series;
    const double of_size = outer ? 2.0 * arc : kPi / 2 - arc;
    return static_cast<float>(x < 0.0f ? kPi - of_size : of_size);
}

bool is_unit(const vec3& v) {
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-3f;
}

vec3 flattened(const vec3& v, const vec3& normal) {
    return v - glm::dot(normal, v) * normal;
}

Face make_face(const Mesh& mesh, const std::uint32_t* corners) {
    const vec3& p0 = mesh.positions[corners[0]];
    const vec3& p1 = mesh.positions[corners[1]];
    const vec3& p2 = mesh.positions[corners[2]];
    const vec2 uv1 = mesh.uvs[corners[1]] - mesh.uvs[corners[0]];
    const vec2 uv2 = mesh.uvs[corners[2]] - mesh.uvs[corners[0]];
    const vec3 edge1 = p1 - p0;
    const vec3 edge2 = p2 - p0;
    const float area = uv1.x * uv2.y - uv1.y * uv2.x;

    Face face{};
    face.s = uv2.y * edge1 - uv1.y * edge2;
    face.t = -uv2.x * edge1 + uv1.x * edge2;
    face.preserving = area > 0.0f;
    face.degenerate = p0 == p1 || p0 == p2 || p1 == p2;
    if (not_zero(area)) {
        const float sign = face.preserving ? 1.0f : -1.0f;
        const float length_s = std::sqrt(glm::dot(face.s, face.s));
        const float length_t = std::sqrt(glm::dot(face.t, face.t));
        if (not_zero(length_s)) face.s = (sign / length_s) * face.s;
        if (not_zero(length_t)) face.t = (sign / length_t) * face.t;
        face.usable = not_zero(length_s / std::abs(area)) && not_zero(length_t / std::abs(area));
    }
    return face;
}

std::vector<Face> make_faces(const Mesh& mesh) {
    std::vector<Face> faces(mesh.indices.size() / 3);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), kFacesPerBlock),
                      [&](const auto& block) {
                          for (std::size_t f = block.begin(); f < block.end(); ++f)
                              faces[f] = make_face(mesh, &mesh.indices[3 * f]);
                      });
    return faces;
}

Slots make_slots(const Mesh& mesh, const std::vector<Face>& faces) {
    Slots slots;
    slots.first.assign(mesh.positions.size() + 2, 0);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (faces[f].degenerate) continue;
        for (std::size_t c = 3 * f; c < 3 * f + 3; ++c) ++slots.first[mesh.indices[c] + 2];
    }
    for (std::size_t v = 2; v < slots.first.size(); ++v) slots.first[v] += slots.first[v - 1];
    slots.corner.resize(slots.first.back());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (faces[f].degenerate) continue;
        // first[v + 1] is where v's next corner goes, and so ends up as where v + 1 begins.
        for (std::size_t c = 3 * f; c < 3 * f + 3; ++c)
            slots.corner[slots.first[mesh.indices[c] + 1]++] = static_cast<std::uint32_t>(c);
    }
    slots.first.pop_back();
    slots.across_leaving.assign(slots.corner.size(), kNone);
    slots.across_arriving.assign(slots.corner.size(), kNone);
    return slots;
}

/// Where more than two faces share an edge, the k-th that leaves along it (in face order) and the
/// k-th that arrives along it are neighbours.
class SlotLinker {
 public:
    SlotLinker(const Mesh& mesh, Slots& slots) : mesh_(mesh), slots_(slots) {}

    void link(std::uint32_t vertex) {
        const std::uint32_t begin = slots_.first[vertex];
        const std::uint32_t end = slots_.first[vertex + 1];
        leaving_.clear();
        arriving_.clear();
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            const std::uint32_t corner = slots_.corner[slot];
            leaving_.push_back({mesh_.indices[next_corner(corner)], slot});
            arriving_.push_back({mesh_.indices[previous_corner(corner)], slot});
        }
        if (end - begin <= kFew)
            link_by_search();
        else
            link_by_sorting();
    }

 private:
    static constexpr std::uint32_t kFew = 24;

    struct Spoke {
        std::uint32_t vertex;  ///< the edge's other end
        std::uint32_t slot;
        auto operator<=>(const Spoke&) const = default;
    };

    void join(const Spoke& leaving, const Spoke& arriving) {
        slots_.across_leaving[leaving.slot] = arriving.slot;
        slots_.across_arriving[arriving.slot] = leaving.slot;
    }

    void link_by_search() {
        for (const Spoke& leaving : leaving_) {
            for (const Spoke& arriving : arriving_) {
                if (arriving.vertex != leaving.vertex ||
                    slots_.across_arriving[arriving.slot] != kNone)
                    continue;
                join(leaving, arriving);
                break;
            }
        }
    }

    void link_by_sorting() {
        std::ranges::sort(leaving_);
        std::ranges::sort(arriving_);
        auto leaving = leaving_.begin();
        auto arriving = arriving_.begin();
        while (leaving != leaving_.end() && arriving != arriving_.end()) {
            if (leaving->vertex < arriving->vertex)
                ++leaving;
            else if (arriving->vertex < leaving->vertex)
                ++arriving;
            else
                join(*leaving++, *arriving++);
        }
    }

    const Mesh& mesh_;
    Slots& slots_;
    std::vector<Spoke> leaving_;
    std::vector<Spoke> arriving_;
};

/// Walks from `start` across the edges at its vertex, both ways round, and calls visit(slot) for
/// each slot; a false answer ends the way.
template <typename Visit>
void walk_around(const Slots& slots, std::uint32_t start, Visit&& visit) {
    for (std::uint32_t slot = slots.across_leaving[start]; slot != kNone && visit(slot);)
        slot = slots.across_leaving[slot];
    for (std::uint32_t slot = slots.across_arriving[start]; slot != kNone && visit(slot);)
        slot = slots.across_arriving[slot];
}

/// A face without usable UVs joins, with all its corners, the winding of the group that reaches it
/// first; groups grow one after the other, in the order of their first corner.
void settle_windings(const Mesh& mesh, const Slots& slots, std::vector<Face>& faces) {
    std::vector<std::uint32_t> slot_of_corner(mesh.indices.size(), kNone);
    for (std::size_t v = 0; v + 1 < slots.first.size(); ++v) {
        const auto begin = slots.corner.begin() + slots.first[v];
        const auto end = slots.corner.begin() + slots.first[v + 1];
        if (std::all_of(begin, end, [&](std::uint32_t corner) { return faces[corner / 3].usable; }))
            continue;
        for (std::uint32_t slot = slots.first[v]; slot < slots.first[v + 1]; ++slot)
            slot_of_corner[slots.corner[slot]] = slot;
    }

    std::vector<bool> grouped(slots.corner.size(), false);
    std::vector<bool> settled(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) settled[f] = faces[f].usable;
    for (std::size_t corner = 0; corner < slot_of_corner.size(); ++corner) {
        const std::uint32_t start = slot_of_corner[corner];
        if (start == kNone || grouped[start] || !faces[corner / 3].usable) continue;
        const bool preserving = faces[corner / 3].preserving;
        grouped[start] = true;
        walk_around(slots, start, [&](std::uint32_t slot) {
            const std::uint32_t f = slots.corner[slot] / 3;
            if (grouped[slot]) return false;
            if (!settled[f]) {
                settled[f] = true;
                faces[f].preserving = preserving;
            }
            const bool joins = faces[f].preserving == preserving;
            grouped[slot] = joins;
            return joins;
        });
    }
}

/// Makes the tangents of the corners at one vertex after the other.
class VertexTangents {
 public:
    VertexTangents(const Mesh& mesh, const std::vector<Face>& faces, const Slots& slots,
                   std::vector<vec4>& tangents)
        : mesh_(mesh), faces_(faces), slots_(slots), tangents_(tangents) {}

    void make(std::uint32_t vertex) {
        begin_ = slots_.first[vertex];
        end_ = slots_.first[vertex + 1];
        normal_ = mesh_.normals[vertex];
        find_groups();
        add_spokes();
        for (std::uint32_t slot = begin_; slot < end_; ++slot) {
            const std::uint32_t group = group_[slot - begin_];
            if (group != kNone)
                tangents_[slots_.corner[slot]] =
                    tangent(groups_[group].sum, groups_[group].first, groups_[group].preserving);
        }
        for (std::uint32_t group = 0; group < groups_.size(); ++group)
            if (groups_[group].wide) exclude_opposites(group);
    }

 private:
    /// What a face with usable UVs adds to its group: its directions, in the normal's plane.
    struct Spoke {
        vec3 s;
        vec3 t;
        float angle;
    };

    struct Group {
        bool preserving;
        bool wide = false;  ///< not shown that no two faces have opposite directions
        std::uint32_t first = kNone;
        vec3 sum{0.0f};
    };

    const Face& face(std::uint32_t slot) const { return faces_[slots_.corner[slot] / 3]; }

    /// The faces of one winding that hang together across the edges at the vertex.
    void find_groups() {
        groups_.clear();
        group_.assign(end_ - begin_, kNone);
        for (std::uint32_t start = begin_; start < end_; ++start) {
            if (group_[start - begin_] != kNone || !face(start).usable) continue;
            const auto group = static_cast<std::uint32_t>(groups_.size());
            const bool preserving = face(start).preserving;
            groups_.push_back({.preserving = preserving});
            group_[start - begin_] = group;
            walk_around(slots_, start, [&](std::uint32_t slot) {
                if (group_[slot - begin_] != kNone || face(slot).preserving != preserving)
                    return false;
                group_[slot - begin_] = group;
                return true;
            });
        }
    }

    void add_spokes() {
        spokes_.resize(end_ - begin_);
        for (std::uint32_t i = 0; i < spokes_.size(); ++i) {
            if (!face(begin_ + i).usable) continue;
            spokes_[i] = make_spoke(begin_ + i);
            Group& group = groups_[group_[i]];
            if (group.first == kNone)
                group.first = i;
            else if (!group.wide)
                group.wide = !close(spokes_[group.first].s, spokes_[i].s) ||
                             !close(spokes_[group.first].t, spokes_[i].t);
            group.sum += spokes_[i].angle * spokes_[i].s;
        }
    }

    Spoke make_spoke(std::uint32_t slot) const {
        const std::uint32_t corner = slots_.corner[slot];
        const vec3& here = mesh_.positions[mesh_.indices[corner]];
        const vec3& before = mesh_.positions[mesh_.indices[previous_corner(corner)]];
        const vec3& after = mesh_.positions[mesh_.indices[next_corner(corner)]];
        const vec3 to_before = unit_or_zero(flattened(before - here, normal_));
        const vec3 to_after = unit_or_zero(flattened(after - here, normal_));
        const float cosine = std::clamp(glm::dot(to_before, to_after), -1.0f, 1.0f);
        return {.s = unit_or_zero(flattened(face(slot).s, normal_)),
                .t = unit_or_zero(flattened(face(slot).t, normal_)),
                .angle = arc_cosine(cosine)};
    }

    /// Whether the angle is clearly below 90 degrees. Two directions that are both close to a
    /// third cannot be opposite.
    static bool close(const vec3& a, const vec3& b) { return glm::dot(a, b) > 0.01f; }

    /// At MikkTSpace's threshold of 180 degrees a face leaves out of its own sum those faces of
    /// its group whose direction is, in float, exactly opposite.
    void exclude_opposites(std::uint32_t group) {
        members_.clear();
        for (std::uint32_t i = 0; i < spokes_.size(); ++i)
            if (group_[i] == group && face(begin_ + i).usable) members_.push_back(i);
        for (const std::uint32_t i : members_) {
            bool whole = true;
            vec3 sum{0.0f};
            for (const std::uint32_t other : members_) {
                if (i == other || (glm::dot(spokes_[i].s, spokes_[other].s) > -1.0f &&
                                   glm::dot(spokes_[i].t, spokes_[other].t) > -1.0f))
                    sum += spokes_[other].angle * spokes_[other].s;
                else
                    whole = false;
            }
            if (!whole)
                tangents_[slots_.corner[begin_ + i]] = tangent(sum, i, groups_[group].preserving);
        }
    }

    /// Where a sum has no direction MikkTSpace answers a zero vector or worse; here `spoke`, one of
    /// those summed, stands in.
    vec4 tangent(const vec3& sum, std::uint32_t spoke, bool preserving) const {
        vec3 unit = unit_or_zero(sum);
        if (!is_unit(unit)) unit = spokes_[spoke].s;
        if (!is_unit(unit)) unit = vec3(kUnreached);
        return {unit, preserving ? 1.0f : -1.0f};
    }

    const Mesh& mesh_;
    const std::vector<Face>& faces_;
    const Slots& slots_;
    std::vector<vec4>& tangents_;

    std::uint32_t begin_ = 0;
    std::uint32_t end_ = 0;
    vec3 normal_{0.0f};
    std::vector<Group> groups_;
    std::vector<std::uint32_t>
        group_;  ///< of each slot at the vertex, kNone if no group reached it
    std::vector<Spoke> spokes_;
    std::vector<std::uint32_t> members_;
};

}  // namespace

std::vector<vec4> generate_tangents(std::span<const vec3> positions, std::span<const vec3> normals,
                                    std::span<const vec2> uvs,
                                    std::span<const std::uint32_t> indices) {
    assert(normals.size() == positions.size() && uvs.size() == positions.size());
    assert(indices.size() % 3 == 0);
    const Mesh mesh{positions, normals, uvs, indices};
    std::vector<Face> faces = make_faces(mesh);
    Slots slots = make_slots(mesh, faces);
    const tbb::blocked_range<std::uint32_t> vertices(
        0, static_cast<std::uint32_t>(positions.size()), kVerticesPerBlock);
    tbb::parallel_for(vertices, [&](const auto& block) {
        SlotLinker linker(mesh, slots);
        for (std::uint32_t v = block.begin(); v < block.end(); ++v) linker.link(v);
    });
    if (!std::ranges::all_of(faces, &Face::usable)) settle_windings(mesh, slots, faces);

    std::vector<vec4> tangents(indices.size(), kUnreached);
    tbb::parallel_for(vertices, [&](const auto& block) {
        VertexTangents maker(mesh, faces, slots, tangents);
        for (std::uint32_t v = block.begin(); v < block.end(); ++v) maker.make(v);
    });
    for (std::size_t corner = 0; corner < indices.size(); ++corner) {
        if (!faces[corner / 3].degenerate) continue;
        const std::uint32_t slot = slots.first[indices[corner]];
        if (slot < slots.first[indices[corner] + 1])
            tangents[corner] = tangents[slots.corner[slot]];
    }
    return tangents;
}

}  // namespace bake
