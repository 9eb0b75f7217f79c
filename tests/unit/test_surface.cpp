// What triangles tell of frames: in integers nearly what it is in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "mesh-format/surface.h"
#include "mesh-format/tangent_frame.h"
#include "random_triangles.h"
#include "surface_truth.h"

namespace {

using namespace mesh_format;

/// Of a spread of at most `range` in each number.
std::vector<Place> random_places(std::uint32_t count, std::uint32_t range) {
    std::mt19937 random(19);
    std::vector<Place> places(count);
    for (Place& place : places)
        for (std::size_t k = 0; k < kRowNumbers; ++k)
            place[k] = static_cast<std::uint16_t>(65'535 - random() % range);
    return places;
}

/// The frames in both forms.
struct Frames {
    TangentFrame wide, narrow;
};

/// With UVs: there are two sums of each vertex.
std::vector<Frames> frames_of(const std::vector<Sum>& sums, bool has_uvs = true) {
    const std::size_t of_vertex = has_uvs ? 2 : 1;
    std::vector<Frames> frames;
    for (std::size_t i = 0; i + kFrameLanes <= sums.size() / of_vertex; i += kFrameLanes) {
        std::array<Words, 3> words;
        std::array<std::uint32_t, kFrameLanes> codes;
        expect_quat48(&sums[of_vertex * i], has_uvs, words);
        expect_quat32(&sums[of_vertex * i], has_uvs, codes);
        for (std::size_t lane = 0; lane < kFrameLanes; ++lane) {
            std::array<std::uint16_t, 3> code;
            for (std::size_t k = 0; k < 3; ++k)
                code[k] = words[k][lane / kRowNumbers][lane % kRowNumbers];
            frames.push_back(
                {unpack_frame(FrameForm::quat48, reinterpret_cast<const std::byte*>(code.data())),
                 unpack_frame(FrameForm::quat32,
                              reinterpret_cast<const std::byte*>(&codes[lane]))});
        }
    }
    return frames;
}

/// Of vectors of any length.
TangentFrame exact_frame(const std::array<double, 3>& normal, const std::array<double, 3>& tangent,
                         bool is_left_handed) {
    TangentFrame frame{{}, {}, is_left_handed ? -1.0f : 1.0f};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        frame.normal[axis] = static_cast<float>(normal[axis]);
        frame.tangent[axis] = static_cast<float>(tangent[axis]);
    }
    std::byte code[16];
    pack_frame(FrameForm::f32, frame, code);
    return unpack_frame(FrameForm::f32, code);
}

/// Triangles of all sizes, most of them oblique: nearly all frames are within a degree of the
/// truth, by angle within four.
void expect_nearly_the_truth(std::uint32_t range, bool by_angle) {
    constexpr std::uint32_t kCount = 320;
    const std::vector<Place> places = random_places(kCount, range);
    const auto indices = random_triangles(kCount, kCount);
    SurfaceModel model = fitting_model(indices, places.data(), true);
    model.by_angle = by_angle;
    std::vector<Sum> sums(2 * (kCount + kFrameLanes));
    sum_surfaces(indices, places.data(), model, sums);
    const std::vector<SurfaceTruth> truth = surface_truth(indices, places, by_angle);
    const std::vector<Frames> frames = frames_of(sums);
    const double most = by_angle ? 4 : 1;  // angles are within 0.7 degrees
    int far = 0;
    for (std::size_t v = 0; v < kCount; ++v) {
        const TangentFrame exact =
            exact_frame(truth[v].normal, truth[v].tangent, truth[v].is_mirrored);
        far += frame_angle(frames[v].wide, exact) > most;
        far += frame_angle(frames[v].narrow, exact) > most;
    }
    EXPECT_LE(far, static_cast<int>(kCount) / (by_angle ? 4 : 10)) << range << ' ' << by_angle;
}

TEST(Surface, IsNearlyTheTruth) {
    for (const std::uint32_t range : {60u, 3000u, 32'768u}) {
        expect_nearly_the_truth(range, false);
        expect_nearly_the_truth(range, true);
    }
}

TEST(Surface, WithoutTangentsIsAlongX) {
    for (const double y : {0.0, 0.3, -20.0}) {
        const Sum normal{1000, static_cast<std::int32_t>(1000 * y), 5000, 7};
        const TangentFrame exact = exact_frame({1000, 1000 * y, 5000}, {1, 0, 0}, false);
        std::vector<Sum> with_uvs(2 * kFrameLanes);
        with_uvs[6] = normal;
        EXPECT_LT(frame_angle(frames_of(with_uvs)[3].wide, exact), 0.1);
        std::vector<Sum> without(kFrameLanes);
        without[3] = normal;
        EXPECT_LT(frame_angle(frames_of(without, false)[3].wide, exact), 0.1);
        EXPECT_LT(frame_angle(frames_of(without, false)[3].narrow, exact), 0.3);
    }
}

/// Sums wrap around; whatever they are, they are a frame unless they are next to nothing, or one
/// along the other, or two components are nearly the largest: then an angle may be too large.
TEST(Surface, OfAnySumsIsAFrame) {
    std::mt19937 random(23);
    int checked = 0;
    int far = 0;
    constexpr std::int32_t kExtremes[] = {-2'147'483'647 - 1, 2'147'483'647, 0, 1, -1};
    for (int i = 0; i < 2000; ++i) {
        std::vector<Sum> sums(2 * kFrameLanes);
        const auto number = [&](bool is_extreme) {
            return is_extreme ? kExtremes[random() % 5] : static_cast<std::int32_t>(random());
        };
        for (std::size_t k = 0; k < sums.size(); ++k)
            for (std::int32_t& each : sums[k]) each = number(k % 2 == 0 ? i % 2 == 0 : i % 4 < 2);
        const std::vector<Frames> frames = frames_of(sums);
        for (std::size_t lane = 0; lane < kFrameLanes; ++lane) {
            const Sum& n = sums[2 * lane];
            const Sum& t = sums[2 * lane + 1];
            const std::array<double, 3> normal{double(n[0]), double(n[1]), double(n[2])};
            const std::array<double, 3> tangent{double(t[0]), double(t[1]), double(t[2])};
            const double along =
                std::inner_product(normal.begin(), normal.end(), tangent.begin(), 0.0);
            const double normal_size = std::hypot(normal[0], normal[1], normal[2]);
            const double tangent_size = std::hypot(tangent[0], tangent[1], tangent[2]);
            if (std::min(normal_size, tangent_size) < 1000 ||
                std::abs(along) > 0.98 * normal_size * tangent_size)
                continue;
            ++checked;
            const TangentFrame exact = exact_frame(normal, tangent, t[3] < 0);
            far += frame_angle(frames[lane].wide, exact) > 0.5;
            far += frame_angle(frames[lane].narrow, exact) > 0.8;
        }
    }
    EXPECT_GT(checked, 10'000);
    EXPECT_LT(far, checked / 1000);
}

}  // namespace
