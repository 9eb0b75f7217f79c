// What triangles tell of frames: in integers nearly what it is in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "mesh-format/surface.h"
#include "mesh-format/tangent_frame.h"
#include "random_triangles.h"
#include "surface_truth.h"

namespace {

using namespace mesh_format;

/// Of a spread of at most `range` in each number.
std::vector<Row> random_rows(std::uint32_t count, std::uint32_t range) {
    std::mt19937 random(19);
    std::vector<Row> rows(count);
    for (Row& row : rows)
        for (std::size_t k = 0; k < kRowNumbers; ++k)
            row[k] = static_cast<std::uint16_t>(65'535 - random() % range);
    return rows;
}

std::vector<Surface> surfaces_of(std::span<const std::uint16_t> indices,
                                 const std::vector<Row>& rows, bool by_angle) {
    std::vector<Surface> surfaces(rows.size() + Rotations::kCount);
    sum_surfaces(indices, rows.data(), {by_angle, true, fitting_area_shift(indices, rows.data())},
                 surfaces);
    return surfaces;
}

/// Of rotation k.
TangentFrame frame_of(const Rotations& rotations, std::size_t k) {
    float q[4];
    const bool is_negative = rotations.components[3][k] < 0;
    for (std::size_t c = 0; c < 4; ++c) {
        const auto component = static_cast<float>(rotations.components[c][k]);
        q[c] = (is_negative ? -component : component) / 32'768.0f;
    }
    if (rotations.tops[k] >= 4) q[3] = -q[3];  // left-handed
    return unpack_frame(FrameForm::f32, reinterpret_cast<const std::byte*>(q));
}

/// Triangles of all sizes, most of them oblique: nearly all frames are within a degree of the
/// truth.
TEST(Surface, IsNearlyTheTruth) {
    constexpr std::uint32_t kCount = 320;
    for (const std::uint32_t range : {60u, 3000u, 40'000u, 65'536u}) {
        const std::vector<Row> rows = random_rows(kCount, range);
        const auto indices = random_triangles(kCount, kCount);
        for (const bool by_angle : {false, true}) {
            const std::vector<Surface> surfaces = surfaces_of(indices, rows, by_angle);
            const std::vector<SurfaceTruth> truth = surface_truth(indices, rows, by_angle);
            int far = 0;
            for (std::size_t v = 0; v < kCount; ++v) {
                Rotations rotations;
                rotations_of(&surfaces[v / Rotations::kCount * Rotations::kCount], rotations);
                TangentFrame expected{};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    expected.normal[axis] = static_cast<float>(truth[v].normal[axis]);
                    expected.tangent[axis] = static_cast<float>(truth[v].tangent[axis]);
                }
                expected.handedness = truth[v].is_mirrored ? -1.0f : 1.0f;
                std::byte code[16];
                pack_frame(FrameForm::f32, expected, code);
                const TangentFrame frame = frame_of(rotations, v % Rotations::kCount);
                far += frame_angle(frame, unpack_frame(FrameForm::f32, code)) > 4;
            }
            EXPECT_LE(far, static_cast<int>(kCount) / 10) << range << ' ' << by_angle;
        }
    }
}

TEST(Surface, OfNothingIsARotation) {
    const std::vector<Surface> surfaces(Rotations::kCount);
    Rotations rotations;
    rotations_of(surfaces.data(), rotations);
    EXPECT_EQ(rotations.components[static_cast<std::size_t>(rotations.tops[0])][0], 32'768);
}

/// Sums wrap around; whatever they are, components are in range and the largest is 1.
TEST(Surface, OfAnySumsIsARotation) {
    std::mt19937 random(23);
    constexpr std::int32_t kExtremes[] = {-2'147'483'647 - 1, 2'147'483'647, 0, 1, -1};
    for (int i = 0; i < 2000; ++i) {
        std::array<Surface, Rotations::kCount> surfaces{};
        for (Surface& surface : surfaces) {
            for (std::size_t k = 0; k < 4; ++k) {
                surface.normal[k] = kExtremes[random() % 5];
                surface.tangent[k] =
                    i % 2 == 0 ? kExtremes[random() % 5] : static_cast<std::int32_t>(random());
            }
        }
        Rotations rotations;
        rotations_of(surfaces.data(), rotations);
        for (std::size_t lane = 0; lane < Rotations::kCount; ++lane) {
            const auto top = static_cast<std::uint32_t>(rotations.tops[lane]);
            ASSERT_LT(top, 8u);
            EXPECT_NEAR(rotations.components[top & 3u][lane], 32'768, 8);
            for (std::size_t k = 0; k < 4; ++k)
                ASSERT_LE(std::abs(rotations.components[k][lane]), 32'768);
        }
    }
}

}  // namespace
