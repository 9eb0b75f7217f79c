// Chunks keep every triangle, stay within their limits, and bound what they hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "cw2-bake/geometry/chunk_split.h"
#include "cw2-bake/geometry/chunks.h"
#include "cw2-bake/geometry/coarse_split.h"
#include "cw2-bake/geometry/quantise.h"

namespace {

struct Sheet {
    bake::SourceScene source;
    bake::FramedTriangles framed;

    bake::FramedScene scene() const { return {source, framed}; }
    bake::ChunkedScene chunks(const bake::UvBudget& budget = {}) const {
        return bake::make_chunks(scene(), {&budget, 1});
    }
    bake::PackedGeometry packed(const bake::ChunkedScene& pieces,
                                const bake::UvBudget& budget = {}) const {
        return bake::quantise(
            scene(), pieces, {&budget, 1},
            {mesh_format::FrameForm::quat48, mesh_format::PositionForm::quantised});
    }
};

/// A wavy sheet of 2 * side^2 triangles; no two vertices share a position.
Sheet make_sheet(std::uint32_t side) {
    Sheet sheet;
    for (std::uint32_t y = 0; y <= side; ++y) {
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(side);
            const float v = static_cast<float>(y) / static_cast<float>(side);
            const auto vertex = static_cast<std::uint32_t>(sheet.framed.vertices.size());
            sheet.source.positions.emplace_back(u, 0.05f * std::sin(9.0f * u) * std::cos(7.0f * v),
                                                v);
            sheet.source.uvs.emplace_back(u, v);
            sheet.framed.vertices.push_back({{vertex, 0, vertex}, {1.0f, 0.0f, 0.0f, 1.0f}});
        }
    }
    sheet.source.normals = {{0.0f, 1.0f, 0.0f}};
    const std::uint32_t row = side + 1;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t y = 0; y < side; ++y) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * row + x;
            triangles.push_back({a, a + row, a + 1});
            triangles.push_back({a + 1, a + row, a + row + 1});
        }
    }
    // Far from any good order, so that only the cutting can bring neighbours together.
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(7));
    for (const auto& triangle : triangles) {
        for (const std::uint32_t vertex : triangle) sheet.framed.indices.push_back(vertex);
    }
    sheet.source.triangle_material.extend(triangles.size(), 0);
    sheet.source.materials.resize(1);
    return sheet;
}

/// The parts that halving all the triangles of a material comes to.
void halve_whole(std::span<const bake::CentredTriangle> triangles,
                 std::vector<std::vector<std::uint32_t>>& parts) {
    if (triangles.size() <= bake::CoarseParts::kMostTriangles) {
        for (parts.emplace_back(); const bake::CentredTriangle& triangle : triangles)
            parts.back().push_back(triangle.index);
        return;
    }
    std::vector<bake::CentredTriangle> halves(triangles.size());
    bake::halve(triangles, halves);
    halve_whole(std::span(halves).first(halves.size() / 2), parts);
    halve_whole(std::span(halves).subspan(halves.size() / 2), parts);
}

TEST(CoarseSplit, ComesToThePartsThatHalvingTheWholeComesTo) {
    Sheet sheet = make_sheet(700);
    const std::size_t count = sheet.framed.indices.size() / 3;
    sheet.source.materials.resize(4);
    // By turns, so that the large ones are of several runs; the last has nothing.
    bake::RunVector& material = sheet.source.triangle_material = {};
    for (std::uint32_t i = 0; material.size() < count; ++i)
        material.extend(std::min(count, material.size() + 1 + i * 1000), i % 7 == 0 ? 2 : i % 2);
    const bake::CoarseParts coarse = bake::split_coarsely(sheet.scene());
    std::size_t next = 0;
    for (std::uint32_t m = 0; m < 4; ++m) {
        std::vector<bake::CentredTriangle> triangles;
        for (std::uint32_t t = 0; t < count; ++t)
            if (material[t] == m) triangles.push_back({sheet.scene().centroid(t), t});
        if (triangles.empty()) continue;
        std::vector<std::vector<std::uint32_t>> parts;
        halve_whole(triangles, parts);
        for (const auto& part : parts) {
            const bake::CoarseParts::Part& own = coarse.parts.at(next++);
            EXPECT_EQ(own.material, m);
            const auto of_part = coarse.triangles_of(own);
            ASSERT_TRUE(std::ranges::equal(of_part, part)) << m;
        }
    }
    EXPECT_EQ(next, coarse.parts.size());
    EXPECT_GT(next, 3u);
}

