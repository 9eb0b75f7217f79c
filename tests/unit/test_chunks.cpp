// Chunks keep every triangle, stay within their limits, and bound what they hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "cw2-bake/chunks.h"
#include "cw2-bake/quantise.h"

namespace {

/// A wavy sheet of 2 * side^2 triangles; no two vertices share a position.
bake::FramedMesh make_sheet(std::uint32_t side) {
    bake::FramedMesh mesh;
    for (std::uint32_t y = 0; y <= side; ++y) {
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(side);
            const float v = static_cast<float>(y) / static_cast<float>(side);
            mesh.positions.emplace_back(u, 0.05f * std::sin(9.0f * u) * std::cos(7.0f * v), v);
            mesh.normals.emplace_back(0.0f, 1.0f, 0.0f);
            mesh.uvs.emplace_back(u, v);
            mesh.tangents.emplace_back(1.0f, 0.0f, 0.0f, 1.0f);
        }
    }
    const std::uint32_t row = side + 1;
    for (std::uint32_t y = 0; y < side; ++y) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * row + x;
            for (const std::uint32_t index : {a, a + row, a + 1, a + 1, a + row, a + row + 1}) {
                mesh.indices.push_back(index);
            }
        }
    }
    // Far from any good order, so that only the cutting can bring neighbours together.
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    }
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(7));
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        mesh.indices[i] = triangles[i / 3][i % 3];
    }
    return mesh;
}

using Point = std::array<float, 3>;
using Face = std::array<Point, 3>;

/// The triangles as positions, each starting at its smallest corner, sorted.
void add_faces(const bake::FramedMesh& mesh, std::vector<Face>& faces) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        Face face;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const glm::vec3& p = mesh.positions[mesh.indices[i + corner]];
            face[corner] = {p.x, p.y, p.z};
        }
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        faces.push_back(face);
    }
}

TEST(Chunks, KeepEveryTriangleAndItsWinding) {
    const bake::FramedMesh sheet = make_sheet(300);
    std::vector<Face> before, after;
    add_faces(sheet, before);
    for (const bake::ChunkedMesh& piece : bake::make_chunks(sheet, {}))
        add_faces(piece.mesh, after);
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    EXPECT_EQ(before, after);
}

TEST(Chunks, StayWithinTheLimitsAndFollowEachOther) {
    const bake::FramedMesh sheet = make_sheet(300);
    const auto pieces = bake::make_chunks(sheet, {});
    EXPECT_EQ(pieces.size(), 2u);  // 90,601 vertices
    for (const bake::ChunkedMesh& piece : pieces) {
        EXPECT_LE(piece.mesh.positions.size(), mesh_format::kMaxMeshVertices);
        std::uint32_t next = 0;
        for (const bake::Chunk& chunk : piece.chunks) {
            EXPECT_EQ(chunk.first_index, next);
            EXPECT_LE(chunk.index_count, 3 * mesh_format::kMaxChunkTriangles);
            EXPECT_GT(chunk.index_count, 0u);
            next += chunk.index_count;
        }
        EXPECT_EQ(next, piece.mesh.indices.size());
        std::uint32_t seen = 0;  // vertices are in the order of their first use
        for (const std::uint32_t index : piece.mesh.indices) {
            ASSERT_LE(index, seen);
            seen = std::max(seen, index + 1);
        }
        EXPECT_EQ(seen, piece.mesh.positions.size());
    }
}

