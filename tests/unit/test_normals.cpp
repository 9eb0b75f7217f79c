#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "cw2-bake/geometry/normals.h"
#include "obj_text.h"

namespace {

using bake::kAbsent;
using bake::SourceScene;

SourceScene scene_of(const std::string& obj) {
    SourceScene scene = read(obj).scene;
    bake::generate_normals(scene, bake::FirstEqual(scene.positions));
    for (const bake::Corner& corner : scene.corners) {
        const glm::vec3 n = scene.normals.at(corner.normal);
        EXPECT_NEAR(glm::length(n), 1, 1e-6);
        for (int i = 0; i < 3; ++i) EXPECT_FALSE(n[i] == 0 && std::signbit(n[i]));
    }
    return scene;
}

glm::vec3 normal_at(const SourceScene& scene, std::size_t corner) {
    return scene.normals.at(scene.corners.at(corner).normal);
}
glm::vec3 position_at(const SourceScene& scene, std::size_t corner) {
    return scene.positions.at(scene.corners.at(corner).position);
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
    EXPECT_LE(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

const std::string kCubeCorners =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
const std::string kCube = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
/// The same cube with corners of its own on each side.
std::string split_cube() {
    std::string text;
    for (int i = 0; i < 6; ++i) text += kCubeCorners;
    return text +
           "s 1\nf 1 4 3 2\nf 13 14 15 16\nf 17 18 22 21\nf 26 27 31 30\nf 35 36 40 39\n"
           "f 44 41 45 48\n";
}

TEST(Normals, AreFlatWithoutSmoothing) {
    for (const std::string smoothing : {"", "s off\n", "s 0\n", "s 1\ns off\n"}) {
        const SourceScene scene = scene_of(kCubeCorners + smoothing + kCube);
        for (std::size_t i = 0; i < scene.corners.size(); ++i) {
            const std::size_t t = i / 3 * 3;
            expect_near(
                normal_at(scene, i),
                glm::normalize(glm::cross(position_at(scene, t + 1) - position_at(scene, t),
                                          position_at(scene, t + 2) - position_at(scene, t))));
        }
        EXPECT_EQ(scene.normals.size(), 6u);
    }
}

// Each side has a right angle at each corner, however its square is cut: only angle weights give
// the diagonal.
TEST(Normals, OfASmoothCubePointAlongItsDiagonals) {
    for (const std::string& text : {kCubeCorners + "s 1\n" + kCube, split_cube()}) {
        const SourceScene scene = scene_of(text);
        for (std::size_t i = 0; i < scene.corners.size(); ++i) {
            expect_near(normal_at(scene, i), position_at(scene, i) / std::sqrt(3.0f));
        }
        EXPECT_EQ(scene.normals.size(), 8u);
    }
}

TEST(Normals, OfASphereAreItsDirections) {
    std::string text;
    constexpr int kRings = 24, kSteps = 48;
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int step = 0; step < kSteps; ++step) {
            const double a = std::numbers::pi * ring / kRings,
                         b = 2 * std::numbers::pi * step / kSteps;
            text += "v " + std::to_string(std::sin(a) * std::cos(b)) + " " +
                    std::to_string(std::cos(a)) + " " + std::to_string(-std::sin(a) * std::sin(b)) +
                    "\n";
        }
    }
    text += "s 7\n";
    for (int ring = 0; ring < kRings; ++ring) {
        for (int step = 0; step < kSteps; ++step) {
            const int a = ring * kSteps + step + 1, b = ring * kSteps + (step + 1) % kSteps + 1;
            text += "f " + std::to_string(a) + " " + std::to_string(a + kSteps) + " " +
                    std::to_string(b + kSteps) + " " + std::to_string(b) + "\n";
        }
    }
    const SourceScene scene = scene_of(text);
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        expect_near(normal_at(scene, i), position_at(scene, i), 0.01f);
    }
}

TEST(Normals, KeepSmoothingGroupsApart) {
    const SourceScene scene = scene_of(kCubeCorners +
                                       "s 1\nf 1 4 3 2\ns 2\nf 5 6 7 8\nf 1 2 6 5\n"
                                       "s off\nf 2 3 7 6\n");
    for (std::size_t i = 0; i < 6; ++i) expect_near(normal_at(scene, i), {0, 0, -1});
    const float diagonal = std::sqrt(0.5f);
    for (std::size_t i = 6; i < 18; ++i) {
        const glm::vec3 p = position_at(scene, i);
        const bool shared = p.y < 0 && p.z > 0;
        const glm::vec3 own = i < 12 ? glm::vec3{0, 0, 1} : glm::vec3{0, -1, 0};
        expect_near(normal_at(scene, i), shared ? glm::vec3{0, -diagonal, diagonal} : own);
    }
    for (std::size_t i = 18; i < 24; ++i) expect_near(normal_at(scene, i), {1, 0, 0});
}

