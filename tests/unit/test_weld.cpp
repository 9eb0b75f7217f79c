#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>

#include "cw2-bake/up_axis.h"
#include "cw2-bake/weld.h"

namespace {

using bake::kAbsent;
using bake::SourceScene;
using bake::WeldedMesh;

using Values = std::array<float, 8>;

Values values_of(const glm::vec3& p, const glm::vec3& n, const glm::vec2& uv) {
    return {p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
}

Values corner_of(const SourceScene& scene, std::size_t i) {
    const bake::Corner& c = scene.corners[i];
    return values_of(scene.positions[c.position], scene.normals[c.normal],
                     c.uv == kAbsent ? glm::vec2{0} : scene.uvs[c.uv]);
}

/// What weld() promises, in a few slow lines.
std::vector<WeldedMesh> weld_by_map(const SourceScene& scene) {
    std::vector<WeldedMesh> meshes;
    for (std::uint32_t material = 0; material < scene.materials.size(); ++material) {
        WeldedMesh mesh;
        mesh.material = material;
        std::map<Values, std::uint32_t> indices;
        for (std::size_t i = 0; i < scene.corners.size(); ++i) {
            if (scene.triangle_material[i / 3] != material) continue;
            const Values v = corner_of(scene, i);
            const auto next = static_cast<std::uint32_t>(mesh.positions.size());
            const auto [entry, is_new] = indices.try_emplace(v, next);
            if (is_new) {
                mesh.positions.emplace_back(v[0], v[1], v[2]);
                mesh.normals.emplace_back(v[3], v[4], v[5]);
                mesh.uvs.emplace_back(v[6], v[7]);
            }
            mesh.indices.push_back(entry->second);
        }
        if (!mesh.indices.empty()) meshes.push_back(mesh);
    }
    return meshes;
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

TEST(Weld, MakesOneVertexOfEqualValuesInTheOrderOfFirstUse) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        // Up to thousands of vertices at one position.
        const SourceScene scene = i % 10 == 0 ? random_scene(random, 2000, 2, 200)
                                              : random_scene(random, 1 + i, 1 + i / 3, 1 + i / 9);
        const auto meshes = bake::weld(scene);
        const auto expected = weld_by_map(scene);
        ASSERT_EQ(meshes.size(), expected.size());
        for (std::size_t m = 0; m < meshes.size(); ++m) {
            EXPECT_EQ(meshes[m].material, expected[m].material);
            EXPECT_EQ(meshes[m].positions, expected[m].positions);
            EXPECT_EQ(meshes[m].normals, expected[m].normals);
            EXPECT_EQ(meshes[m].uvs, expected[m].uvs);
            EXPECT_EQ(meshes[m].indices, expected[m].indices);
        }
        if (HasFailure()) FAIL() << i;
    }
}

TEST(Weld, TreatsAMissingUvAsZero) {
    SourceScene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.normals = {{0, 0, 1}};
    scene.uvs = {{1, 1}, {0, 0}};
    scene.corners = {{0, 0, 1}, {1, 0, kAbsent}, {2, 0, 0}, {0, 0, kAbsent}, {1, 0, 1}, {2, 0, 0}};
    scene.triangle_material = {0, 0};
    scene.materials.resize(1);
    const auto meshes = bake::weld(scene);
    ASSERT_EQ(meshes.size(), 1u);
    EXPECT_EQ(meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2}));
    EXPECT_EQ(meshes[0].uvs, (std::vector<glm::vec2>{{0, 0}, {0, 0}, {1, 1}}));
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
