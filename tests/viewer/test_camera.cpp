// The camera that nobody chose, of scenes of every size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "cw2/render/camera.h"

namespace {

using namespace cw2;

constexpr float kDegree = 3.14159265f / 180.0f;

/// Points in a box of these sides.
std::vector<glm::vec3> points_in(const glm::vec3& sides) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> number(-0.5f, 0.5f);
    std::vector<glm::vec3> points(40'000);
    for (glm::vec3& point : points) {
        point = sides * glm::vec3(number(random), number(random), number(random));
    }
    return points;
}

Bounds bounds_of_points(const std::vector<glm::vec3>& points) {
    mesh_format::SceneRecord scene{};
    glm::vec3 low = points.front(), high = points.front();
    for (const glm::vec3& point : points) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    const glm::dvec3 center = 0.5 * (glm::dvec3(low) + glm::dvec3(high));
    for (const glm::vec3& point : points) {
        scene.radius =
            std::max(scene.radius, static_cast<float>(glm::distance(glm::dvec3(point), center)));
    }
    for (int i = 0; i < 3; ++i) {
        scene.bounds_min[i] = low[i];
        scene.bounds_max[i] = high[i];
    }
    return bounds_of(scene, points);
}

TEST(Camera, TheDefaultOneLeavesEveryVertexInViewAndNoMoreThanTheMargin) {
    for (const float size : {1e-12f, 1e-7f, 1.0f, 3.9e7f, 1e12f}) {
        for (const glm::vec3 sides : {glm::vec3(1.0f), glm::vec3(5.0f, 0.1f, 0.2f),
                                      glm::vec3(0.01f, 3.0f, 0.01f), glm::vec3(1.0f, 0.0f, 1.0f)}) {
            const std::vector<glm::vec3> points = points_in(size * sides);
            const Bounds bounds = bounds_of_points(points);
            for (const float aspect : {0.3f, 1.0f, 16.0f / 9.0f, 5.0f}) {
                for (const float fov : {5.0f, 60.0f, 150.0f}) {
                    const Camera camera = default_camera(bounds, fov * kDegree, aspect);
                    const glm::mat4 clip_from_world =
                        clip_from_view(camera.vertical_fov, aspect, near_distance(bounds)) *
                        view_from_world(camera);
                    float farthest = 0.0f;
                    for (const glm::vec3& point : points) {
                        const glm::vec4 clip = clip_from_world * glm::vec4(point, 1.0f);
                        ASSERT_GT(clip.w, 0.0f);
                        ASSERT_LT(clip.z, clip.w) << "before the near plane";
                        farthest = std::max(
                            {farthest, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
                    }
                    EXPECT_NEAR(farthest, 0.95f, 1e-3f)
                        << size << ' ' << sides.x << ' ' << aspect << ' ' << fov;
                    const glm::dvec3 sight =
                        glm::normalize(glm::dvec3(camera.position) - glm::dvec3(camera.target));
                    EXPECT_LT(glm::distance(sight, glm::normalize(glm::dvec3(1.0, 0.5, 1.0))),
                              1e-5);
                }
            }
        }
    }
}

TEST(Camera, ASceneOfOnePointIsSeen) {
    for (const glm::vec3 point : {glm::vec3(0.0f), glm::vec3(1e9f, 3.0f, -2e9f)}) {
        const std::vector<glm::vec3> points{point};
        const Bounds bounds = bounds_of_points(points);
        const Camera camera = default_camera(bounds, 60.0f * kDegree, 1.5f);
        EXPECT_NE(camera.position, camera.target);
        const glm::vec3 seen(view_from_world(camera) * glm::vec4(point, 1.0f));
        EXPECT_LT(seen.z, -near_distance(bounds));
    }
}

TEST(Camera, TheViewKeepsDistancesAndLooksAlongMinusZ) {
    for (const float size : {1e-12f, 1.0f, 1e12f}) {
        for (const glm::vec3 sight : {glm::vec3(1.0f, 2.0f, -3.0f), glm::vec3(0.0f, 1.0f, 0.0f),
                                      glm::vec3(0.0f, -1.0f, 0.0f)}) {
            const Camera camera{size * glm::vec3(3.0f, -1.0f, 2.0f),
                                size * (glm::vec3(3.0f, -1.0f, 2.0f) + sight), 1.0f};
            const glm::vec3 seen(view_from_world(camera) * glm::vec4(camera.target, 1.0f));
            EXPECT_NEAR(seen.x / size, 0.0f, 1e-5f);
            EXPECT_NEAR(seen.y / size, 0.0f, 1e-5f);
            EXPECT_NEAR(seen.z / size, -glm::length(sight), 1e-5f);
        }
    }
}

}  // namespace