TEST(Normals, ThatAreThereStay) {
    const SourceScene scene =
        scene_of(kCubeCorners + "vn 0 0.6 0.8\nvn 0 0 0\ns 1\nf 1//1 4//1 3\nf 1 3//2 2//1\n");
    for (const std::size_t i : {0, 1, 5}) expect_near(normal_at(scene, i), {0, 0.6f, 0.8f});
    for (const std::size_t i : {2, 3, 4}) expect_near(normal_at(scene, i), {0, 0, -1});
}

TEST(Normals, AreFiniteWhereTrianglesHaveNoArea) {
    const std::string flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\n";
    for (const std::string smoothing : {"s 0\n", "s 1\n"}) {
        SourceScene scene = scene_of(flat + smoothing + "f 1 2 3\nf 1 1 1\nf 1 2 2\n");
        for (std::size_t i = 0; i < 9; ++i) expect_near(normal_at(scene, i), {0, 1, 0});
    }
    // Two sides of one sheet in one group cancel out: each keeps its own.
    const SourceScene sheet = scene_of(flat + "v 0 1 0\ns 1\nf 1 2 4\nf 1 4 2\n");
    for (std::size_t i = 0; i < 6; ++i) expect_near(normal_at(sheet, i), {0, 0, i < 3 ? 1 : -1});
}

TEST(Normals, HoldForVerySmallAndVeryLargeTriangles) {
    for (const std::string scale : {"e-30", "e30"}) {
        const std::string corners = "v 0 0 0\nv 1" + scale + " 0 0\nv 0 1" + scale + " 0\n";
        const SourceScene scene = scene_of(corners + "f 1 2 3\ns 1\nf 1 2 3\n");
        for (std::size_t i = 0; i < 6; ++i) expect_near(normal_at(scene, i), {0, 0, 1});
    }
}

TEST(Normals, HoldWhereManyGroupsMeet) {
    std::string text = "v 0 0 1\n";
    constexpr int kSides = 200;
    for (int i = 0; i < kSides; ++i) {
        const double angle = 2 * std::numbers::pi * i / kSides;
        text +=
            "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
    }
    for (int i = 0; i < kSides; ++i) {
        text += "s " + std::to_string(i / 2 + 1) + "\nf 1 " + std::to_string(i + 2) + " " +
                std::to_string((i + 1) % kSides + 2) + "\n";
    }
    const SourceScene scene = scene_of(text);
    for (std::size_t pair = 0; pair < kSides / 2; ++pair) {
        const double angle = 2 * std::numbers::pi * (2 * double(pair) + 1) / kSides;
        const glm::vec3 apex = normal_at(scene, 6 * pair);
        expect_near(apex, glm::normalize(glm::vec3(std::cos(angle), std::sin(angle), 1)), 2e-3f);
        EXPECT_EQ(scene.corners[6 * pair].normal, scene.corners[6 * pair + 3].normal);
    }
}

TEST(Normals, OfOnePolygonAreOneButOfACurveAreNot) {
    // A tilted plane whose coordinates are rounded, cut into many triangles.
    std::string text;
    for (int i = 0; i < 9; ++i) {
        const double angle = 2 * std::numbers::pi * i / 9;
        const double x = std::cos(angle), y = std::sin(angle);
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
                std::to_string(0.3 * x + 0.7 * y) + "\n";
    }
    EXPECT_EQ(scene_of(text + "f 1 2 3 4 5 6 7 8 9\n").normals.size(), 1u);
    // A strip that turns by a little with every step.
    text.clear();
    constexpr int kSteps = 200;
    for (int i = 0; i <= kSteps; ++i) {
        const double angle = 5e-5 * i;
        const std::string xz = std::to_string(1e4 * std::sin(angle)) + " %d " +
                               std::to_string(1e4 * (std::cos(angle) - 1));
        for (const char* y : {"0", "100"}) {
            text += "v " + std::string(xz).replace(xz.find("%d"), 2, y) + "\n";
        }
    }
    for (int i = 0; i < kSteps; ++i) {
        const int a = 2 * i + 1;
        text += "f " + std::to_string(a) + " " + std::to_string(a + 2) + " " +
                std::to_string(a + 3) + " " + std::to_string(a + 1) + "\n";
    }
    const SourceScene strip = scene_of(text);
    for (std::size_t i = 0; i < strip.corners.size(); ++i) {
        const glm::vec3 p = position_at(strip, i);
        expect_near(normal_at(strip, i), glm::normalize(glm::vec3(p.x, 0, p.z + 1e4f)), 1.6e-4f);
    }
}

}  // namespace
