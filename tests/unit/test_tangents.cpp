// Tangents of small meshes whose answers follow by hand; tests/oracle compares with MikkTSpace.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/geometry/weld.h"

namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

constexpr vec3 kUp{0.0f, 0.0f, 1.0f};

struct Mesh {
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec2> uvs;
    std::vector<std::uint32_t> indices;

    std::uint32_t add(const vec3& position, const vec2& uv, const vec3& normal = kUp) {
        positions.push_back(position);
        normals.push_back(normal);
        uvs.push_back(uv);
        return static_cast<std::uint32_t>(positions.size() - 1);
    }
    /// One an index; those of `given` (one an index, zero for none) are kept.
    std::vector<vec4> tangents(const std::vector<vec4>& given = {}) const {
        bake::SourceScene scene;
        scene.tangents = given;
        scene.positions = positions;
        scene.normals = normals;
        scene.uvs = uvs;
        for (const std::uint32_t index : indices) scene.corners.push_back({index, index, index});
        scene.triangle_material.extend(indices.size() / 3, 0);
        scene.materials.resize(1);
        bake::FramedTriangles framed = bake::weld(scene, bake::FirstEqual(scene.positions));
        bake::add_tangents(scene, framed);
        std::vector<vec4> tangents;
        for (const std::uint32_t vertex : framed.indices)
            tangents.push_back(framed.vertices[vertex].tangent);
        return tangents;
    }
};

void expect_tangent(const vec4& tangent, const vec3& direction, float sign) {
    EXPECT_NEAR(glm::distance(vec3(tangent), direction), 0.0f, 1e-6f)
        << tangent.x << ' ' << tangent.y << ' ' << tangent.z;
    EXPECT_EQ(tangent.w, sign);
}

/// The unit square of the xy plane, two triangles; UVs by uv_of(position).
template <typename UvOf>
Mesh square(UvOf&& uv_of) {
    Mesh mesh;
    for (const vec3& p : {vec3(0, 0, 0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0)})
        mesh.add(p, uv_of(p));
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

TEST(Tangents, PointAlongUWithTheBitangentAlongV) {
    for (const vec4& t : square([](vec3 p) { return vec2(p); }).tangents())
        expect_tangent(t, vec3(1, 0, 0), 1.0f);
}

TEST(Tangents, OfMirroredUvsHaveTheOtherSign) {
    for (const vec4& t : square([](vec3 p) { return vec2(1.0f - p.x, p.y); }).tangents())
        expect_tangent(t, vec3(-1, 0, 0), -1.0f);
    for (const vec4& t : square([](vec3 p) { return vec2(p.x, -p.y); }).tangents())
        expect_tangent(t, vec3(1, 0, 0), -1.0f);
}

TEST(Tangents, TurnAgainstTheUvs) {
    for (int step = 0; step < 24; ++step) {
        const float angle = static_cast<float>(step) * std::numbers::pi_v<float> / 12.0f;
        const vec2 u(std::cos(angle), std::sin(angle));
        const vec2 v(-u.y, u.x);
        const Mesh mesh =
            square([&](vec3 p) { return 3.0f * vec2(glm::dot(u, vec2(p)), glm::dot(v, vec2(p))); });
        for (const vec4& t : mesh.tangents()) expect_tangent(t, vec3(u, 0.0f), 1.0f);
    }
}

TEST(Tangents, BitangentPointsAlongVForEitherHand) {
    for (const float hand : {1.0f, -1.0f}) {
        const Mesh mesh = square([&](vec3 p) { return vec2(hand * p.y, -p.x); });
        for (const vec4& t : mesh.tangents()) {
            const vec3 bitangent = t.w * glm::cross(kUp, vec3(t));
            EXPECT_NEAR(glm::distance(bitangent, vec3(-1, 0, 0)), 0.0f, 1e-6f);
            EXPECT_EQ(t.w, hand);
        }
    }
}

TEST(Tangents, SplitAtAMirroredSeamThoughTheVerticesAreShared) {
    Mesh mesh;
    for (const float y : {0.0f, 1.0f})
        for (const float x : {-1.0f, 0.0f, 1.0f}) mesh.add(vec3(x, y, 0), vec2(std::abs(x), y));
    mesh.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    const std::vector<vec4> tangents = mesh.tangents();
    for (std::size_t c = 0; c < 6; ++c) expect_tangent(tangents[c], vec3(-1, 0, 0), -1.0f);
    for (std::size_t c = 6; c < 12; ++c) expect_tangent(tangents[c], vec3(1, 0, 0), 1.0f);
}

TEST(Tangents, AverageByTheAngleOfTheFacesAtTheVertex) {
    // About the hub, 90 degrees with u = x, v = y and then 45 degrees with u = x, v = y - x, where
    // v is constant along (1, 1).
    Mesh mesh;
    const std::uint32_t hub = mesh.add(vec3(0, 0, 0), vec2(0, 0));
    mesh.add(vec3(1, 0, 0), vec2(1, 0));
    mesh.add(vec3(0, 1, 0), vec2(0, 1));
    mesh.add(vec3(-1, 1, 0), vec2(-1, 2));
    mesh.indices = {hub, 1, 2, hub, 2, 3};
    const float wide = std::numbers::pi_v<float> / 2.0f;
    const float narrow = std::numbers::pi_v<float> / 4.0f;
    const vec3 expected =
        glm::normalize(wide * vec3(1, 0, 0) + narrow * glm::normalize(vec3(1, 1, 0)));
    const std::vector<vec4> tangents = mesh.tangents();
    expect_tangent(tangents[0], expected, 1.0f);
    expect_tangent(tangents[3], expected, 1.0f);
    expect_tangent(tangents[1], vec3(1, 0, 0), 1.0f);
    expect_tangent(tangents[5], glm::normalize(vec3(1, 1, 0)), 1.0f);
}

TEST(Tangents, LieInThePlaneOfTheNormal) {
    Mesh mesh = square([](vec3 p) { return vec2(p); });
    const vec3 normal = glm::normalize(vec3(-1, 0, 2));
    for (vec3& n : mesh.normals) n = normal;
    for (const vec4& t : mesh.tangents()) expect_tangent(t, glm::normalize(vec3(2, 0, 1)), 1.0f);
}

TEST(Tangents, OfFacesThatShareOnlyAVertexAreNotAveraged) {
    Mesh mesh;
    const std::uint32_t hub = mesh.add(vec3(0, 0, 0), vec2(0, 0));
    mesh.add(vec3(1, 0, 0), vec2(1, 0));
    mesh.add(vec3(1, 1, 0), vec2(1, 1));
    mesh.add(vec3(-1, 0, 0), vec2(0, -1));
    mesh.add(vec3(-1, -1, 0), vec2(1, -1));
    mesh.indices = {hub, 1, 2, hub, 3, 4};
    const std::vector<vec4> tangents = mesh.tangents();
    expect_tangent(tangents[0], vec3(1, 0, 0), 1.0f);
    expect_tangent(tangents[3], vec3(0, -1, 0), 1.0f);
}

/// The corners of a triangle about the origin, at some height, turned by `turn` degrees; UVs are
/// its x and y turned by `uv_turn`.
std::uint32_t add_triangle_about_hub(Mesh& mesh, float height, float turn, float uv_turn) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int corner = 0; corner < 3; ++corner) {
        const float angle = glm::radians(120.0f * static_cast<float>(corner) + turn);
        const float uv_angle = angle + glm::radians(uv_turn);
        mesh.add(vec3(std::cos(angle), std::sin(angle), height),
                 vec2(std::cos(uv_angle), std::sin(uv_angle)));
    }
    return first;
}