TEST(Chunks, AreTightInSpace) {
    // 180,000 triangles are halved nine times: chunks of 1/16 by 1/32 of the sheet.
    const bake::FramedMesh sheet = make_sheet(300);
    for (const bake::ChunkedMesh& piece : bake::make_chunks(sheet, {})) {
        for (const bake::Chunk& chunk : piece.chunks) {
            glm::vec3 low(1e9f), high(-1e9f);
            for (std::uint32_t i = 0; i < chunk.index_count; ++i) {
                const glm::vec3& p =
                    piece.mesh.positions[piece.mesh.indices[chunk.first_index + i]];
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
            EXPECT_LT(high.x - low.x, 0.1f);
            EXPECT_LT(high.z - low.z, 0.1f);
        }
    }
}

TEST(Chunks, ShareAMeshOnlyWhere16BitsHoldTheirUvs) {
    bake::FramedMesh sheet = make_sheet(100);
    for (glm::vec2& uv : sheet.uvs) uv *= 50.0f;  // a lattice of 1/4096 spans 16
    const bake::UvBudget budget{.texels = 1024};
    const auto pieces = bake::make_chunks(sheet, budget);
    EXPECT_GT(pieces.size(), 10u);
    EXPECT_LT(pieces.size(), 40u);
    const auto packed =
        bake::quantise(pieces, {&budget, 1},
                       {mesh_format::FrameForm::quat48, mesh_format::PositionForm::quantised});
    for (const mesh_format::MeshRecord& mesh : packed.meshes) {
        EXPECT_EQ(mesh.uv_form, mesh_format::UvForm::quantised);
    }
    EXPECT_LE(packed.scene.uv_error, 0.125f);
}

TEST(Chunks, AreCutByUvWhereOneAloneWouldBeTooWide) {
    bake::FramedMesh strip = make_sheet(10);  // 200 triangles, one chunk by their number
    for (glm::vec2& uv : strip.uvs) uv.x *= 100.0f;
    const bake::UvBudget budget{.texels = 1024};
    const auto pieces = bake::make_chunks(strip, budget);
    const auto packed =
        bake::quantise(pieces, {&budget, 1},
                       {mesh_format::FrameForm::quat48, mesh_format::PositionForm::quantised});
    EXPECT_GE(packed.meshes.size(), 7u);
    for (const mesh_format::MeshRecord& mesh : packed.meshes) {
        EXPECT_EQ(mesh.uv_form, mesh_format::UvForm::quantised);
    }
}

bake::PackedGeometry pack(const std::vector<bake::ChunkedMesh>& pieces) {
    const bake::UvBudget budget;
    return bake::quantise(pieces, {&budget, 1},
                          {mesh_format::FrameForm::quat48, mesh_format::PositionForm::quantised});
}

TEST(Chunks, SpheresHoldTheirVertices) {
    const auto pieces = bake::make_chunks(make_sheet(100), {});
    const bake::PackedGeometry packed = pack(pieces);
    std::size_t record = 0;
    for (const bake::ChunkedMesh& piece : pieces) {
        for (const bake::Chunk& chunk : piece.chunks) {
            const mesh_format::ChunkRecord& bounds = packed.chunks[record++];
            const glm::vec3 center(bounds.center[0], bounds.center[1], bounds.center[2]);
            for (std::uint32_t i = 0; i < chunk.index_count; ++i) {
                const glm::vec3& p =
                    piece.mesh.positions[piece.mesh.indices[chunk.first_index + i]];
                EXPECT_LE(glm::distance(p, center), bounds.radius * 1.00001f);
            }
        }
    }
    EXPECT_EQ(record, packed.chunks.size());
}

TEST(Chunks, CamerasThatAConeRejectsSeeNoFrontFace) {
    const auto pieces = bake::make_chunks(make_sheet(100), {});
    const bake::PackedGeometry packed = pack(pieces);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> coordinate(-2.0f, 3.0f);
    int rejected = 0;
    for (int round = 0; round < 200; ++round) {
        const glm::vec3 camera(coordinate(random), coordinate(random), coordinate(random));
        std::size_t record = 0;
        for (const bake::ChunkedMesh& piece : pieces) {
            for (const bake::Chunk& chunk : piece.chunks) {
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
                        return piece.mesh.positions[piece.mesh.indices[chunk.first_index + i + k]];
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
