// Packed vertices decode to what they were within the stated errors, and without cracks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <span>

#include "cw2-bake/geometry/quantise.h"
#include "mesh-format/tangent_frame.h"

namespace {

using mesh_format::FrameForm;
using mesh_format::MeshRecord;
using mesh_format::PositionForm;
using mesh_format::UvForm;

/// A scene of meshes, each with a triangle for each three vertices.
struct Scene {
    bake::SourceScene source;
    bake::FramedTriangles framed;
    bake::ChunkedScene chunked;

    void add(const std::vector<glm::vec3>& positions, const std::vector<glm::vec2>& uvs) {
        bake::ChunkedMesh& mesh = chunked.meshes.emplace_back();
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const auto vertex = static_cast<std::uint32_t>(framed.vertices.size());
            source.positions.push_back(positions[i]);
            source.uvs.emplace_back(uvs[i].x, 1.0f - uvs[i].y);
            framed.vertices.push_back({{vertex, 0, vertex}, {1.0f, 0.0f, 0.0f, -1.0f}});
            mesh.vertices.push_back(vertex);
            chunked.indices.push_back(static_cast<std::uint16_t>(i));
            mesh.positions.add(positions[i]);
            mesh.uvs.add(uv(chunked.meshes.size() - 1, i));
        }
        mesh.chunks.push_back(
            {.first_index = 0, .index_count = static_cast<std::uint32_t>(positions.size())});
        std::span<std::uint16_t> rest = chunked.indices;
        for (bake::ChunkedMesh& each : chunked.meshes) {
            each.indices = rest.first(each.vertices.size());
            rest = rest.subspan(each.vertices.size());
        }
    }
    const glm::vec3& position(std::size_t mesh, std::size_t i) const {
        return bake::FramedScene{source, framed}.position(chunked.meshes[mesh].vertices[i]);
    }
    /// Which 1 - v may have rounded.
    glm::vec2 uv(std::size_t mesh, std::size_t i) const {
        return bake::FramedScene{source, framed}.uv(chunked.meshes[mesh].vertices[i]);
    }
    bake::PackedGeometry pack(const bake::UvBudget& budget = {},
                              const bake::QuantiseSettings& settings = {
                                  FrameForm::quat48, PositionForm::quantised}) const {
        return bake::quantise({source, framed}, chunked, {&budget, 1}, settings);
    }

    Scene() { source.normals = {{0.0f, 1.0f, 0.0f}}; }
    Scene(const std::vector<glm::vec3>& positions, const std::vector<glm::vec2>& uvs) : Scene() {
        add(positions, uvs);
    }
};

struct Decoded {
    float position[3];
    double uv[2];
};

/// By the specification in layout.h, in the arithmetic of a GPU: float products and sums.
Decoded decode(const bake::PackedGeometry& packed, const MeshRecord& mesh, std::size_t vertex) {
    const auto layout = mesh_format::vertex_layout(mesh.forms);
    const std::byte* at = packed.vertices.data() + mesh.vertex_offset + vertex * layout.stride;
    Decoded decoded{};
    if (mesh.forms.position == PositionForm::f32) {
        std::memcpy(decoded.position, at, sizeof decoded.position);
    } else {
        std::uint16_t q[3];
        std::memcpy(q, at, sizeof q);
        for (int axis = 0; axis < 3; ++axis) {
            decoded.position[axis] =
                static_cast<float>(mesh.origin[axis] + q[axis]) * packed.scene.position_step;
        }
    }
    if (mesh.forms.uv == UvForm::f32) {
        float uv[2];
        std::memcpy(uv, at + layout.uv_offset, sizeof uv);
        decoded.uv[0] = uv[0];
        decoded.uv[1] = uv[1];
    } else {
        std::uint16_t q[2];
        std::memcpy(q, at + layout.uv_offset, sizeof q);
        for (int axis = 0; axis < 2; ++axis) {
            decoded.uv[axis] =
                mesh.uv_origin[axis] + mesh.uv_step[axis] * static_cast<float>(q[axis]);
        }
    }
    return decoded;
}

std::vector<glm::vec3> random_points(std::mt19937& random, std::size_t count, glm::vec3 center,
                                     float extent) {
    std::uniform_real_distribution<float> offset(-0.5f * extent, 0.5f * extent);
    std::vector<glm::vec3> points(count);
    for (glm::vec3& point : points) {
        point = center + glm::vec3(offset(random), offset(random), offset(random));
    }
    return points;
}

std::vector<glm::vec2> random_uvs(std::mt19937& random, std::size_t count, float low, float high) {
    std::uniform_real_distribution<float> coordinate(low, high);
    std::vector<glm::vec2> uvs(count);
    for (glm::vec2& uv : uvs) uv = {coordinate(random), coordinate(random)};
    return uvs;
}

