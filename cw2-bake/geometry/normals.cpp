#include "cw2-bake/geometry/normals.h"

#include <malloc.h>
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

/// Corners without a normal, told in blocks of corners.
struct Missing {
    std::vector<char> in_block;     ///< whether some corner of the block has none
    std::vector<char> at_position;  ///< whether some corner there has none; by the first position
};

template <typename Visit>
void for_each_block(const SourceScene& scene, const Visit& visit) {
    const std::size_t count = scene.corners.size();
    tbb::parallel_for(std::size_t{0}, (count + kCornersPerBlock - 1) / kCornersPerBlock,
                      [&](std::size_t block) {
                          const std::size_t begin = block * kCornersPerBlock;
                          visit(block, begin, std::min(begin + kCornersPerBlock, count));
                      });
}

Missing find_missing(const SourceScene& scene, const FirstEqual& positions) {
    Missing missing;
    missing.in_block.resize(scene.corners.size() / kCornersPerBlock + 1);
    missing.at_position.resize(scene.positions.size());
    for_each_block(scene, [&](std::size_t block, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Corner& corner = scene.corners[i];
            if (corner.normal != kAbsent) continue;
            missing.in_block[block] = true;
            std::atomic_ref(missing.at_position[positions[corner.position]])
                .store(true, std::memory_order_relaxed);
        }
    });
    return missing;
}

/// Makes the normals at some positions; one task's.
class SmoothNormals {
 public:
    SmoothNormals(SourceScene& scene, const FirstEqual& positions)
        : scene_(scene), positions_(positions) {}

    /// Those of positions begin .. end, with all the `corners` that lie there and at others,
    /// ascending.
    void make(std::uint32_t begin, std::uint32_t end,
              std::span<const std::vector<std::uint32_t>> corners) {
        list(begin, end, corners);
        made_.clear();
        last_.clear();
        settled_ = 0;
        for (std::uint32_t p = 0; p < end - begin; ++p)
            make_at(p == 0 ? 0 : next_[p - 1], next_[p]);
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
    void list(std::uint32_t begin, std::uint32_t end,
              std::span<const std::vector<std::uint32_t>> corners) {
        const std::uint32_t size = end - begin;
        const auto for_own_corners = [&](auto&& visit) {
            for (const auto& part : corners) {
                for (const std::uint32_t corner : part) {
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
void make_smooth(const Missing& missing, const FirstEqual& positions, SourceScene& scene,
                 const Advance& advance) {
    constexpr std::size_t kMostRounds = 12;
    const std::size_t rounds = std::min(scene.corners.size() / kCornersPerRound + 1, kMostRounds);
    const std::size_t tasks =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const auto first_position = [&](std::size_t round, std::size_t task) {
        return static_cast<std::uint32_t>(std::uint64_t{scene.positions.size()} *
                                          (round * tasks + task) / (rounds * tasks));
    };
    // Exact where each position has one smoothing group.
    scene.normals.reserve(scene.normals.size() +
                          static_cast<std::size_t>(std::ranges::count(missing.at_position, true)));
    std::vector<SmoothNormals> makers(tasks, SmoothNormals(scene, positions));
    for (std::size_t round = 0; round < rounds; ++round) {
        const std::uint32_t begin = first_position(round, 0);
        const std::uint32_t size = first_position(round + 1, 0) - begin;
        std::vector<std::vector<std::uint32_t>> corners(missing.in_block.size());
        for_each_block(scene, [&](std::size_t block, std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) {
                const std::uint32_t position = positions[scene.corners[i].position];
                if (position - begin < size && missing.at_position[position])
                    corners[block].push_back(static_cast<std::uint32_t>(i));
            }
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

void make_flat(const Missing& missing, SourceScene& scene) {
    FlatNormals flat(scene);
    for (std::size_t block = 0; block < missing.in_block.size(); ++block) {
        if (!missing.in_block[block]) continue;
        const std::size_t begin = block * kCornersPerBlock;
        const std::size_t end = std::min(begin + kCornersPerBlock, scene.corners.size());
        for (std::size_t i = begin; i < end; ++i)
            if (scene.corners[i].normal == kAbsent) scene.corners[i].normal = flat.index(i / 3);
    }
}

}  // namespace

void generate_normals(SourceScene& scene, const FirstEqual& positions, const Advance& advance) {
    if (scene.smoothing_group.empty()) return;  // every corner has one
    const Missing missing = find_missing(scene, positions);
    const auto is_smooth = [](const RunVector::Run& run) { return run.number != 0; };
    if (std::ranges::any_of(scene.smoothing_group.runs(), is_smooth))
        make_smooth(missing, positions, scene, advance);
    // The lists were many and of all sizes.
    if (scene.corners.size() > kCornersPerRound) malloc_trim(0);
    make_flat(missing, scene);
}

}  // namespace bake