using Point = std::array<float, 3>;
using Face = std::array<Point, 3>;

/// Triangles as positions, each starting at its smallest corner.
Face face_of(const bake::FramedScene& scene, std::array<std::uint32_t, 3> vertices) {
    Face face;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const glm::vec3& p = scene.position(vertices[corner]);
        face[corner] = {p.x, p.y, p.z};
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    return face;
}

TEST(Chunks, KeepEveryTriangleAndItsWinding) {
    const Sheet sheet = make_sheet(300);
    std::vector<Face> before, after;
    const auto& indices = sheet.framed.indices;
    for (std::size_t i = 0; i < indices.size(); i += 3)
        before.push_back(face_of(sheet.scene(), {indices[i], indices[i + 1], indices[i + 2]}));
    const auto pieces = sheet.chunks();
    for (const bake::ChunkedMesh& piece : pieces.meshes) {
        for (std::size_t i = 0; i < piece.indices.size(); i += 3) {
            after.push_back(face_of(sheet.scene(), {piece.vertices[piece.indices[i]],
                                                    piece.vertices[piece.indices[i + 1]],
                                                    piece.vertices[piece.indices[i + 2]]}));
        }
    }
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    EXPECT_EQ(before, after);
}

TEST(Chunks, StayWithinTheLimitsAndFollowEachOther) {
    const Sheet sheet = make_sheet(300);
    const auto pieces = sheet.chunks();
    EXPECT_EQ(pieces.meshes.size(), 2u);  // 90,601 vertices
    for (const bake::ChunkedMesh& piece : pieces.meshes) {
        EXPECT_LE(piece.vertices.size(), mesh_format::kMaxMeshVertices);
        std::uint32_t next = 0;
        for (const mesh_format::ChunkRecord& chunk : piece.chunks) {
            EXPECT_EQ(chunk.first_index, next);
            EXPECT_LE(chunk.index_count, 3 * mesh_format::kMaxChunkTriangles);
            EXPECT_GT(chunk.index_count, 0u);
            next += chunk.index_count;
        }
        EXPECT_EQ(next, piece.indices.size());
        std::uint32_t seen = 0;  // vertices are in the order of their first use
        for (const std::uint32_t index : piece.indices) {
            ASSERT_LE(index, seen);
            seen = std::max(seen, index + 1);
        }
        EXPECT_EQ(seen, piece.vertices.size());
    }
}

