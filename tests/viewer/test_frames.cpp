// Turntables: which frames, what their files are called, and what they show.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "cw2/render/frames.h"

namespace {

using namespace cw2;

TEST(Frames, RangesAreReadWholeOrNotAtAll) {
    EXPECT_EQ(frame_range_of("1"), (FrameRange{0, 0, 1}));
    EXPECT_EQ(frame_range_of("120"), (FrameRange{0, 119, 120}));
    EXPECT_EQ(frame_range_of("0..0/1"), (FrameRange{0, 0, 1}));
    EXPECT_EQ(frame_range_of("30..59/120"), (FrameRange{30, 59, 120}));
    EXPECT_EQ(frame_range_of("1000000"), (FrameRange{0, 999'999, 1'000'000}));
    for (const char* text : {"",           "0",
                             "-1",         "+1",
                             " 1",         "1 ",
                             "1.5",        "x",
                             "1000001",    "99999999999",
                             "1..",        "1../3",
                             "..2/3",      "1..2",
                             "1..2/",      "1..2/2",
                             "2..1/3",     "0..0/0",
                             "1..2/3/4",   "1...2/3",
                             "4294967295", "0..1/4294967297"}) {
        EXPECT_EQ(frame_range_of(text), std::nullopt) << text;
    }
}

TEST(Frames, PatternsHaveOnePlaceForTheNumber) {
    EXPECT_EQ(frame_name("a_%04d.png", 7), "a_0007.png");
    EXPECT_EQ(frame_name("a_%04d.png", 12345), "a_12345.png");
    EXPECT_EQ(frame_name("%d.exr", 0), "0.exr");
    EXPECT_EQ(frame_name("100%%/%d.png", 42), "100%/42.png");
    EXPECT_EQ(frame_name("%020d", 3), "00000000000000000003");
    for (const char* pattern :
         {"", "a.png", "%", "%%d", "%s.png", "%4d.png", "%-4d.png", "%04x.png", "%0d.png",
          "%d_%d.png", "%d%", "%099999999999d.png", "%021d.png", "%04", "%d%n"}) {
        EXPECT_EQ(frame_name(pattern, 7), std::nullopt) << pattern;
    }
}

const Bounds kBounds{{1.0f, 2.0f, 3.0f}, 5.0f};

FrameSettings start() {
    FrameSettings settings;
    settings.camera = {{4.0f, 3.0f, -1.0f}, {0.5f, 1.0f, 0.25f}, 1.0f};
    settings.light.position = {6.0f, 2.0f, 1.0f};
    return settings;
}

TEST(Frames, TheFirstFrameIsThePictureItself) {
    for (const Orbit what : {Orbit::camera, Orbit::light}) {
        const FrameSettings frame = at_frame(start(), what, 0, 12, kBounds);
        EXPECT_EQ(frame.camera.position, start().camera.position);
        EXPECT_EQ(frame.light.position, start().light.position);
    }
}

TEST(Frames, TheCameraGoesOnceAroundTheVerticalThroughItsTarget) {
    constexpr std::uint32_t kCount = 16;
    const Camera first = start().camera;
    double sum = 0.0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const FrameSettings frame = at_frame(start(), Orbit::camera, i, kCount, kBounds);
        const FrameSettings next = at_frame(start(), Orbit::camera, i + 1, kCount, kBounds);
        EXPECT_EQ(frame.light.position, start().light.position);
        EXPECT_EQ(frame.camera.target, first.target);
        EXPECT_EQ(frame.camera.position.y, first.position.y);
        EXPECT_NEAR(glm::distance(frame.camera.position, first.target),
                    glm::distance(first.position, first.target), 1e-5);
        const glm::dvec3 a(frame.camera.position - first.target);
        const glm::dvec3 b(next.camera.position - first.target);
        // Positive: x towards -z.
        const double turn = std::atan2(a.z * b.x - a.x * b.z, a.x * b.x + a.z * b.z);
        EXPECT_NEAR(turn, 2.0 * M_PI / kCount, 1e-5);
        sum += turn;
    }
    EXPECT_NEAR(sum, 2.0 * M_PI, 1e-4);
}

TEST(Frames, TheLightGoesOnceAroundItsOrbit) {
    for (std::uint32_t i = 0; i <= 10; ++i) {
        const FrameSettings frame = at_frame(start(), Orbit::light, i, 10, kBounds);
        const double angle = 2.0 * M_PI * i / 10.0;
        EXPECT_EQ(frame.camera.position, start().camera.position);
        EXPECT_NEAR(frame.light.position.x, 1.0 + 5.0 * std::cos(angle), 1e-5);
        EXPECT_NEAR(frame.light.position.y, 2.0 + 5.0 * std::sin(angle), 1e-5);
        EXPECT_NEAR(frame.light.position.z, 1.0, 1e-5);
    }
}

}  // namespace