TEST(Tangents, OfFansThatShareOnlyAVertexAreNotAveraged) {
    Mesh mesh;
    const std::uint32_t hub = mesh.add(vec3(0), vec2(0));
    const std::uint32_t a = add_triangle_about_hub(mesh, 0.0f, 0.0f, 0.0f);
    const std::uint32_t b = add_triangle_about_hub(mesh, 0.5f, 0.0f, 90.0f);
    for (const std::uint32_t rim : {a, b}) {
        for (std::uint32_t side = 0; side < 3; ++side)
            mesh.indices.insert(mesh.indices.end(), {hub, rim + side, rim + (side + 1) % 3});
    }
    const std::vector<vec4> tangents = mesh.tangents();
    for (std::size_t face = 0; face < 3; ++face) {
        expect_tangent(tangents[3 * face], vec3(1, 0, 0), 1.0f);
        expect_tangent(tangents[9 + 3 * face], vec3(0, -1, 0), 1.0f);
    }
}

TEST(Tangents, OfAThirdFaceAtAnEdgeAreItsOwn) {
    // Three faces close around the hub; a fourth one ends at an edge where two of them meet.
    Mesh mesh;
    const std::uint32_t hub = mesh.add(vec3(0), vec2(0));
    const std::uint32_t c = add_triangle_about_hub(mesh, 0.0f, 30.0f, 0.0f);
    const std::uint32_t b = c + 1;
    const std::uint32_t a = c + 2;
    const std::uint32_t d = mesh.add(vec3(0.5f, -1, 0), vec2(0.5f, -0.3f));
    mesh.indices = {hub, a, c, hub, b, a, hub, c, b, hub, d, c};
    const std::vector<vec4> tangents = mesh.tangents();
    for (std::size_t face = 0; face < 3; ++face)
        expect_tangent(tangents[3 * face], vec3(1, 0, 0), 1.0f);
    EXPECT_LT(tangents[9].y, -0.5f);
}

