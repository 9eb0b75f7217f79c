#include "cw2-bake/geometry/normals.h"

#include <malloc.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "cw2-bake/base/raw_vector.h"

namespace bake {
namespace {

/// Triangles of one polygon follow each other, and their directions differ by rounding only: those
/// closer than this, in radians, are taken for one.
constexpr double kSameDirection = 1e-4;

/// Of length 1; zero for a zero vector.
glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : glm::dvec3{0.0};
}

glm::vec3 stored(const glm::dvec3& v) {
    return glm::vec3{v} + 0.0f;  // no -0
}

using Triangle = std::array<glm::dvec3, 3>;

Triangle triangle_of(const SourceScene& scene, std::size_t triangle) {
    Triangle result;
    for (std::size_t i = 0; i < 3; ++i) {
        result[i] = glm::dvec3{scene.positions[scene.corners[3 * triangle + i].position]};
    }
    return result;
}

/// Of length 1; zero if the triangle has no area.
glm::dvec3 normal_of(const Triangle& p) {
    return unit(glm::cross(p[1] - p[0], p[2] - p[0]));
}

/// The angle at a corner, in radians.
double angle_at(const Triangle& p, std::size_t corner) {
    const glm::dvec3 a = p[(corner + 1) % 3] - p[corner];
    const glm::dvec3 b = p[(corner + 2) % 3] - p[corner];
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

constexpr std::size_t kCornersPerBlock = 3 << 14;
constexpr std::size_t kCornersPerRound = 1 << 22;

/// The positions where some corner has no normal.
class Lacking {
 public:
    Lacking(const SourceScene& scene, const FirstEqual& positions)
        : is_lacking_(scene.positions.size()) {
        for (const TriangleRange& range : scene.without_normals) {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(3 * range.begin, 3 * range.end, kCornersPerBlock),
                [&](const auto& block) {
                    for (std::size_t i = block.begin(); i < block.end(); ++i) {
                        const Corner& corner = scene.corners[i];
                        if (corner.normal != kAbsent) continue;
                        std::atomic_ref(is_lacking_[positions[corner.position]])
                            .store(true, std::memory_order_relaxed);
                    }
                });
        }
        count_ = static_cast<std::size_t>(std::ranges::count(is_lacking_, true));
        // Of equal positions the first was marked.
        for (std::uint32_t p = 0; !positions.all_differ() && p < is_lacking_.size(); ++p)
            is_lacking_[p] = is_lacking_[positions[p]];
        const auto first = std::ranges::find(is_lacking_, true);
        const auto behind = std::find(is_lacking_.rbegin(), is_lacking_.rend(), true).base();
        if (first == is_lacking_.end()) return;
        first_ = static_cast<std::uint32_t>(first - is_lacking_.begin());
        span_ = static_cast<std::uint32_t>(behind - first);
    }

    /// Equal ones count once.
    std::size_t count() const { return count_; }

    /// Calls visit(i) for the corners i of begin .. end - 1, whole triangles, that lie there.
    template <typename Visit>
    void for_each_there(const std::vector<Corner>& corners, std::size_t begin, std::size_t end,
                        const Visit& visit) const {
        // Where they are few, one comparison tells of most corners.
        const auto may_be_there = [first = first_, span = span_](const Corner& corner) {
            return unsigned{corner.position - first < span};
        };
        for (; begin < end; begin += 3) {
            const Corner* const corner = &corners[begin];
            if ((may_be_there(corner[0]) | may_be_there(corner[1]) | may_be_there(corner[2])) == 0)
                continue;
            for (std::size_t k = 0; k < 3; ++k)
                if (is_lacking_[corner[k].position]) visit(begin + k);
        }
    }

 private:
    std::vector<char> is_lacking_;  // by position
    std::size_t count_ = 0;
    std::uint32_t first_ = 0, span_ = 0;  // all are among these
};

/// Some corners and the range of the positions where they lie.
struct PlacedCorners {
    std::vector<std::uint32_t> corners;  ///< ascending
    std::uint32_t first = ~std::uint32_t{0}, last = 0;

