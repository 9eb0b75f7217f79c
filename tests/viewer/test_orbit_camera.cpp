// Orbiting, panning and going towards a point, against what the picture then shows where.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "cw2/window/orbit_camera.h"

namespace {

using cw2::Camera;
using glm::vec2;
using glm::vec3;

constexpr Camera kCamera{{1.0f, 2.0f, 3.0f}, {4.0f, 1.0f, -2.0f}, 1.0f};

/// Where a point is seen, in heights of the picture from its centre to the right and down.
vec2 place_of(const Camera& camera, const vec3& point) {
    const vec3 seen(cw2::view_from_world(camera) * glm::vec4(point, 1.0f));
    return vec2(seen.x, -seen.y) / (-seen.z * 2.0f * std::tan(0.5f * camera.vertical_fov));
}

TEST(OrbitCamera, OrbitKeepsTargetDistanceAndUp) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> angle(-3.0f, 3.0f);
    Camera camera = kCamera;
    for (int i = 0; i < 1000; ++i) {
        camera = cw2::orbited(camera, {angle(random), angle(random)});
        EXPECT_EQ(camera.target, kCamera.target);
        EXPECT_NEAR(glm::distance(camera.position, camera.target),
                    glm::distance(kCamera.position, kCamera.target), 1e-3f);
        EXPECT_GT(cw2::axes_of(camera).up.y, 0.0) << "it has gone over the pole";
        EXPECT_NEAR(cw2::axes_of(camera).right.y, 0.0, 1e-6);
    }
}

TEST(OrbitCamera, WhatIsInFrontOfTheTargetFollowsADragInBothDirections) {
    const vec3 near = glm::mix(kCamera.target, kCamera.position, 0.3f);
    EXPECT_GT(place_of(cw2::orbited(kCamera, {0.1f, 0.0f}), near).x, 0.01f);
    EXPECT_GT(place_of(cw2::orbited(kCamera, {0.0f, 0.1f}), near).y, 0.01f);
}

TEST(OrbitCamera, ADragAcrossThePoleStopsThereAndBackComesBackFromTheSameSide) {
    const Camera top = cw2::orbited(kCamera, {0.0f, 10.0f});
    EXPECT_GT(cw2::axes_of(top).back.y, 0.999);
    const Camera back = cw2::orbited(top, {0.0f, -0.5f});
    const glm::dvec3 before = cw2::axes_of(kCamera).right, after = cw2::axes_of(back).right;
    EXPECT_NEAR(glm::dot(before, after), 1.0, 1e-4);
}

TEST(OrbitCamera, PanningMovesWhatIsAtTheTargetsDepthWithTheCursor) {
    const vec2 from(0.2f, -0.1f), to(-0.35f, 0.25f);
    const vec3 point = cw2::point_at(kCamera, from);
    EXPECT_NEAR(glm::distance(place_of(kCamera, point), from), 0.0f, 1e-5f);
    const Camera panned = cw2::panned(kCamera, to - from);
    EXPECT_NEAR(glm::distance(place_of(panned, point), to), 0.0f, 1e-5f);
    const glm::dvec3 turn = cw2::axes_of(panned).back - cw2::axes_of(kCamera).back;
    EXPECT_NEAR(glm::length(turn), 0.0, 1e-6);
}

TEST(OrbitCamera, APointThatIsGoneTowardsStaysWhereItIsSeen) {
    const vec3 point(3.0f, 2.5f, -1.0f);
    const vec2 place = place_of(kCamera, point);
    for (const float factor : {0.85f, 0.3f, 1.2f, 7.0f}) {
        const Camera camera = cw2::dollied(kCamera, point, factor, 1e-3f, 1e3f);
        EXPECT_NEAR(glm::distance(place_of(camera, point), place), 0.0f, 1e-4f);
        EXPECT_NEAR(glm::distance(camera.position, point) /
                        (factor * glm::distance(kCamera.position, point)),
                    1.0f, 1e-5f);
    }
}

TEST(OrbitCamera, NoNumberOfStepsGoesThroughThePointOrOutOfReach) {
    const vec3 point(3.0f, 2.5f, -1.0f);
    Camera camera = kCamera;
    for (int i = 0; i < 300; ++i) camera = cw2::dollied(camera, point, 0.85f, 0.01f, 100.0f);
    EXPECT_GT(glm::distance(camera.position, point), 0.0099f);
    EXPECT_GT(glm::distance(camera.position, camera.target), 0.0099f);
    for (int i = 0; i < 300; ++i) camera = cw2::dollied(camera, point, 1.0f / 0.85f, 0.01f, 100.0f);
    EXPECT_LT(glm::distance(camera.position, point), 100.1f);
}

TEST(OrbitCamera, ALightThatIsDraggedStaysOnItsSphereAndFollows) {
    const vec3 center = kCamera.target;
    const vec3 light = glm::mix(center, kCamera.position, 0.5f);
    const vec3 right = cw2::dragged_about(light, center, kCamera, {0.2f, 0.0f});
    const vec3 down = cw2::dragged_about(light, center, kCamera, {0.0f, 0.2f});
    EXPECT_NEAR(glm::distance(right, center), glm::distance(light, center), 1e-4f);
    EXPECT_GT(place_of(kCamera, right).x, 0.05f);
    EXPECT_NEAR(place_of(kCamera, right).y, 0.0f, 1e-4f);
    EXPECT_GT(place_of(kCamera, down).y, 0.05f);
}

}  // namespace