TEST(Tangents, OfAFaceWithoutUvAreaAreItsNeighbours) {
    // The middle one of three strips has one u for its whole width; its left and right borders
    // belong to faces of either hand.
    Mesh mesh;
    for (const float y : {0.0f, 1.0f}) {
        mesh.add(vec3(0, y, 0), vec2(0, y));
        mesh.add(vec3(1, y, 0), vec2(1, y));
        mesh.add(vec3(2, y, 0), vec2(1, y));
        mesh.add(vec3(3, y, 0), vec2(0, y));
    }
    mesh.indices = {0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6};
    const std::vector<vec4> tangents = mesh.tangents();
    // Face 2 meets the left half first, at its corner 1, and takes that hand; its corner at vertex
    // 2 touches only the right half, of the other hand, and stays without a group.
    expect_tangent(tangents[6], vec3(1, 0, 0), 1.0f);
    expect_tangent(tangents[8], vec3(1, 0, 0), -1.0f);
}

TEST(Tangents, OfADegenerateTriangleAreThoseOfAnotherFaceAtTheVertex) {
    Mesh mesh = square([](vec3 p) { return vec2(p.y, -p.x); });
    const std::uint32_t lonely = mesh.add(vec3(1, 0, 0), vec2(7, 7));
    mesh.indices.insert(mesh.indices.begin(), {1, 1, 2, 1, lonely, 2});
    const std::vector<vec4> tangents = mesh.tangents();
    for (const std::size_t c : {0u, 1u, 2u, 3u, 5u}) expect_tangent(tangents[c], vec3(0, 1, 0), 1);
    expect_tangent(tangents[4], vec3(1, 0, 0), -1.0f);
}

TEST(Tangents, WithoutUvsPointAlongX) {
    for (const vec4& t : square([](vec3) { return vec2(0.5f); }).tangents())
        expect_tangent(t, vec3(1, 0, 0), -1.0f);
}

TEST(Tangents, AreFiniteAndOfUnitLengthForNumbersAtTheEndsOfFloat) {
    for (const float size : {1e-38f, 1e-30f, 1e-20f, 1e20f, 1e30f, 3e38f}) {
        for (const float uv_size : {1e-38f, 1e-20f, 1.0f, 1e20f, 3e38f}) {
            Mesh mesh = square([&](vec3 p) { return uv_size * vec2(p.x, p.y - 0.25f * p.x); });
            for (vec3& p : mesh.positions) p = size * (p - vec3(0.5f));
            for (const vec4& t : mesh.tangents()) {
                EXPECT_NEAR(glm::length(vec3(t)), 1.0f, 1e-3f) << size << ' ' << uv_size;
                EXPECT_EQ(std::abs(t.w), 1.0f);
            }
        }
    }
}

TEST(Tangents, ThatTheSourceGivesAreKept) {
    const Mesh mesh = square([](vec3 p) { return vec2(p); });
    const vec4 own(0.0f, 1.0f, 0.0f, -1.0f);
    std::vector<vec4> given(6, vec4(0.0f));
    given[3] = own;
    const std::vector<vec4> tangents = mesh.tangents(given);
    for (std::size_t c = 0; c < 6; ++c)
        expect_tangent(tangents[c], c == 3 ? vec3(own) : vec3(1, 0, 0), c == 3 ? -1.0f : 1.0f);
}

TEST(Tangents, OfNoTrianglesAreNone) {
    EXPECT_TRUE(Mesh{}.tangents().empty());
}

TEST(Tangents, CornersOfOtherColoursAreOtherVerticesWithTheSameTangent) {
    bake::SourceScene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    scene.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene.normals = {kUp};
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) scene.corners.push_back({i, 0, i});
    scene.triangle_material.extend(2, 0);
    scene.materials.resize(1);
    const bake::FramedTriangles triangles = bake::weld(scene, bake::FirstEqual(scene.positions));
    bake::FramedTriangles plain = triangles;
    bake::add_tangents(scene, plain);
    EXPECT_EQ(plain.vertices.size(), 4u);
    EXPECT_TRUE(plain.colors.empty());

    // The two triangles agree at the first vertex and not at the third.
    scene.colors = {1, 2, 3, 1, 4, 5};
    bake::FramedTriangles colored = triangles;
    bake::add_tangents(scene, colored);
    ASSERT_EQ(colored.vertices.size(), 5u);
    ASSERT_EQ(colored.colors.size(), 5u);
    for (std::size_t i = 0; i < scene.colors.size(); ++i) {
        EXPECT_EQ(colored.colors[colored.indices[i]], scene.colors[i]);
        EXPECT_EQ(colored.vertices[colored.indices[i]].tangent,
                  plain.vertices[plain.indices[i]].tangent);
    }
}

}  // namespace
