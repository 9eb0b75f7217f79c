// Moving and turning the camera.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "cw2/window/fly_camera.h"

namespace {

using cw2::Camera;
using glm::vec2;
using glm::vec3;

/// Where `point` is seen: to the right, up, and behind.
vec3 seen(const Camera& camera, const vec3& point) {
    return vec3(cw2::view_from_world(camera) * glm::vec4(point, 1.0f));
}

vec3 forward(const Camera& camera) {
    return glm::normalize(camera.target - camera.position);
}

constexpr Camera kCamera{{1.0f, 2.0f, 3.0f}, {4.0f, 1.0f, -2.0f}, 1.0f};

TEST(FlyCamera, MovingKeepsTheDirection) {
    const Camera camera = cw2::moved(kCamera, {0.5f, -2.0f, 3.0f});
    EXPECT_NEAR(glm::distance(forward(camera), forward(kCamera)), 0.0f, 1e-6f);
    EXPECT_EQ(camera.vertical_fov, kCamera.vertical_fov);
}

TEST(FlyCamera, MovesRightForwardAndUpTheWorld) {
    const vec3 right = seen(kCamera, cw2::moved(kCamera, {2.0f, 0.0f, 0.0f}).position);
    EXPECT_NEAR(glm::distance(right, vec3(2.0f, 0.0f, 0.0f)), 0.0f, 1e-5f);
    const vec3 ahead = seen(kCamera, cw2::moved(kCamera, {0.0f, 0.0f, 2.0f}).position);
    EXPECT_NEAR(glm::distance(ahead, vec3(0.0f, 0.0f, -2.0f)), 0.0f, 1e-5f);
    const vec3 up = cw2::moved(kCamera, {0.0f, 2.0f, 0.0f}).position;
    EXPECT_NEAR(glm::distance(up, kCamera.position + vec3(0.0f, 2.0f, 0.0f)), 0.0f, 1e-6f);
}

TEST(FlyCamera, TurnsToTheRightAndDownByTheAngle) {
    const Camera right = cw2::turned(kCamera, {0.3f, 0.0f});
    EXPECT_EQ(right.position, kCamera.position);
    EXPECT_GT(seen(kCamera, right.target).x, 0.0f);
    EXPECT_NEAR(forward(right).y, forward(kCamera).y, 1e-6f);
    const vec2 before(forward(kCamera).x, forward(kCamera).z);
    const vec2 after(forward(right).x, forward(right).z);
    EXPECT_NEAR(glm::dot(glm::normalize(before), glm::normalize(after)), std::cos(0.3f), 1e-6f);

    const Camera down = cw2::turned(kCamera, {0.0f, 0.3f});
    EXPECT_LT(seen(kCamera, down.target).y, 0.0f);
    EXPECT_NEAR(glm::dot(forward(kCamera), forward(down)), std::cos(0.3f), 1e-6f);
}

TEST(FlyCamera, TurningBackRestoresTheDirectionAndTheDistanceOfTheTarget) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> angle(-0.6f, 0.6f);
    for (int i = 0; i < 1000; ++i) {
        const vec2 turn(4.0f * angle(random), angle(random));
        const Camera there = cw2::turned(kCamera, turn);
        EXPECT_NEAR(glm::distance(there.position, there.target),
                    glm::distance(kCamera.position, kCamera.target), 1e-4f);
        const Camera back = cw2::turned(there, -turn);
        EXPECT_NEAR(glm::distance(back.target, kCamera.target), 0.0f, 1e-4f);
    }
}

TEST(FlyCamera, NeverTurnsOverItsHead) {
    for (const float angle : {-100.0f, 100.0f}) {
        const Camera camera = cw2::turned(kCamera, {0.0f, angle});
        EXPECT_LT(std::abs(forward(camera).y), std::sin(glm::radians(89.01f)));
        EXPECT_GT(std::abs(forward(camera).y), std::sin(glm::radians(88.99f)));
        EXPECT_GT(glm::dot(vec2(forward(camera).x, forward(camera).z),
                           vec2(forward(kCamera).x, forward(kCamera).z)),
                  0.0f);
    }
}

TEST(FlyCamera, ACameraThatLooksAlongYKeepsItsHeadingWhenItIsFirstTurned) {
    for (const float side : {-1.0f, 1.0f}) {
        const Camera camera{{0.0f, 0.0f, 0.0f}, {0.0f, 5.0f * side, 0.0f}, 1.0f};
        const glm::mat4 before = cw2::view_from_world(camera);
        const glm::mat4 after = cw2::view_from_world(cw2::turned(camera, {0.0f, 1e-3f * side}));
        for (int column = 0; column < 3; ++column) {
            EXPECT_NEAR(glm::distance(before[column], after[column]), 0.0f, 0.02f);
        }
    }
}

}  // namespace