TEST(Quantise, ErrorsAreAsStatedAndWithinBudgetForAnySizeAndPlace) {
    std::mt19937 random(1);
    for (const float extent : {1e-6f, 0.01f, 1.0f, 77.0f, 1e5f}) {
        for (const float distance : {0.0f, 1.0f, 100.0f}) {
            const Scene scene(random_points(random, 300, glm::vec3(distance * extent), extent),
                              random_uvs(random, 300, -0.3f, 1.7f));
            const bake::UvBudget budget;
            const auto packed = scene.pack(budget);
            double position_error = 0.0;
            double uv_error = 0.0;
            for (std::size_t i = 0; i < 300; ++i) {
                const Decoded decoded = decode(packed, packed.meshes[0], i);
                double square = 0.0;
                for (int axis = 0; axis < 3; ++axis) {
                    const double error =
                        double{decoded.position[axis]} - scene.position(0, i)[axis];
                    EXPECT_LE(std::abs(error), extent / 65'535.0);
                    square += error * error;
                }
                position_error = std::max(position_error, std::sqrt(square));
                for (int axis = 0; axis < 2; ++axis) {
                    double error = decoded.uv[axis] - scene.uv(0, i)[axis];
                    error -= std::round(error);  // whole numbers may be taken away
                    uv_error = std::max(uv_error, std::abs(error) * budget.texels);
                }
            }
            EXPECT_NEAR(packed.scene.position_error, position_error, 1e-6 * position_error);
            EXPECT_NEAR(packed.scene.uv_error, uv_error, 1e-4);
            EXPECT_LE(uv_error, 0.125);
        }
    }
}

TEST(Quantise, EqualPositionsDecodeToEqualBitsInEveryMesh) {
    std::mt19937 random(2);
    const auto shared = random_points(random, 99, {3.0f, -5.0f, 0.7f}, 0.5f);
    Scene scene;
    for (int i = 0; i < 4; ++i) {
        auto points = random_points(random, 300, glm::vec3(static_cast<float>(i)), 9.0f);
        points.insert(points.end(), shared.begin(), shared.end());
        scene.add(points, random_uvs(random, points.size(), 0.0f, 1.0f));
    }
    const bake::UvBudget budget;
    const auto packed = scene.pack(budget);
    for (std::size_t i = 0; i < shared.size(); ++i) {
        const Decoded first = decode(packed, packed.meshes[0], 300 + i);
        for (const MeshRecord& mesh : packed.meshes) {
            const Decoded other = decode(packed, mesh, 300 + i);
            EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(first.position)),
                                           std::as_bytes(std::span(other.position))));
        }
    }
}

TEST(Quantise, BoundsHoldTheDecodedVerticesExactly) {
    std::mt19937 random(3);
    const Scene scene(random_points(random, 300, {1.0f, 2.0f, 3.0f}, 5.0f),
                      random_uvs(random, 300, 0.0f, 1.0f));
    const bake::UvBudget budget;
    const auto packed = scene.pack(budget);
    float low[3], high[3];
    for (std::size_t i = 0; i < 300; ++i) {
        const Decoded decoded = decode(packed, packed.meshes[0], i);
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] =
                i == 0 ? decoded.position[axis] : std::min(low[axis], decoded.position[axis]);
            high[axis] =
                i == 0 ? decoded.position[axis] : std::max(high[axis], decoded.position[axis]);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(packed.scene.bounds_min[axis], low[axis]);
        EXPECT_EQ(packed.scene.bounds_max[axis], high[axis]);
    }
}

TEST(Quantise, PointLikeMeshesKeepTheirPlace) {
    const Scene scene({{0.1f, 0.3f, 0.7f}, {0.1f, 0.3f, 0.7f}, {0.1f, 0.3f, 0.7f}},
                      {{0.5f, 0.25f}, {0.5f, 0.25f}, {0.5f, 0.25f}});
    const bake::UvBudget budget;
    const auto packed = scene.pack(budget);
    const Decoded decoded = decode(packed, packed.meshes[0], 1);
    EXPECT_FLOAT_EQ(decoded.position[0], 0.1f);
    EXPECT_FLOAT_EQ(decoded.position[1], 0.3f);
    EXPECT_FLOAT_EQ(decoded.position[2], 0.7f);
    EXPECT_EQ(decoded.uv[0], 0.5);
    EXPECT_EQ(decoded.uv[1], 0.25);
}

