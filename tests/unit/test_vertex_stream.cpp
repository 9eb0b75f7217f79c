// Vertices as a compressed file holds them: they come back as they were, whatever they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "mesh-format/file.h"
#include "mesh-format/tangent_frame.h"
#include "mesh-format/vertex_prediction.h"
#include "mesh-format/vertex_stream.h"
#include "random_triangles.h"

namespace {

using namespace mesh_format;
using Bytes = std::vector<std::byte>;
using Indices = std::vector<std::uint16_t>;

constexpr std::uint16_t kSide = 20;  // vertices along each side of a sheet

/// The triangles of a sheet of vertices, in the order of the vertices.
Indices sheet() {
    Indices indices;
    for (std::uint16_t y = 1; y < kSide; ++y) {
        for (std::uint16_t x = 1; x < kSide; ++x) {
            const auto d = static_cast<std::uint16_t>(y * kSide + x);
            const auto c = static_cast<std::uint16_t>(d - 1);
            const auto b = static_cast<std::uint16_t>(d - kSide);
            const auto a = static_cast<std::uint16_t>(b - 1);
            for (const std::uint16_t corner : {a, b, c, b, d, c}) indices.push_back(corner);
        }
    }
    return indices;
}

/// Bytes that are in no part of a vertex are 0.
Bytes random_vertices(const MeshRecord& mesh) {
    std::mt19937 random(5);
    const VertexLayout layout = vertex_layout(mesh.forms);
    Bytes vertices(std::size_t{mesh.vertex_count} * layout.stride);
    const auto fill = [&](std::byte* part, std::uint32_t size) {
        std::generate_n(part, size, [&] { return std::byte(random() & 0xFF); });
    };
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) {
        std::byte* const vertex = &vertices[std::size_t{i} * layout.stride];
        fill(vertex, position_bytes(mesh.forms.position));
        fill(vertex + layout.frame_offset, frame_bytes(mesh.forms.frame));
        fill(vertex + layout.uv_offset, uv_bytes(mesh.forms.uv));
        fill(vertex + layout.color_offset, color_bytes(mesh.forms.color));
    }
    return vertices;
}

std::vector<VertexForms> all_forms() {
    std::vector<VertexForms> all;
    for (const auto position : {PositionForm::quantised, PositionForm::f32})
        for (const auto frame :
             {FrameForm::quat48, FrameForm::quat32, FrameForm::half3, FrameForm::f32})
            for (const auto uv : {UvForm::quantised, UvForm::f32})
                for (const auto color : {ColorForm::none, ColorForm::rgba8})
                    all.push_back({position, frame, uv, color});
    return all;
}

std::vector<Neighbours> neighbours_of(const MeshRecord& mesh, const Indices& indices) {
    std::vector<Neighbours> neighbours(mesh.vertex_count);
    encode_indices(indices, neighbours);
    return neighbours;
}

Bytes encoded(const MeshRecord& mesh, const Indices& indices, const Bytes& vertices) {
    return encode_vertices(mesh, indices, neighbours_of(mesh, indices), vertices.data());
}

Bytes decoded(const MeshRecord& mesh, const Indices& indices, const Bytes& stream) {
    Bytes vertices(std::size_t{mesh.vertex_count} * vertex_layout(mesh.forms).stride);
    Scratch scratch;
    EXPECT_TRUE(decode_vertices(mesh, indices, neighbours_of(mesh, indices), stream.data(),
                                vertices.data(), scratch));
    return vertices;
}

TEST(VertexStream, AnyVerticesOfAnyFormComeBack) {
    for (const VertexForms& forms : all_forms()) {
        for (const std::uint32_t count : {1u, 2u, 400u}) {
            const MeshRecord mesh{.forms = forms, .vertex_count = count};
            const Bytes vertices = random_vertices(mesh);
            for (const Indices& indices :
                 {count < 400 ? Indices{} : sheet(), random_triangles(count, 700)}) {
                const Bytes stream = encoded(mesh, indices, vertices);
                EXPECT_EQ(stream.size(), vertex_stream_bytes(mesh));
                EXPECT_EQ(decoded(mesh, indices, stream), vertices);
            }
        }
    }
}

