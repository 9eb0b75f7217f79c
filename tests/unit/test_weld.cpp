#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <map>
#include <random>

#include "cw2-bake/geometry/up_axis.h"
#include "cw2-bake/geometry/weld.h"

namespace {

using bake::kAbsent;
using bake::SourceScene;

using Values = std::array<float, 8>;

Values values_of(const glm::vec3& p, const glm::vec3& n, const glm::vec2& uv) {
    return {p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
}

Values corner_of(const SourceScene& scene, const bake::Corner& c) {
    return values_of(scene.positions[c.position], scene.normals[c.normal],
                     c.uv == kAbsent ? glm::vec2{0} : scene.uvs[c.uv]);
}

/// Values repeat within the pools, and pool entries repeat among corners.
SourceScene random_scene(std::mt19937& random, int triangles, int positions, int variants) {
    const auto pick = [&](int below) {
        return static_cast<std::uint32_t>(std::uniform_int_distribution<int>(0, below - 1)(random));
    };
    SourceScene scene;
    const auto coordinate = [&](int below) { return static_cast<float>(pick(below)) * 0.1f; };
    for (int i = 0; i < positions; ++i) {
        scene.positions.emplace_back(coordinate(3), coordinate(3), coordinate(positions));
    }
    for (int i = 0; i < variants; ++i) {
        scene.normals.emplace_back(coordinate(variants), coordinate(2), 1.0f);
        scene.uvs.emplace_back(coordinate(variants), coordinate(2));
    }
    scene.materials.resize(4);
    for (int i = 0; i < triangles; ++i) {
        scene.triangle_material.push_back(pick(2) * 2 + pick(2) * pick(2));
        for (int j = 0; j < 3; ++j) {
            const bool has_uv = pick(3) > 0;
            scene.corners.push_back(
                {pick(positions), pick(variants), has_uv ? pick(variants) : kAbsent});
        }
    }
    return scene;
}

/// What became of a scene's corners.
struct Welded {
    SourceScene scene;
    bake::FramedTriangles triangles;

    explicit Welded(const SourceScene& from) : scene(from) {
        const bake::FirstEqual positions(scene.positions);
        triangles = bake::weld(scene, positions);
    }
    const bake::Corner& corner(std::size_t i) const {
        return triangles.vertices[triangles.indices[i]].corner;
    }
};

TEST(Weld, MakesOneVertexOfCornersThatAreEqualInValueAndMaterial) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        // Up to thousands of vertices at one position.
        const SourceScene scene = i % 10 == 0 ? random_scene(random, 2000, 2, 200)
                                              : random_scene(random, 1 + i, 1 + i / 3, 1 + i / 9);
        const Welded welded(scene);
        EXPECT_TRUE(welded.scene.corners.empty());
        ASSERT_EQ(welded.triangles.indices.size(), scene.corners.size());
        std::map<std::pair<Values, std::uint32_t>, std::uint32_t> vertices;
        std::map<std::array<float, 3>, std::uint32_t> positions;
        for (std::size_t c = 0; c < scene.corners.size(); ++c) {
            const Values value = corner_of(scene, scene.corners[c]);
            ASSERT_NE(welded.corner(c).uv, kAbsent);
            ASSERT_EQ(corner_of(welded.scene, welded.corner(c)), value) << i;
            const std::uint32_t position = welded.corner(c).position;
            ASSERT_EQ(positions.try_emplace({value[0], value[1], value[2]}, position).first->second,
                      position);
            const std::pair key{value, scene.triangle_material[c / 3]};
            const std::uint32_t vertex = welded.triangles.indices[c];
            ASSERT_EQ(vertices.try_emplace(key, vertex).first->second, vertex) << i;
        }
        EXPECT_EQ(vertices.size(), welded.triangles.vertices.size());
    }
}

TEST(FirstEqual, IsTheFirstOfEachValueWhateverTheNumberOfThreads) {
    std::mt19937 random(2);
    // Enough for several tasks.
    const std::vector<glm::vec3> values = random_scene(random, 1, 270'000, 90).positions;
    std::map<std::array<float, 3>, std::uint32_t> first;
    for (std::uint32_t i = 0; i < values.size(); ++i)
        first.try_emplace({values[i].x, values[i].y, values[i].z}, i);
    for (const std::size_t threads : {1, 2, 3, 5}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const bake::FirstEqual equal(values);
        EXPECT_EQ(equal.count(), first.size());
        for (std::uint32_t i = 0; i < values.size(); ++i)
            ASSERT_EQ(equal[i], first.at({values[i].x, values[i].y, values[i].z})) << threads;
    }
}

TEST(Weld, TreatsAMissingUvAsZero) {
    SourceScene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.normals = {{0, 0, 1}};
    scene.uvs = {{1, 1}, {0, 0}};
    scene.corners = {{0, 0, 1}, {1, 0, kAbsent}, {2, 0, 0}};
    scene.triangle_material.push_back(0);
    scene.materials.resize(1);
    const Welded welded(scene);
    EXPECT_EQ(welded.scene.uvs[welded.corner(0).uv], glm::vec2(0, 0));
    EXPECT_EQ(welded.scene.uvs[welded.corner(1).uv], glm::vec2(0, 0));
    EXPECT_EQ(welded.scene.uvs[welded.corner(2).uv], glm::vec2(1, 1));
    // Stated and missing ones at one place are one vertex.
    scene.corners[2] = {0, 0, kAbsent};
    EXPECT_EQ(Welded(scene).triangles.vertices.size(), 2u);
}

TEST(RunVector, HoldsWhatAVectorHolds) {
    std::mt19937 random(3);
    for (int i = 0; i < 100; ++i) {
        std::vector<std::uint32_t> plain;
        bake::RunVector runs;
        for (int n = static_cast<int>(random() % 20); n > 0; --n) {
            const std::uint32_t number = random() % 3;
            plain.resize(plain.size() + random() % 4, number);
            runs.extend(plain.size(), number);
        }
        ASSERT_EQ(std::vector<std::uint32_t>(runs.begin(), runs.end()), plain);
        ASSERT_EQ(runs.size(), plain.size());
        ASSERT_EQ(runs.empty(), plain.empty());
        for (std::size_t k = 0; k < plain.size(); ++k) ASSERT_EQ(runs[k], plain[k]);
        for (std::size_t k = 1; k < runs.runs().size(); ++k)
            ASSERT_NE(runs.runs()[k].number, runs.runs()[k - 1].number);
    }
}

TEST(UpAxis, TurnsZToYAndKeepsHandedness) {
    SourceScene scene;
    scene.positions = {{1, 2, 3}, {0, 0, 0}};
    scene.normals = {{0, 0, 1}, {0, 1, 0}};
    bake::turn_z_up(scene);
    EXPECT_EQ(scene.positions[0], glm::vec3(1, 3, -2));
    EXPECT_EQ(scene.normals[0], glm::vec3(0, 1, 0));
    EXPECT_EQ(scene.normals[1], glm::vec3(0, 0, -1));
    EXPECT_FALSE(std::signbit(scene.positions[1].z));
}

}  // namespace