TEST(Quantise, UvsThatWouldMissTheirBudgetStayFloats) {
    std::mt19937 random(4);
    const auto points = random_points(random, 300, {}, 1.0f);
    const Scene scene(points, random_uvs(random, 300, 0.0f, 100.0f));
    for (const std::uint32_t texels : {64u, 2048u}) {
        const bake::UvBudget budget{.texels = texels};
        const auto packed = scene.pack(budget);
        EXPECT_EQ(packed.meshes[0].forms.uv, texels == 64 ? UvForm::quantised : UvForm::f32);
        EXPECT_LE(packed.scene.uv_error, 0.125f);
        for (std::size_t i = 0; i < 300; ++i) {
            EXPECT_NEAR(decode(packed, packed.meshes[0], i).uv[0], scene.uv(0, i).x, 0.13 / texels);
        }
    }
}

TEST(Quantise, ClampedUvsAreNotShifted) {
    const Scene scene({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                      {{5.0f, 5.0f}, {5.5f, 5.0f}, {5.0f, 5.5f}});
    const bake::UvBudget repeats, clamps{.shiftable = false};
    const auto shifted = scene.pack(repeats);
    const auto kept = scene.pack(clamps);
    EXPECT_EQ(decode(shifted, shifted.meshes[0], 1).uv[0], 0.5);
    EXPECT_EQ(decode(kept, kept.meshes[0], 1).uv[0], 5.5);
}

TEST(Quantise, FloatFormsAreExact) {
    std::mt19937 random(5);
    const Scene scene(random_points(random, 300, {9.0f, 1.0f, 4.0f}, 2.0f),
                      random_uvs(random, 300, -7.0f, 3.0f));
    const auto packed = scene.pack({}, {FrameForm::f32, PositionForm::f32});
    for (std::size_t i = 0; i < 300; ++i) {
        const Decoded decoded = decode(packed, packed.meshes[0], i);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(decoded.position[axis], scene.position(0, i)[axis]);
        }
        EXPECT_EQ(decoded.uv[1], double{scene.uv(0, i).y});
    }
    EXPECT_EQ(packed.scene.position_error, 0.0f);
    EXPECT_EQ(packed.scene.uv_error, 0.0f);
}

TEST(Quantise, BytesBetweenMeshesAreZero) {
    std::mt19937 random(9);
    Scene scene;
    for (const std::size_t count : {3u, 9u, 15u})
        scene.add(random_points(random, count, glm::vec3(0.0f), 1.0f),
                  random_uvs(random, count, 0.0f, 1.0f));
    // What the allocator is likely to hand out next.
    for (std::size_t size = 16; size < 1024; size += 16)
        std::fill_n(std::make_unique<std::byte[]>(size).get(), size, std::byte{0xFF});
    const auto packed = scene.pack({}, {FrameForm::quat32, PositionForm::quantised});
    for (std::size_t i = 0; i < packed.meshes.size(); ++i) {
        const MeshRecord& mesh = packed.meshes[i];
        const auto stride = mesh_format::vertex_layout(mesh.forms).stride;
        const std::size_t end = i + 1 < packed.meshes.size() ? packed.meshes[i + 1].vertex_offset
                                                             : packed.vertices.size();
        std::size_t at = mesh.vertex_offset + mesh.vertex_count * stride;
        EXPECT_EQ(end - at, 2u);
        for (; at < end; ++at) EXPECT_EQ(packed.vertices[at], std::byte{0});
    }
}

TEST(Quantise, ColoursLieBehindTheUvsOfMeshesThatHaveAny) {
    Scene scene({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0}, {1, 0}, {0, 1}});
    scene.add({{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}, {{0, 0}, {1, 0}, {0, 1}});
    constexpr std::uint32_t kWhite = 0xFFFF'FFFF;
    const std::uint32_t colors[] = {kWhite, 0x8040'20FF, 0x0102'0304};
    for (const std::uint32_t color : colors) scene.framed.colors.push_back(color);
    for (int i = 0; i < 3; ++i) scene.framed.colors.push_back(kWhite);
    for (const FrameForm form : {FrameForm::quat48, FrameForm::quat32, FrameForm::f32}) {
        const bake::PackedGeometry packed = scene.pack({}, {form, PositionForm::quantised});
        EXPECT_EQ(packed.meshes[1].forms.color, mesh_format::ColorForm::none);
        const MeshRecord& mesh = packed.meshes[0];
        ASSERT_EQ(mesh.forms.color, mesh_format::ColorForm::rgba8);
        const auto layout = mesh_format::vertex_layout(mesh.forms);
        for (std::size_t i = 0; i < 3; ++i) {
            std::uint32_t color = 0;
            std::memcpy(&color,
                        packed.vertices.data() + mesh.vertex_offset + i * layout.stride +
                            layout.color_offset,
                        sizeof color);
            EXPECT_EQ(color, colors[i]);
        }
    }
}

}  // namespace
