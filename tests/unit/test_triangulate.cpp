#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>

#include "cw2-bake/obj/triangulate.h"

namespace {

using Polygon = std::vector<glm::vec3>;
using Triangle = bake::Triangulator::Triangle;

Polygon flat(const std::vector<glm::vec2>& outline) {
    Polygon polygon;
    for (const glm::vec2& p : outline) polygon.emplace_back(p, 0.0f);
    return polygon;
}

double area_about(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                  const glm::dvec3& normal) {
    return glm::dot(glm::cross(b - a, c - a), normal) / 2;
}

/// Checks that the triangles tile the polygon: apart from the polygon's own edges, each once, every
/// edge is run through as often in one direction as in the other, and every triangle has the
/// polygon's orientation. Then each point is covered as often as the outline winds round it: once
/// inside, never outside. Areas may be negative by `tolerance`, and must be positive where it is 0.
void expect_tiling(const Polygon& polygon, const glm::dvec3& normal, double tolerance) {
    bake::Triangulator triangulator;
    const auto triangles = triangulator.triangulate(polygon);
    const auto count = static_cast<std::uint32_t>(polygon.size());
    ASSERT_EQ(triangles.size(), count - 2);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double sum = 0;
    for (const Triangle& t : triangles) {
        const double area =
            area_about(polygon.at(t[0]), polygon.at(t[1]), polygon.at(t[2]), normal);
        if (tolerance > 0) {
            ASSERT_GE(area, -tolerance);
        } else {
            ASSERT_GT(area, 0) << t[0] << " " << t[1] << " " << t[2];
        }
        sum += area;
        for (int i = 0; i < 3; ++i) {
            ++edges[{t[i], t[(i + 1) % 3]}];
            --edges[{t[(i + 1) % 3], t[i]}];
        }
    }
    double polygon_area = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count;
        --edges[{i, next}];
        ++edges[{next, i}];
        polygon_area += area_about(polygon[0], polygon[i], polygon[next], normal);
    }
    for (const auto& [edge, excess] : edges) {
        ASSERT_EQ(excess, 0) << edge.first << " " << edge.second;
    }
    EXPECT_NEAR(sum, polygon_area, 1e-6 * polygon_area);
}

constexpr glm::dvec3 kUp{0, 0, 1};

using Random = std::mt19937;

int pick(Random& random, int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
}

/// Corners at rising angles around the origin, on whole coordinates.
Polygon star(Random& random, int corners) {
    std::vector<glm::vec2> outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.3) / corners;
        const double radius = pick(random, 20'000, 1'000'000);
        outline.emplace_back(std::round(radius * std::cos(angle)),
                             std::round(radius * std::sin(angle)));
    }
    return flat(outline);
}

/// Teeth of random length on a bar.
Polygon comb(Random& random, int teeth) {
    std::vector<glm::vec2> outline{{0, -10}, {4.0f * teeth, -10}};
    for (int i = teeth - 1; i >= 0; --i) {
        const float x = 4.0f * i;
        const float height = static_cast<float>(pick(random, 1, 50));
        outline.insert(outline.end(), {{x + 3, 0}, {x + 3, height}, {x + 1, height}, {x + 1, 0}});
    }
    return flat(outline);
}

/// A corridor of one turn after another.
Polygon spiral(int turns) {
    std::vector<glm::vec2> outward, inward;
    for (int i = 0; i < 4 * turns; ++i) {
        const float side = static_cast<float>(i / 4 * 4 + 4);
        const float xs[] = {side, side, -side, -side - 4}, ys[] = {-side, side, side, -side};
        outward.emplace_back(xs[i % 4], ys[i % 4]);
        const float xi[] = {side - 1, side - 1, -side + 1, -side - 3};
        const float yi[] = {-side + 1, side - 1, side - 1, -side + 1};
        inward.emplace_back(xi[i % 4], yi[i % 4]);
    }
    outward.insert(outward.end(), inward.rbegin(), inward.rend());
    return flat(outward);
}

/// With further corners on its edges, at whole coordinates if the edge's ends are even.
Polygon with_collinear(const Polygon& polygon) {
    Polygon result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec3 a = 2.0f * polygon[i], b = 2.0f * polygon[(i + 1) % polygon.size()];
        result.push_back(a);
        result.push_back((a + b) / 2.0f);
    }
    return result;
}

