#include <gtest/gtest.h>

#include <algorithm>
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

Values corner_of(const SourceScene& scene, std::size_t i) {
    const bake::Corner& c = scene.corners[i];
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

using Indices = std::array<std::uint32_t, 3>;

Indices indices_of(const bake::Corner& c) {
    return {c.position, c.normal, c.uv};
}

TEST(Weld, MakesCornersEqualInIndexWhereTheyAreEqualInValue) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        // Up to thousands of vertices at one position.
        const SourceScene scene = i % 10 == 0 ? random_scene(random, 2000, 2, 200)
                                              : random_scene(random, 1 + i, 1 + i / 3, 1 + i / 9);
        SourceScene welded = scene;
        bake::weld(welded);
        ASSERT_EQ(welded.corners.size(), scene.corners.size());
        EXPECT_EQ(welded.triangle_material, scene.triangle_material);
        std::map<Values, Indices> indices;
        std::map<Indices, Values> values;
        for (std::size_t c = 0; c < scene.corners.size(); ++c) {
            const Values value = corner_of(scene, c);
            ASSERT_NE(welded.corners[c].uv, kAbsent);
            ASSERT_EQ(corner_of(welded, c), value) << i;
            const Indices index = indices_of(welded.corners[c]);
            ASSERT_EQ(indices.try_emplace(value, index).first->second, index) << i;
            ASSERT_EQ(values.try_emplace(index, value).first->second, value) << i;
        }
    }
}

TEST(Weld, TakesTheFirstElementOfEachValue) {
    std::mt19937 random(2);
    SourceScene scene = random_scene(random, 3000, 700, 90);
    bake::weld(scene);
    for (const bake::Corner& c : scene.corners) {
        const auto first = [](const auto& all, std::uint32_t index) {
            return std::find(all.begin(), all.end(), all[index]) - all.begin();
        };
        EXPECT_EQ(c.position, first(scene.positions, c.position));
        EXPECT_EQ(c.normal, first(scene.normals, c.normal));
        EXPECT_EQ(c.uv, first(scene.uvs, c.uv));
    }
}

TEST(Weld, TreatsAMissingUvAsZero) {
    SourceScene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.normals = {{0, 0, 1}};
    scene.uvs = {{1, 1}, {0, 0}};
    scene.corners = {{0, 0, 1}, {1, 0, kAbsent}, {2, 0, 0}};
    scene.triangle_material = {0};
    scene.materials.resize(1);
    bake::weld(scene);
    EXPECT_EQ(scene.corners[1].uv, 1u);
    scene.uvs = {{1, 1}};
    scene.corners = {{0, 0, 0}, {1, 0, kAbsent}, {2, 0, kAbsent}};
    bake::weld(scene);
    EXPECT_EQ(scene.uvs[scene.corners[1].uv], glm::vec2(0, 0));
    EXPECT_EQ(scene.corners[1].uv, scene.corners[2].uv);
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