    void add(std::uint32_t corner, std::uint32_t position) {
        corners.push_back(corner);
        first = std::min(first, position);
        last = std::max(last, position);
    }
};

/// Makes the normals at some positions; one task's.
class SmoothNormals {
 public:
    SmoothNormals(SourceScene& scene, const FirstEqual& positions)
        : scene_(scene), positions_(positions) {}

    /// Those of positions begin .. end, with all the `corners` that lie there and at others,
    /// ascending.
    void make(std::uint32_t begin, std::uint32_t end, std::span<const PlacedCorners> corners) {
        list(begin, end, corners);
        made_.clear();
        last_.clear();
        settled_ = 0;
        std::uint32_t first = 0;
        for (std::uint32_t p = 0; p < end - begin; ++p) {
            const std::uint32_t last = next_[p];
            if (last != first) make_at(first, last);
            first = last;
        }
    }

    /// Puts the normals behind those of the scene, and tells the corners.
    void store() {
        const auto first = static_cast<std::uint32_t>(scene_.normals.size());
        scene_.normals.insert(scene_.normals.end(), made_.begin(), made_.end());
        std::size_t i = 0;
        for (std::uint32_t n = 0; n < made_.size(); ++n)
            for (; i < last_[n]; ++i) scene_.corners[corner_[i]].normal = first + n;
    }

 private:
    /// The corners of each position, one's behind the other's.
    void list(std::uint32_t begin, std::uint32_t end, std::span<const PlacedCorners> corners) {
        const std::uint32_t size = end - begin;
        const auto for_own_corners = [&](auto&& visit) {
            for (const PlacedCorners& part : corners) {
                if (part.last < begin || part.first >= end) continue;
                for (const std::uint32_t corner : part.corners) {
                    const std::uint32_t place = positions_[scene_.corners[corner].position] - begin;
                    if (place < size) visit(place, corner);
                }
            }
        };
        next_.assign(size + 1, 0);
        for_own_corners([&](std::uint32_t place, std::uint32_t) { ++next_[place]; });
        std::uint32_t start = 0;
        for (std::uint32_t& next : next_) start += std::exchange(next, start);
        corner_.resize(start);
        for_own_corners(
            [&](std::uint32_t place, std::uint32_t corner) { corner_[next_[place]++] = corner; });
    }

    /// Those of the corners listed from `begin` to `end`, which lie at one position: one normal for
    /// each smoothing group.
    void make_at(std::uint32_t begin, std::uint32_t end) {
        in_group_.clear();
        for (std::uint32_t i = begin; i < end; ++i) {
            const std::uint32_t group = scene_.smoothing_group[corner_[i] / 3];
            if (group != 0) in_group_.push_back({group, corner_[i]});
        }
        std::ranges::sort(in_group_);
        for (auto first = in_group_.begin(); first != in_group_.end();) {
            auto last = first;
            bool is_missing = false;
            for (; last != in_group_.end() && last->first == first->first; ++last)
                is_missing |= scene_.corners[last->second].normal == kAbsent;
            if (is_missing) make_of({first, last});
            first = last;
        }
    }

    void make_of(std::span<const std::pair<std::uint32_t, std::uint32_t>> in_group) {
        glm::dvec3 sum{0.0};
        for (const auto& [group, corner] : in_group) {
            const Triangle triangle = triangle_of(scene_, corner / 3);
            sum += normal_of(triangle) * angle_at(triangle, corner % 3);
        }
        // What is left of opposite normals is rounding.
        constexpr double kVanished = 1e-9;
        if (!(glm::length(sum) > kVanished)) return;
        made_.push_back(stored(unit(sum)));
        // In the place of corners that have been dealt with.
        for (const auto& [group, corner] : in_group)
            if (scene_.corners[corner].normal == kAbsent) corner_[settled_++] = corner;
        last_.push_back(settled_);
    }