TEST(VertexStream, TheLargestMeshesComeBack) {
    const MeshRecord mesh{.vertex_count = kMaxMeshVertices};
    const Bytes vertices = random_vertices(mesh);
    const Indices indices = random_triangles(kMaxMeshVertices, 100'000);
    EXPECT_EQ(decoded(mesh, indices, encoded(mesh, indices, vertices)), vertices);
}

/// What one processor writes, every other reads.
TEST(VertexStream, IsTheSameOnEveryProcessor) {
    std::uint64_t sum = 0;
    for (const FrameForm form : {FrameForm::quat48, FrameForm::quat32}) {
        const MeshRecord mesh{.forms = {.frame = form}, .vertex_count = 400};
        Bytes stream(vertex_stream_bytes(mesh));
        std::mt19937 random(13);
        for (const int model : {0, 1, 2}) {
            for (std::byte& byte : stream) byte = std::byte(random() & 0xFF);
            stream[0] = std::byte(model);
            sum = sum * 31 + checksum(decoded(mesh, sheet(), stream));
        }
    }
    EXPECT_EQ(sum, 17454938545830013023u);
}

/// On a sheet of parallelograms all but its border is foreseen.
TEST(VertexStream, ParallelogramsLeaveNothingToSay) {
    for (const FrameForm form : {FrameForm::quat48, FrameForm::quat32}) {
        const MeshRecord mesh{.forms = {.frame = form}, .vertex_count = kSide * kSide};
        Bytes vertices(std::size_t{mesh.vertex_count} * vertex_layout(mesh.forms).stride);
        for (std::uint16_t v = 0; v < mesh.vertex_count; ++v) {
            const std::uint16_t position[] = {std::uint16_t(7 * (v % kSide) + 60'000),
                                              std::uint16_t(900 - 3 * (v / kSide)), 5};
            std::memcpy(&vertices[v * std::size_t{vertex_layout(mesh.forms).stride}], position,
                        sizeof position);
        }
        const Bytes stream = encoded(mesh, sheet(), vertices);
        const auto zeros = std::ranges::count(stream, std::byte{0});
        EXPECT_GT(zeros, static_cast<std::ptrdiff_t>(stream.size()) - 4 * kSide);
    }
}

TEST(VertexStream, AnyBytesBecomeVerticesOrAreRefused) {
    std::mt19937 random(7);
    for (const VertexForms& forms : all_forms()) {
        const MeshRecord mesh{.forms = forms, .vertex_count = 400};
        for (int i = 0; i < 20; ++i) {
            Bytes stream(vertex_stream_bytes(mesh));
            for (std::byte& byte : stream) byte = std::byte(random() & 0xFF);
            Bytes vertices(std::size_t{mesh.vertex_count} * vertex_layout(forms).stride);
            stream[0] = std::byte(i % 4);
            const bool in_digits = forms.frame <= FrameForm::quat32;
            const bool quantised = forms.position == PositionForm::quantised;
            const bool sound[] = {true, in_digits, in_digits && quantised, false};
            Scratch scratch;
            EXPECT_EQ(decode_vertices(mesh, sheet(), neighbours_of(mesh, sheet()), stream.data(),
                                      vertices.data(), scratch),
                      sound[i % 4]);
        }
    }
}

/// A bumpy sheet with normals or without UVs: what the models are for.
TEST(VertexStream, FramesAreForeseen) {
    const Indices indices = sheet();
    for (const FrameForm form : {FrameForm::quat48, FrameForm::quat32}) {
        const MeshRecord mesh{.forms = {.frame = form}, .vertex_count = kSide * kSide};
        const VertexLayout layout = vertex_layout(mesh.forms);
        Bytes vertices(std::size_t{mesh.vertex_count} * layout.stride);
        std::mt19937 random(11);
        for (std::uint16_t v = 0; v < mesh.vertex_count; ++v) {
            const std::uint16_t position[] = {std::uint16_t(1000 * (v % kSide)),
                                              std::uint16_t(1000 * (v / kSide)),
                                              std::uint16_t(random() % 2000)};
            std::memcpy(&vertices[v * std::size_t{layout.stride}], position, sizeof position);
        }
        std::vector<Normal> normals(mesh.vertex_count);
        sum_normals(indices, vertices.data(), layout.stride, normals);
        for (std::uint16_t v = 0; v < mesh.vertex_count; ++v) {
            const TangentFrame frame{
                {1.0f, 0.0f, 0.0f},
                {static_cast<float>(normals[v][0]), static_cast<float>(normals[v][1]),
                 static_cast<float>(normals[v][2])},
                -1.0f};
            pack_frame(form, frame,
                       &vertices[v * std::size_t{layout.stride} + layout.frame_offset]);
        }
        const Bytes stream = encoded(mesh, indices, vertices);
        EXPECT_EQ(stream[0], std::byte(FrameModel::x_tangent_of_positions));
        // The digits differ by one or two from what is expected.
        const auto digits = std::span(stream).last(std::size_t{6} * mesh.vertex_count);
        EXPECT_LE(std::ranges::max(digits), std::byte{8});
        EXPECT_EQ(decoded(mesh, indices, stream), vertices);
    }
}

}  // namespace