TEST(Triangulate, TilesStarsCombsAndSpirals) {
    Random random(1);
    for (int n = 3; n < 60; ++n) {
        for (int i = 0; i < 10; ++i) expect_tiling(star(random, n), kUp, 0);
        expect_tiling(comb(random, n), kUp, 0);
    }
    for (int turns = 1; turns < 12; ++turns) expect_tiling(spiral(turns), kUp, 0);
    // Where every corner was compared with every other, these took seconds.
    expect_tiling(star(random, 30'000), kUp, 0);
    expect_tiling(comb(random, 30'000), kUp, 0);
    expect_tiling(spiral(1'000), kUp, 0);
}

TEST(Triangulate, MakesNoSliverOfCollinearCorners) {
    Random random(2);
    for (int n = 3; n < 40; ++n) {
        expect_tiling(with_collinear(star(random, n)), kUp, 0);
        expect_tiling(with_collinear(with_collinear(comb(random, n))), kUp, 0);
    }
    // All corners but three on the edges of a triangle, beginning anywhere.
    Polygon triangle =
        flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {0, 2}, {0, 1}});
    for (std::size_t i = 0; i < triangle.size(); ++i) {
        expect_tiling(triangle, kUp, 0);
        std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    }
}

TEST(Triangulate, TilesInAnyPlaneAndFromEitherSide) {
    Random random(3);
    std::normal_distribution<double> normal_distribution;
    for (int i = 0; i < 400; ++i) {
        const auto draw = [&] { return normal_distribution(random); };
        const glm::dvec3 n = glm::normalize(glm::dvec3{draw(), draw(), draw()});
        const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3{draw(), draw(), draw()}));
        const glm::dvec3 v = glm::cross(n, u), origin{draw() * 1e6, draw() * 1e6, draw() * 1e6};
        Polygon polygon =
            i % 2 ? star(random, 3 + i / 10) : with_collinear(comb(random, 2 + i / 20));
        double extent = 0;
        for (glm::vec3& p : polygon) {
            extent = std::max({extent, std::abs(double{p.x}), std::abs(double{p.y})});
            p = glm::vec3{origin + double{p.x} * u + double{p.y} * v};
        }
        // Rounded to float, the outline is off by this much.
        expect_tiling(polygon, n, (1e6 + extent) * 6e-7 * extent);
        if (HasFatalFailure()) FAIL() << i;
    }
}

TEST(Triangulate, TilesOutlinesThatTouchThemselves) {
    // A hole joined to the outline by a pair of edges, all the ways round.
    Polygon keyhole =
        flat({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}});
    // Two holes at one corner.
    Polygon two = flat({{0, 0},
                        {9, 0},
                        {9, 9},
                        {0, 9},
                        {0, 0},
                        {1, 2},
                        {1, 6},
                        {4, 5},
                        {1, 2},
                        {0, 0},
                        {2, 1},
                        {4, 4},
                        {5, 1},
                        {2, 1}});
    // A hole joined by a bent pair of edges.
    Polygon bent = flat({{0, 0},
                         {9, 0},
                         {9, 9},
                         {0, 9},
                         {0, 0},
                         {1, 3},
                         {3, 4},
                         {3, 6},
                         {6, 6},
                         {6, 3},
                         {3, 4},
                         {1, 3}});
    // A hole that touches one corner of the outline and is joined to another.
    Polygon touching =
        flat({{0, 0}, {4, 0}, {3, 2}, {0, 0}, {2, 3}, {3, 2}, {4, 0}, {4, 4}, {0, 4}});
    // Two squares that share a corner. Here and above two triangles have no area.
    Polygon pinched = flat({{0, 0}, {2, 0}, {2, 2}, {4, 2}, {4, 4}, {2, 4}, {2, 2}, {0, 2}});
    for (Polygon* polygon : {&keyhole, &two, &bent, &touching, &pinched}) {
        for (std::size_t i = 0; i < polygon->size(); ++i) {
            expect_tiling(*polygon, kUp, polygon == &pinched || polygon == &touching ? 1e-9 : 0);
            if (HasFatalFailure()) FAIL() << polygon->size() << " from " << i;
            std::rotate(polygon->begin(), polygon->begin() + 1, polygon->end());
        }
    }
}

TEST(Triangulate, TilesOutlinesThatRepeatCornersOrRunBack) {
    Random random(4);
    for (int i = 0; i < 400; ++i) {
        Polygon polygon =
            i % 2 ? star(random, 3 + i % 20) : with_collinear(comb(random, 1 + i % 10));
        for (int changes = pick(random, 1, 4); changes > 0; --changes) {
            const auto at = polygon.begin() + pick(random, 0, static_cast<int>(polygon.size()) - 1);
            const glm::vec3 corner = *at;
            const glm::vec3 before = at == polygon.begin() ? polygon.back() : *(at - 1);
            const auto between = [&](float part) { return before + part * (corner - before); };
            switch (pick(random, 0, 2)) {
                case 0:
                    polygon.insert(at, corner);
                    break;
                case 1:
                    polygon.insert(at, {corner, between(0.5f)});
                    break;  // a spike
                default:
                    polygon.insert(at, {between(0.75f), between(0.25f)});
                    break;
            }
        }
        expect_tiling(polygon, kUp, 1e-9);
        if (HasFatalFailure()) FAIL() << i;
    }
}

// No tiling exists where a corner touches an edge from inside; the harm stays small.
TEST(Triangulate, StaysCloseToOutlinesThatTouchTheirEdges) {
    Random random(6);
    for (int i = 0; i < 2000; ++i) {
        Polygon polygon = comb(random, 12);
        for (int moves = pick(random, 1, 6); moves > 0; --moves) {
            glm::vec3& corner = polygon[static_cast<std::size_t>(pick(random, 3, 47))];
            if (corner.y == 0) {
                corner.y = -10;
            } else {
                corner.x += static_cast<float>(2 * pick(random, 0, 1));
            }
        }
        double sum = 0, area = 0;
        bake::Triangulator triangulator;
        for (const Triangle& t : triangulator.triangulate(polygon)) {
            const double part = area_about(polygon[t[0]], polygon[t[1]], polygon[t[2]], kUp);
            sum += std::abs(part);
            area += part;
        }
        EXPECT_LT(sum, 1.15 * area) << i;
    }
}

TEST(Triangulate, CutsAQuadAlongTheInnerElseTheShorterDiagonal) {
    bake::Triangulator triangulator;
    const auto has_edge = [&](const Polygon& quad, std::uint32_t a, std::uint32_t b) {
        const auto triangles = triangulator.triangulate(quad);
        return std::all_of(triangles.begin(), triangles.end(), [&](const Triangle& t) {
            return std::count(t.begin(), t.end(), a) == 1 && std::count(t.begin(), t.end(), b) == 1;
        });
    };
    EXPECT_TRUE(has_edge(flat({{0, 0}, {3, -1}, {4, 4}, {0, 3}}), 1, 3));
    EXPECT_TRUE(has_edge(flat({{3, -1}, {4, 4}, {0, 3}, {0, 0}}), 0, 2));
    // An arrowhead: the inner diagonal is the longer one from tip to notch, or a short one.
    EXPECT_TRUE(has_edge(flat({{0, 0}, {1, -2}, {10, 0}, {1, 2}}), 1, 3));
    Polygon dart = flat({{0, 0}, {-2, -3}, {10, 0}, {-2, 3}});
    for (std::uint32_t i = 0; i < 4; ++i) {
        EXPECT_TRUE(has_edge(dart, (4 - i) % 4, (6 - i) % 4)) << i;
        expect_tiling(dart, kUp, 0);
        std::rotate(dart.begin(), dart.begin() + 1, dart.end());
    }
    // One corner between its neighbours.
    expect_tiling(flat({{0, 0}, {1, 0}, {2, 0}, {1, 1}}), kUp, 0);
    expect_tiling(flat({{1, 0}, {2, 0}, {1, 1}, {0, 0}}), kUp, 0);
}

TEST(Triangulate, ConnectsTheCornersOfAnythingElse) {
    Random random(5);
    bake::Triangulator triangulator;
    for (int i = 0; i < 500; ++i) {
        Polygon polygon(static_cast<std::size_t>(pick(random, 3, 40)));
        const int range = pick(random, 0, 6);
        for (glm::vec3& p : polygon) {
            p = glm::vec3(pick(random, 0, range), pick(random, 0, range), pick(random, 0, range));
        }
        const auto triangles = triangulator.triangulate(polygon);
        ASSERT_EQ(triangles.size(), polygon.size() - 2);
        std::vector<bool> used(polygon.size());
        for (const Triangle& t : triangles) {
            ASSERT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
            for (const std::uint32_t corner : t) used.at(corner) = true;
        }
        ASSERT_EQ(std::count(used.begin(), used.end(), false), 0);
    }
}

}  // namespace