    SourceScene& scene_;
    const FirstEqual& positions_;
    std::vector<std::uint32_t> next_;  // by position, where its list ends
    RawVector<std::uint32_t> corner_;  // the lists; then those that have got a normal
    std::uint32_t settled_ = 0;        // how many those are
    std::vector<glm::vec3> made_;
    std::vector<std::uint32_t> last_;  // of each normal, where its corners end
    std::vector<std::pair<std::uint32_t, std::uint32_t>> in_group_;  // smoothing group, corner
};

/// Positions are taken in a few rounds, so that no list of all corners is ever whole.
void make_smooth(const FirstEqual& positions, SourceScene& scene, const Advance& advance) {
    const Lacking lacking(scene, positions);
    constexpr std::size_t kMostRounds = 12;
    const std::size_t rounds = std::min(scene.corners.size() / kCornersPerRound + 1, kMostRounds);
    const std::size_t tasks =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const auto first_position = [&](std::size_t round, std::size_t task) {
        return static_cast<std::uint32_t>(std::uint64_t{scene.positions.size()} *
                                          (round * tasks + task) / (rounds * tasks));
    };
    // Exact where each position has one smoothing group.
    scene.normals.reserve(scene.normals.size() + lacking.count());
    std::vector<SmoothNormals> makers(tasks, SmoothNormals(scene, positions));
    for (std::size_t round = 0; round < rounds; ++round) {
        const std::uint32_t begin = first_position(round, 0);
        const std::uint32_t size = first_position(round + 1, 0) - begin;
        std::vector<PlacedCorners> corners(scene.corners.size() / kCornersPerBlock + 1);
        tbb::parallel_for(std::size_t{0}, corners.size(), [&](std::size_t block) {
            const std::size_t first = block * kCornersPerBlock;
            const std::size_t end = std::min(first + kCornersPerBlock, scene.corners.size());
            lacking.for_each_there(scene.corners, first, end, [&](std::size_t i) {
                const std::uint32_t position = positions[scene.corners[i].position];
                if (position - begin < size)
                    corners[block].add(static_cast<std::uint32_t>(i), position);
            });
        });
        tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
            makers[task].make(first_position(round, task), first_position(round, task + 1),
                              corners);
        });
        for (SmoothNormals& maker : makers) maker.store();
        advance(1.0 / static_cast<double>(rounds));
    }
}

/// Hands out the triangles' own normals.
class FlatNormals {
 public:
    explicit FlatNormals(SourceScene& scene) : scene_(scene) {}

    std::uint32_t index(std::size_t triangle) {
        if (triangle == triangle_) return index_;
        glm::dvec3 normal = normal_of(triangle_of(scene_, triangle));
        if (normal == glm::dvec3{0.0}) normal = {0, 1, 0};
        if (glm::length(normal - normal_) > kSameDirection) {
            normal_ = normal;
            index_ = static_cast<std::uint32_t>(scene_.normals.size());
            scene_.normals.push_back(stored(normal));
        }
        triangle_ = triangle;
        return index_;
    }

 private:
    SourceScene& scene_;
    std::size_t triangle_ = ~std::size_t{0};  // the last one asked for, and its normal
    std::uint32_t index_ = 0;
    glm::dvec3 normal_{0.0};
};

void make_flat(SourceScene& scene) {
    FlatNormals flat(scene);
    for (const TriangleRange& range : scene.without_normals) {
        for (std::size_t i = 3 * range.begin; i < 3 * range.end; ++i)
            if (scene.corners[i].normal == kAbsent) scene.corners[i].normal = flat.index(i / 3);
    }
}

}  // namespace

void generate_normals(SourceScene& scene, const FirstEqual& positions, const Advance& advance) {
    if (scene.smoothing_group.empty()) return;  // every corner has one
    const auto is_smooth = [](const RunVector::Run& run) { return run.number != 0; };
    if (std::ranges::any_of(scene.smoothing_group.runs(), is_smooth))
        make_smooth(positions, scene, advance);
    // The lists were many and of all sizes.
    if (scene.corners.size() > kCornersPerRound) malloc_trim(0);
    make_flat(scene);
}

}  // namespace bake
