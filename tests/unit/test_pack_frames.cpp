// Packing many frames is packing each, and the error that it tells is the one there is.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "mesh-format/tangent_frame.h"

namespace {

using mesh_format::FrameForm;
using mesh_format::TangentFrame;

constexpr FrameForm kForms[] = {FrameForm::quat48, FrameForm::quat32, FrameForm::half3,
                                FrameForm::f32};

std::vector<TangentFrame> random_frames(std::size_t count) {
    std::mt19937 random(1);
    std::normal_distribution<float> component;
    std::vector<TangentFrame> frames(count);
    for (TangentFrame& frame : frames) {
        for (int i = 0; i < 3; ++i) {
            frame.tangent[i] = component(random);
            frame.normal[i] = component(random);
        }
        frame.handedness = random() % 2 == 0 ? 1.0f : -1.0f;
    }
    return frames;
}

std::vector<std::byte> packed_one_by_one(FrameForm form, const std::vector<TangentFrame>& frames,
                                         std::size_t stride, std::vector<double>& degrees) {
    std::vector<std::byte> bytes(frames.size() * stride);
    for (std::size_t i = 0; i < frames.size(); ++i)
        degrees.push_back(mesh_format::pack_frame(form, frames[i], bytes.data() + i * stride));
    return bytes;
}

TEST(PackFrames, IsPackingEach) {
    constexpr std::size_t kStride = 19;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    std::vector<TangentFrame> frames = random_frames(1000);
    // Among the others, those that have no direction of their own.
    frames[3] = {{0, 0, 0}, {0, 0, 0}, 1};
    frames[20] = {{1, 2, 3}, {1, 2, 3}, -1};
    frames[21] = {{1, 0, 0}, {kInfinity, 0, 0}, 1};
    frames[50] = {{kInfinity, 0, 0}, {0, 1, 0}, 1};
    frames[51] = {{std::nanf(""), 0, 0}, {0, 1, 0}, 1};
    for (const FrameForm form : kForms) {
        for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 1000u}) {
            const std::vector<TangentFrame> some(frames.begin(),
                                                 frames.begin() + std::ptrdiff_t(count));
            std::vector<double> expected_degrees;
            const auto expected = packed_one_by_one(form, some, kStride, expected_degrees);
            std::vector<std::byte> bytes(count * kStride);
            std::vector<double> degrees(count);
            mesh_format::pack_frames(form, some, bytes.data(), kStride, degrees.data());
            EXPECT_EQ(bytes, expected);
            EXPECT_EQ(degrees, expected_degrees);
        }
    }
}

TEST(PackFrames, TellTheErrorThatDecodingFinds) {
    for (const FrameForm form : kForms) {
        for (const TangentFrame& frame : random_frames(2000)) {
            std::byte bytes[16], exact[16];
            const double degrees = mesh_format::pack_frame(form, frame, bytes);
            mesh_format::pack_frame(FrameForm::f32, frame, exact);
            const double found =
                mesh_format::frame_angle(mesh_format::unpack_frame(FrameForm::f32, exact),
                                         mesh_format::unpack_frame(form, bytes));
            EXPECT_NEAR(degrees, found, 3e-5);
        }
    }
}

}  // namespace