TEST(Chunks, AreTightInSpace) {
    // 180,000 triangles are halved nine times: chunks of 1/16 by 1/32 of the sheet.
    const Sheet sheet = make_sheet(300);
    const auto pieces = sheet.chunks();
    for (const bake::ChunkedMesh& piece : pieces.meshes) {
        for (const mesh_format::ChunkRecord& chunk : piece.chunks) {
            glm::vec3 low(1e9f), high(-1e9f);
            for (std::uint32_t i = 0; i < chunk.index_count; ++i) {
                const glm::vec3& p =
                    sheet.scene().position(piece.vertices[piece.indices[chunk.first_index + i]]);
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
            EXPECT_LT(high.x - low.x, 0.1f);
            EXPECT_LT(high.z - low.z, 0.1f);
        }
    }
}

TEST(Chunks, ShareAMeshOnlyWhere16BitsHoldTheirUvs) {
    Sheet sheet = make_sheet(100);
    for (glm::vec2& uv : sheet.source.uvs) uv *= 50.0f;  // a lattice of 1/4096 spans 16
    const bake::UvBudget budget{.texels = 1024};
    const auto pieces = sheet.chunks(budget);
    EXPECT_GT(pieces.meshes.size(), 10u);
    EXPECT_LT(pieces.meshes.size(), 40u);
    const auto packed = sheet.packed(pieces, budget);
    for (const mesh_format::MeshRecord& mesh : packed.meshes) {
        EXPECT_EQ(mesh.forms.uv, mesh_format::UvForm::quantised);
    }
    EXPECT_LE(packed.scene.uv_error, 0.125f);
}

TEST(Chunks, AreCutByUvWhereOneAloneWouldBeTooWide) {
    Sheet strip = make_sheet(10);  // 200 triangles, one chunk by their number
    for (glm::vec2& uv : strip.source.uvs) uv.x *= 100.0f;
    const bake::UvBudget budget{.texels = 1024};
    const auto pieces = strip.chunks(budget);
    const auto packed = strip.packed(pieces, budget);
    EXPECT_GE(packed.meshes.size(), 7u);
    for (const mesh_format::MeshRecord& mesh : packed.meshes) {
        EXPECT_EQ(mesh.forms.uv, mesh_format::UvForm::quantised);
    }
}

TEST(Chunks, SpheresHoldTheirVertices) {
    const Sheet sheet = make_sheet(100);
    const auto pieces = sheet.chunks();
    const bake::PackedGeometry packed = sheet.packed(pieces);
    std::size_t record = 0;
    for (const bake::ChunkedMesh& piece : pieces.meshes) {
        for (const mesh_format::ChunkRecord& chunk : piece.chunks) {
            const mesh_format::ChunkRecord& bounds = packed.chunks[record++];
            const glm::vec3 center(bounds.center[0], bounds.center[1], bounds.center[2]);
            for (std::uint32_t i = 0; i < chunk.index_count; ++i) {
                const glm::vec3& p =
                    sheet.scene().position(piece.vertices[piece.indices[chunk.first_index + i]]);
                EXPECT_LE(glm::distance(p, center), bounds.radius * 1.00001f);
            }
        }
    }
    EXPECT_EQ(record, packed.chunks.size());
}

TEST(Chunks, CamerasThatAConeRejectsSeeNoFrontFace) {
    const Sheet sheet = make_sheet(100);
    const auto pieces = sheet.chunks();
    const bake::PackedGeometry packed = sheet.packed(pieces);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> coordinate(-2.0f, 3.0f);
    int rejected = 0;
    for (int round = 0; round < 200; ++round) {
        const glm::vec3 camera(coordinate(random), coordinate(random), coordinate(random));
        std::size_t record = 0;
        for (const bake::ChunkedMesh& piece : pieces.meshes) {
            for (const mesh_format::ChunkRecord& chunk : piece.chunks) {
                const mesh_format::ChunkRecord& bounds = packed.chunks[record++];
                const glm::vec3 arm =
                    glm::vec3(bounds.center[0], bounds.center[1], bounds.center[2]) - camera;
                const glm::vec3 axis(bounds.cone_axis[0], bounds.cone_axis[1], bounds.cone_axis[2]);
                if (glm::dot(arm, axis) < bounds.cone_cutoff * glm::length(arm) + bounds.radius) {
                    continue;
                }
                ++rejected;
                for (std::uint32_t i = 0; i < chunk.index_count; i += 3) {
                    const auto corner = [&](std::uint32_t k) {
                        return sheet.scene().position(
                            piece.vertices[piece.indices[chunk.first_index + i + k]]);
                    };
                    const glm::vec3 normal =
                        glm::cross(corner(1) - corner(0), corner(2) - corner(0));
                    ASSERT_LE(glm::dot(normal, camera - corner(0)), 1e-9f);
                }
            }
        }
    }
    EXPECT_GT(rejected, 100);
}

}  // namespace
