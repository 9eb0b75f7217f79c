// Triangles in an order of space, where those of the source come in none.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "cw2-bake/geometry/chunks.h"
#include "cw2-bake/geometry/quantise.h"
#include "cw2-bake/geometry/spatial_order.h"
#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/geometry/weld.h"

namespace {

using bake::kAbsent;
using bake::SourceScene;

/// What a corner of the source has become.
using Values = std::array<float, 13>;  // position, normal, UV, tangent, colour

struct Made {
    SourceScene scene;
    bake::FramedTriangles framed;

    Made(const SourceScene& source, bool in_space) : scene(source) {
        const bake::FirstEqual positions(scene.positions);
        framed = in_space ? bake::weld_in_space(scene, positions) : bake::weld(scene, positions);
        bake::add_tangents(scene, framed);
    }

    std::vector<Values> by_source_corner() const {
        std::vector<Values> all(framed.indices.size());
        for (std::uint32_t c = 0; c < all.size(); ++c) {
            const std::uint32_t v = framed.indices[c];
            const bake::FramedScene at{scene, framed};
            const glm::vec3 p = at.position(v), n = at.normal(v);
            const glm::vec2 uv = at.uv(v);
            const glm::vec4 t = framed.vertices[v].tangent;
            const std::uint32_t color = framed.colors.empty() ? 0 : framed.colors[v];
            all[framed.source_of(c)] = {p.x,
                                        p.y,
                                        p.z,
                                        n.x,
                                        n.y,
                                        n.z,
                                        uv.x,
                                        uv.y,
                                        t.x,
                                        t.y,
                                        t.z,
                                        t.w,
                                        std::bit_cast<float>(color)};
        }
        return all;
    }
};

bool same_bits(const std::vector<Values>& a, const std::vector<Values>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

struct Tangle {
    int triangles, points, materials;
    int alone;           ///< a corner in so many has a normal and a UV of its own
    bool crowded_point;  ///< so has every corner at one point
};

/// Triangles between any points of a few: edges of many faces, faces of no area, UVs that mirror or
/// do not span an area, parts of a vertex that do not hang together.
SourceScene tangled_scene(std::mt19937& random, const Tangle& tangle) {
    const auto pick = [&](int below) {
        return static_cast<std::uint32_t>(std::uniform_int_distribution<int>(0, below - 1)(random));
    };
    const auto real = [&] { return std::uniform_real_distribution<float>(-1.0f, 1.0f)(random); };
    SourceScene scene;
    for (int i = 0; i < tangle.points; ++i) {
        scene.positions.emplace_back(real(), real(), real());
        if (pick(4) == 0) scene.positions.back() = scene.positions[pick(i + 1)];
        scene.uvs.emplace_back(real(), real());
        if (pick(3) == 0) scene.uvs.back() = scene.uvs[pick(i + 1)];
    }
    constexpr int kNormals = 60;
    for (int i = 0; i < kNormals; ++i)
        scene.normals.push_back(glm::normalize(glm::vec3(real(), real(), 1.5f)));
    scene.materials.resize(static_cast<std::size_t>(tangle.materials));
    for (int i = 0; i < tangle.triangles; ++i) {
        scene.triangle_material.push_back(pick(8) == 0 ? pick(tangle.materials) : 0);
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t point = pick(tangle.points);
            const bool is_alone = pick(tangle.alone) == 0;
            const bool has_own = is_alone || (tangle.crowded_point && point == 0);
            scene.corners.push_back(
                {point, has_own ? pick(kNormals) : 0, is_alone ? pick(tangle.points) : point});
        }
    }
    return scene;
}

/// So that they are put in order, too.
void scatter_positions(SourceScene& scene) {
    constexpr std::uint32_t kApart = 20;
    std::vector<glm::vec3> apart(kApart * scene.positions.size());
    for (std::size_t i = 0; i < scene.positions.size(); ++i) apart[kApart * i] = scene.positions[i];
    scene.positions = apart;
    for (bake::Corner& corner : scene.corners) corner.position *= kApart;
}

TEST(SpatialOrder, ChangesNothingAtAnyCorner) {
    std::mt19937 random(1);
    int vertices = 0;
    for (int i = 0; i < 300; ++i) {
        // Few points: many faces at each.
        SourceScene scene = tangled_scene(random, {.triangles = 1 + 3 * i,
                                                   .points = 4 + i / 4,
                                                   .materials = 1 + i % 3,
                                                   .alone = i % 2 == 0 ? 8 : 1000,
                                                   .crowded_point = i % 4 == 3});
        if (i % 3 == 1) {
            for (std::size_t c = 0; c < scene.corners.size(); ++c)
                scene.colors.push_back(static_cast<std::uint32_t>(random() % 3));
        }
        if (i % 5 == 1) {
            for (std::size_t c = 0; c < scene.corners.size(); ++c) {
                const float turn = static_cast<float>(random() % 7);
                scene.tangents.emplace_back(std::cos(turn), std::sin(turn), 0.0f, 1.0f);
                if (random() % 2 == 0) scene.tangents.back() = glm::vec4(0.0f);
            }
        }
        const Made plain(scene, false);
        if (i % 2 == 1) scatter_positions(scene);
        const Made sorted(scene, true);
        ASSERT_TRUE(same_bits(plain.by_source_corner(), sorted.by_source_corner())) << i;
        ASSERT_EQ(plain.framed.vertices.size(), sorted.framed.vertices.size()) << i;
        vertices += static_cast<int>(plain.framed.vertices.size());
    }
    EXPECT_GT(vertices, 50'000);
}

/// A wavy sheet of so many cells of two triangles, in three materials, row by row.
SourceScene sheet(std::uint32_t columns, std::uint32_t rows) {
    SourceScene scene;
    const std::uint32_t stride = columns + 1;
    for (std::uint32_t i = 0; i < stride * (rows + 1); ++i) {
        const glm::vec2 uv(i % stride, i / stride);
        scene.uvs.push_back(uv);
        scene.positions.emplace_back(uv, std::sin(0.1f * uv.x));
        scene.normals.push_back(glm::normalize(glm::vec3(-0.1f * std::cos(0.1f * uv.x), 0, 1)));
    }
    scene.materials.resize(3);
    for (std::uint32_t y = 0; y < rows; ++y) {
        for (std::uint32_t x = 0; x < columns; ++x) {
            const std::uint32_t a = y * stride + x;
            for (const std::uint32_t i : {a, a + 1, a + stride + 1, a, a + stride + 1, a + stride})
                scene.corners.push_back({i, i, i});
        }
        scene.triangle_material.extend(scene.corners.size() / 3, 2 - 3 * y / rows);
    }
    return scene;
}

/// The scene with triangles, `size` at a time, in no order, of which some change their materials.
SourceScene shuffled(const SourceScene& scene, std::size_t size = 1) {
    SourceScene result = scene;
    const std::size_t triangles = scene.corners.size() / 3;
    std::vector<std::size_t> order(triangles / size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::shuffle(order, std::mt19937(5));
    for (std::size_t i = 0; i < order.size(); ++i)
        std::copy_n(&scene.corners[3 * size * order[i]], 3 * size, &result.corners[3 * size * i]);
    return result;
}

TEST(SpatialOrder, ChangesNothingAtAnyCornerOfALargeScene) {
    const SourceScene scene = shuffled(sheet(300, 300));
    const Made plain(scene, false);
    const Made sorted(scene, true);
    EXPECT_TRUE(same_bits(plain.by_source_corner(), sorted.by_source_corner()));
    EXPECT_EQ(plain.framed.vertices.size(), sorted.framed.vertices.size());
}

TEST(SpatialOrder, IsAskedForWhereTrianglesJumpAbout) {
    const auto jumps = [](const SourceScene& scene) {
        return jumps_about(scene, bake::FirstEqual(scene.positions));
    };
    const SourceScene ordered = sheet(400, 400);
    EXPECT_FALSE(jumps(ordered));
    EXPECT_TRUE(jumps(shuffled(ordered)));
    EXPECT_TRUE(jumps(shuffled(ordered, 2)));
    EXPECT_TRUE(jumps(shuffled(ordered, 8)));
    EXPECT_FALSE(jumps(sheet(20'000, 8)));  // rows longer than what is looked at
    EXPECT_FALSE(jumps(shuffled(ordered, 4000)));
    EXPECT_FALSE(jumps(shuffled(sheet(40, 40))));  // all of it is in the caches
    // Where no triangle shares a vertex with one far off none is waited for.
    SourceScene apart = ordered;
    apart.positions.clear();
    for (std::uint32_t c = 0; c < apart.corners.size(); ++c) {
        apart.positions.push_back(ordered.positions[ordered.corners[c].position] +
                                  glm::vec3(c / 3));
        apart.corners[c].position = c;
    }
    EXPECT_FALSE(jumps(shuffled(apart)));
    // Nor where materials change all the time: the order would take more than it gives.
    SourceScene colorful = shuffled(ordered);
    colorful.triangle_material = {};
    for (std::uint32_t i = 0; i < colorful.corners.size() / 3; ++i)
        colorful.triangle_material.push_back(i % 3);
    EXPECT_FALSE(jumps(colorful));
    // Equal positions are one.
    SourceScene soup = shuffled(ordered);
    soup.positions.clear();
    for (std::uint32_t c = 0; c < soup.corners.size(); ++c)
        soup.positions.push_back(ordered.positions[std::exchange(soup.corners[c].position, c)]);
    EXPECT_TRUE(jumps(soup));
}

/// How many positions a thousand consecutive triangles of the middle have.
std::size_t positions_of_a_thousand(const SourceScene& scene) {
    std::set<std::uint32_t> met;
    const std::size_t middle = scene.corners.size() / 6;
    for (std::size_t c = 3 * middle; c < 3 * (middle + 1000); ++c)
        met.insert(scene.corners[c].position);
    return met.size();
}

TEST(SpatialOrder, BringsNeighboursTogether) {
    SourceScene scene = shuffled(sheet(400, 400));
    // For few that are far off no grid of equal cells would do.
    for (std::size_t i = 0; i < 2000; ++i) scene.positions[i] *= 1e6f;
    std::vector<std::uint32_t> materials(scene.triangle_material.begin(),
                                         scene.triangle_material.end());
    const bake::FirstEqual positions(scene.positions);
    SourceScene rest = scene;
    const bake::FramedTriangles framed = bake::weld_in_space(rest, positions);
    std::vector<bool> met(materials.size());
    ASSERT_EQ(rest.triangle_material.runs().size(), 3u);
    for (std::size_t t = 0; t < materials.size(); ++t) {
        const std::uint32_t source = framed.sources[t];
        ASSERT_FALSE(met[source]);
        met[source] = true;
        ASSERT_EQ(rest.triangle_material[t], materials[source]);
    }
    SourceScene sorted = scene;
    for (std::uint32_t c = 0; c < scene.corners.size(); ++c)
        sorted.corners[c] = scene.corners[framed.source_of(c)];
    EXPECT_GT(positions_of_a_thousand(scene), 2500u);
    EXPECT_LT(positions_of_a_thousand(sorted), 2000u);
}

TEST(SpatialOrder, IsThatOfScatteredAttributesOfVertices) {
    const SourceScene ordered = sheet(100, 100);
    SourceScene scattered = ordered;
    const auto count = static_cast<std::uint32_t>(ordered.positions.size());
    const auto place = [&](std::uint32_t i) { return i * 7919 % count; };
    for (std::uint32_t i = 0; i < count; ++i) {
        scattered.positions[place(i)] = ordered.positions[i];
        scattered.normals[place(i)] = ordered.normals[i];
        scattered.uvs[place(i)] = ordered.uvs[i];
    }
    for (bake::Corner& corner : scattered.corners)
        corner = {place(corner.position), place(corner.normal), place(corner.uv)};
    const Made plain(ordered, false);
    const Made sorted(scattered, false);
    EXPECT_TRUE(same_bits(plain.by_source_corner(), sorted.by_source_corner()));
    EXPECT_EQ(plain.scene.normals, ordered.normals);
    for (std::uint32_t v = 0; v < sorted.framed.vertices.size(); ++v) {
        const bake::Corner& corner = sorted.framed.vertices[v].corner;
        ASSERT_EQ(corner.normal, v);
        ASSERT_EQ(corner.uv, v);
        ASSERT_EQ(sorted.scene.positions[corner.position], sorted.scene.positions[v]);
    }
}

TEST(SpatialOrder, IsTheSameForAnyNumberOfThreads) {
    const SourceScene scene = shuffled(sheet(300, 300));
    std::vector<std::byte> vertices;
    std::vector<std::uint16_t> indices;
    for (const std::size_t threads : {1, 2, 5}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const Made made(scene, true);
        const std::vector<bake::UvBudget> budgets(3);
        const bake::FramedScene framed{made.scene, made.framed};
        const bake::ChunkedScene chunked = bake::make_chunks(framed, budgets);
        const bake::PackedGeometry packed =
            bake::quantise(framed, chunked, budgets,
                           {mesh_format::FrameForm::quat48, mesh_format::PositionForm::quantised});
        if (threads == 1) {
            vertices.assign(packed.vertices.begin(), packed.vertices.end());
            indices.assign(packed.indices.begin(), packed.indices.end());
        }
        EXPECT_TRUE(std::ranges::equal(packed.vertices, vertices)) << threads;
        EXPECT_TRUE(std::ranges::equal(packed.indices, indices)) << threads;
    }
}

}  // namespace
