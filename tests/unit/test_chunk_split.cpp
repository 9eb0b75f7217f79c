// Halving triangles by space, and ordering those of a chunk, against slow references.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <map>
#include <mutex>
#include <random>

#include "cw2-bake/geometry/chunk_split.h"
#include "cw2-bake/geometry/triangle_order.h"

namespace {

using bake::CentredTriangle;
using Triangles = std::vector<CentredTriangle>;

/// Coordinates repeat when `values` is small.
Triangles random_triangles(std::mt19937& random, std::size_t count, int values) {
    std::uniform_int_distribution<int> value(0, values - 1);
    const glm::vec3 scale(value(random), value(random), value(random));
    Triangles triangles(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        triangles[i] = {scale * glm::vec3(value(random), value(random), value(random)) - 5.0f,
                        7 * i + 3};
    }
    return triangles;
}

/// What halve() promises, by sorting.
Triangles halves_by_sorting(const Triangles& triangles) {
    glm::vec3 low = triangles[0].centroid, high = low;
    for (const CentredTriangle& t : triangles) {
        low = glm::min(low, t.centroid);
        high = glm::max(high, t.centroid);
    }
    const glm::vec3 size = high - low;
    int axis = 0;
    if (size.y > size[axis]) axis = 1;
    if (size.z > size[axis]) axis = 2;
    Triangles sorted = triangles;
    std::ranges::sort(sorted, {}, [axis](const CentredTriangle& t) {
        return std::pair(t.centroid[axis], t.index);
    });
    const auto half = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::sort(sorted.begin(), half, {}, &CentredTriangle::index);
    std::ranges::sort(half, sorted.end(), {}, &CentredTriangle::index);
    return sorted;
}

TEST(ChunkSplit, HalvesAlongTheLongestSideAndKeepsTheOrder) {
    std::mt19937 random(1);
    for (int round = 0; round < 300; ++round) {
        const std::size_t count = 2 + random() % 900;
        const int values = round % 3 == 0 ? 3 : round % 3 == 1 ? 40 : 1'000'000;
        const Triangles triangles = random_triangles(random, count, values);
        Triangles halved(count);
        bake::halve(triangles, halved);
        const Triangles expected = halves_by_sorting(triangles);
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(halved[i].index, expected[i].index);
    }
}

TEST(ChunkSplit, HandsOutEachTriangleOnceInPartsThatFollowEachOther) {
    std::mt19937 random(2);
    for (const std::size_t count : {1u, 512u, 513u, 5000u, 40'000u}) {
        Triangles triangles = random_triangles(random, count, 1000), spare(count);
        std::mutex mutex;
        std::map<std::size_t, std::pair<std::size_t, Triangles>> parts;
        bake::split(triangles, spare,
                    [&](std::size_t part, std::span<CentredTriangle> members, std::size_t begin) {
                        const std::lock_guard lock(mutex);
                        parts[part] = {begin, Triangles(members.begin(), members.end())};
                    });
        EXPECT_EQ(parts.size(), bake::part_count(count));
        std::size_t next = 0;
        std::vector<std::uint32_t> seen;
        for (const auto& [part, placed] : parts) {
            EXPECT_EQ(placed.first, next);
            next += placed.second.size();
            EXPECT_LE(placed.second.size(), std::size_t{mesh_format::kMaxChunkTriangles});
            EXPECT_TRUE(std::ranges::is_sorted(placed.second, {}, &CentredTriangle::index));
            for (const CentredTriangle& t : placed.second) seen.push_back(t.index);
        }
        std::ranges::sort(seen);
        ASSERT_EQ(seen.size(), count);
        for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(seen[i], 7 * i + 3);
    }
}

/// Vertices that a cache of the last `size` lets through, per triangle.
double cache_misses(std::span<const std::uint16_t> indices,
                    std::span<const std::uint16_t> triangles, std::size_t size) {
    std::vector<std::uint16_t> cache;
    std::size_t misses = 0;
    for (const std::uint16_t triangle : triangles) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint16_t v = indices[3 * std::size_t{triangle} + corner];
            if (std::find(cache.begin(), cache.end(), v) != cache.end()) continue;
            ++misses;
            cache.push_back(v);
            if (cache.size() > size) cache.erase(cache.begin());
        }
    }
    return static_cast<double>(misses) / static_cast<double>(triangles.size());
}

TEST(TriangleOrder, OfRandomTrianglesIsAPermutation) {
    std::mt19937 random(3);
    bake::TriangleOrder order;
    for (int round = 0; round < 200; ++round) {
        // At last a full chunk of triangles of one vertex.
        const bool is_last = round == 199;
        const std::size_t vertex_count = is_last ? 1 : 1 + random() % 700;
        std::vector<std::uint16_t> indices(3 * (is_last ? 512 : 1 + random() % 512));
        for (auto& index : indices) index = static_cast<std::uint16_t>(random() % vertex_count);
        const auto ordered = order.order(indices, vertex_count);
        std::vector<std::uint16_t> sorted(ordered.begin(), ordered.end());
        std::ranges::sort(sorted);
        ASSERT_EQ(sorted.size(), indices.size() / 3);
        for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
    }
}

TEST(TriangleOrder, OfASheetUsesVerticesAgainWhileTheyAreCached) {
    constexpr std::uint16_t kSide = 16;
    std::vector<std::array<std::uint16_t, 3>> triangles;
    for (std::uint16_t y = 0; y < kSide; ++y) {
        for (std::uint16_t x = 0; x < kSide; ++x) {
            const auto a = static_cast<std::uint16_t>(y * (kSide + 1) + x);
            const auto below = static_cast<std::uint16_t>(a + kSide + 1);
            triangles.push_back({a, below, static_cast<std::uint16_t>(a + 1)});
            triangles.push_back(
                {static_cast<std::uint16_t>(a + 1), below, static_cast<std::uint16_t>(below + 1)});
        }
    }
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(4));
    std::vector<std::uint16_t> indices;
    for (const auto& triangle : triangles)
        indices.insert(indices.end(), triangle.begin(), triangle.end());
    bake::TriangleOrder order;
    const auto ordered = order.order(indices, (kSide + 1) * (kSide + 1));
    // 0.56 if every vertex came once; about 3 in the shuffled order.
    EXPECT_LT(cache_misses(indices, ordered, bake::TriangleOrder::kCacheSize), 0.8);
}

/// Once round vertex 0, or half round, in any order and turned in any way.
TEST(TriangleOrder, AroundAVertexTrianglesGoOnFromEachOther) {
    std::mt19937 random(5);
    bake::TriangleOrder order;
    for (const std::uint16_t count : {5, 8}) {
        std::vector<std::array<std::uint16_t, 3>> triangles;
        for (std::uint16_t i = 0; i < count; ++i)
            triangles.push_back({0, static_cast<std::uint16_t>(1 + i),
                                 static_cast<std::uint16_t>(1 + (i + 1) % 8)});
        std::shuffle(triangles.begin(), triangles.end(), random);
        std::vector<std::uint16_t> indices;
        for (auto triangle : triangles) {
            std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
            indices.insert(indices.end(), triangle.begin(), triangle.end());
        }
        // Vertex 0 is the first whose triangles are drawn.
        const auto ordered = order.order(indices, 9);
        for (std::size_t i = 1; i < count; ++i)
            EXPECT_EQ(triangles[ordered[i]][1], triangles[ordered[i - 1]][2]);
    }
}

}  // namespace
