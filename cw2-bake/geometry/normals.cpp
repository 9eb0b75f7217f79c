#include "cw2-bake/geometry/normals.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "cw2-bake/geometry/index_set.h"

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

/// The sums of weighted normals, by position and smoothing group.
class SmoothNormals {
 public:
    explicit SmoothNormals(const SourceScene& scene)
        : position_(first_equal(std::span<const glm::vec3>(scene.positions))),
          set_(scene.positions.size()) {}

    struct Sum {
        glm::dvec3 normal{0.0};
        std::uint32_t position;
        std::uint32_t group;
        std::uint32_t index = kAbsent;  ///< into the scene's normals, once stored
    };

    /// Valid until the next call.
    Sum& at(std::uint32_t any_position, std::uint32_t group) {
        const std::uint32_t position = position_[any_position];
        const std::uint32_t found =
            set_.find_or_insert(position, hash_of(position, group), [&](std::uint32_t i) {
                return sums_[i].position == position && sums_[i].group == group;
            });
        if (found == sums_.size()) sums_.push_back({.position = position, .group = group});
        return sums_[found];
    }

 private:
    std::vector<std::uint32_t> position_;
    PlacedIndexSet set_;
    std::vector<Sum> sums_;
};

SmoothNormals sum_normals(const SourceScene& scene) {
    SmoothNormals sums(scene);
    for (std::size_t t = 0; t < scene.smoothing_group.size(); ++t) {
        if (scene.smoothing_group[t] == 0) continue;
        const Triangle triangle = triangle_of(scene, t);
        const glm::dvec3 normal = normal_of(triangle);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t position = scene.corners[3 * t + i].position;
            sums.at(position, scene.smoothing_group[t]).normal += normal * angle_at(triangle, i);
        }
    }
    return sums;
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

}  // namespace

void generate_normals(SourceScene& scene) {
    if (scene.smoothing_group.empty()) return;  // every corner has one

    SmoothNormals smooth = sum_normals(scene);
    FlatNormals flat(scene);
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        Corner& corner = scene.corners[i];
        if (corner.normal != kAbsent) continue;
        const std::size_t triangle = i / 3;
        const std::uint32_t group = scene.smoothing_group[triangle];
        if (group != 0) {
            SmoothNormals::Sum& sum = smooth.at(corner.position, group);
            // What is left of opposite normals is rounding.
            constexpr double kVanished = 1e-9;
            if (sum.index == kAbsent && glm::length(sum.normal) > kVanished) {
                sum.index = static_cast<std::uint32_t>(scene.normals.size());
                scene.normals.push_back(stored(unit(sum.normal)));
            }
            corner.normal = sum.index;
        }
        if (corner.normal == kAbsent) corner.normal = flat.index(triangle);
    }
}

}  // namespace bake
