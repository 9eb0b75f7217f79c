// Vertices as a compressed file holds them: they come back as they were, whatever they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "mesh-format/file.h"
#include "mesh-format/tangent_frame.h"
#include "mesh-format/vertex_stream.h"
#include "random_triangles.h"
#include "surface_truth.h"

namespace {

using namespace mesh_format;
using Bytes = std::vector<std::byte>;
using Indices = std::vector<std::uint16_t>;

constexpr auto kModelCount = static_cast<int>(FrameModel::count);
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

std::vector<Neighbours> neighbours_of(const MeshRecord& mesh, Indices indices) {
    std::vector<Neighbours> neighbours(mesh.vertex_count);
    encode_indices(indices, neighbours);
    return neighbours;
}

std::vector<Place> places_of(const MeshRecord& mesh, const Bytes& vertices) {
    const VertexLayout layout = vertex_layout(mesh.forms);
    std::vector<Place> places;
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        std::uint16_t numbers[kRowNumbers]{};
        std::memcpy(numbers, &vertices[v * layout.stride], 6);
        std::memcpy(&numbers[3], &vertices[v * layout.stride + layout.uv_offset], 4);
        std::memcpy(&places.emplace_back(), numbers, sizeof numbers);
    }
    return places;
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

Bytes random_stream(const MeshRecord& mesh, int model, int shift, std::mt19937& random) {
    Bytes stream(vertex_stream_bytes(mesh));
    for (std::byte& byte : stream) byte = std::byte(random() & 0xFF);
    stream[0] = std::byte(model);
    stream[1] = std::byte(shift);
    stream[2] = std::byte(kMaxSurfaceShift - shift);
    return stream;
}

/// What one processor writes, every other reads.
TEST(VertexStream, IsTheSameOnEveryProcessor) {
    std::uint64_t sum = 0;
    for (const FrameForm form : {FrameForm::quat48, FrameForm::quat32}) {
        const MeshRecord mesh{.forms = {.frame = form}, .vertex_count = 400};
        std::mt19937 random(13);
        for (int model = 0; model < kModelCount; ++model)
            sum =
                sum * 31 + checksum(decoded(mesh, sheet(), random_stream(mesh, model, 3, random)));
    }
    EXPECT_EQ(sum, 612273574533554563u);
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
        for (int i = 0; i < 9 * (kModelCount + 1); ++i) {
            const int model = i % (kModelCount + 1);
            const int shift = i % (kMaxSurfaceShift + 3) - 1;
            const Bytes stream = random_stream(mesh, model, shift, random);
            Bytes vertices(std::size_t{mesh.vertex_count} * vertex_layout(forms).stride);
            const bool in_digits = forms.frame <= FrameForm::quat32;
            const bool quantised =
                forms.position == PositionForm::quantised && forms.uv == UvForm::quantised;
            const bool sound = model == 0 || (in_digits && quantised && model < kModelCount);
            Scratch scratch;
            EXPECT_EQ(decode_vertices(mesh, sheet(), neighbours_of(mesh, sheet()), stream.data(),
                                      vertices.data(), scratch),
                      sound && shift >= 0 && shift <= kMaxSurfaceShift);
        }
    }
}

/// A rough sheet whose frames are what its triangles, and UVs if it has any, suggest.
void expect_foreseen(FrameForm form, FrameModel model) {
    const bool has_uvs = model == FrameModel::surface || model == FrameModel::surface_by_angle;
    const Indices indices = sheet();
    const MeshRecord mesh{.forms = {.frame = form}, .vertex_count = kSide * kSide};
    const VertexLayout layout = vertex_layout(mesh.forms);
    Bytes vertices(std::size_t{mesh.vertex_count} * layout.stride);
    std::mt19937 random(11);
    for (std::uint16_t v = 0; v < mesh.vertex_count; ++v) {
        std::byte* const vertex = &vertices[v * std::size_t{layout.stride}];
        const std::uint16_t position[] = {std::uint16_t(1000 * (v % kSide) + random() % 300),
                                          std::uint16_t(1000 * (v / kSide) + random() % 300),
                                          std::uint16_t(random() % 2000)};
        std::memcpy(vertex, position, sizeof position);
        if (!has_uvs) continue;
        const std::uint16_t uv[] = {std::uint16_t(700 * (v % kSide) + random() % 200),
                                    std::uint16_t(30'000 - 900 * (v / kSide) + random() % 200)};
        std::memcpy(vertex + layout.uv_offset, uv, sizeof uv);
    }
    const std::vector<SurfaceTruth> truth =
        surface_truth(indices, places_of(mesh, vertices), model >= FrameModel::surface_by_angle);
    for (std::uint16_t v = 0; v < mesh.vertex_count; ++v) {
        TangentFrame frame{{1.0f, 0.0f, 0.0f}, {}, truth[v].is_mirrored ? -1.0f : 1.0f};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            frame.normal[axis] = static_cast<float>(truth[v].normal[axis]);
            if (has_uvs) frame.tangent[axis] = static_cast<float>(truth[v].tangent[axis]);
        }
        pack_frame(form, frame, &vertices[v * std::size_t{layout.stride} + layout.frame_offset]);
    }
    const Bytes stream = encoded(mesh, indices, vertices);
    EXPECT_EQ(stream[0], std::byte(model));
    // High bytes of the digits: nearly all within 127 of 16,383 in 45 degrees.
    const auto high = std::span(stream).last(std::size_t{3} * mesh.vertex_count);
    EXPECT_LE(std::ranges::count_if(high, [](std::byte byte) { return byte != std::byte{0}; }), 20);
    EXPECT_EQ(decoded(mesh, indices, stream), vertices);
}

TEST(VertexStream, FramesAreForeseen) {
    for (const FrameForm form : {FrameForm::quat48, FrameForm::quat32})
        for (int model = 1; model < kModelCount; ++model)
            expect_foreseen(form, static_cast<FrameModel>(model));
}

}  // namespace
