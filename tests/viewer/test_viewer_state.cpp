// What the keys do to what the window shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "cw2/options/frame_of.h"
#include "cw2/window/viewer_state.h"

namespace {

using cw2::CommandKind;
using cw2::Input;
using cw2::ViewerState;

constexpr std::array kVertices{glm::vec3(3.0f, -1.0f, 10.0f), glm::vec3(3.0f, -1.0f, -6.0f)};
constexpr cw2::Bounds kBounds{{3.0f, -1.0f, 2.0f}, 8.0f, kVertices};
constexpr float kAspect = 1.5f;

Input command(CommandKind kind, cw2::View view = 0) {
    Input input;
    input.commands = {{kind, view}};
    return input;
}

Input flight(const glm::vec3& direction, float pace = 1.0f) {
    Input input;
    input.direction = direction;
    input.pace = pace;
    return input;
}

cw2::Options options_at(double time) {
    cw2::Options options;
    options.time = time;
    return options;
}

struct Viewer {
    ViewerState state{options_at(0.7), kBounds, kAspect};

    bool apply(const Input& input, double seconds = 0.0) {
        return state.apply(input, seconds, kAspect);
    }
    glm::vec3 light() const { return state.settings().light.position; }
    cw2::Camera camera() const { return state.settings().camera; }
};

glm::vec3 light_after(double seconds) {
    const cw2::Camera camera = Viewer().camera();
    return cw2::orbit(cw2::default_light_position(kBounds, camera), kBounds.center, seconds);
}

/// How far the camera goes in one second of `steps` equal frames; the first one counts little.
float distance_flown(const Input& input, int steps) {
    Viewer viewer;
    viewer.apply(input, 0.0);
    const glm::vec3 start = viewer.camera().position;
    for (int i = 0; i < steps; ++i) viewer.apply(input, 1.0 / steps);
    return glm::distance(start, viewer.camera().position);
}

TEST(ViewerState, BeginsAsHeadlessDoes) {
    const Viewer viewer;
    const auto expected = cw2::frame_settings(options_at(0.7), kBounds, kAspect);
    EXPECT_EQ(viewer.camera().position, expected.camera.position);
    EXPECT_EQ(viewer.camera().target, expected.camera.target);
    EXPECT_EQ(viewer.light(), light_after(0.7));
}

TEST(ViewerState, TheLightMovesOnlyBetweenTwoSpacesAndGoesOnWhereItStopped) {
    Viewer viewer;
    EXPECT_FALSE(viewer.apply({}, 5.0));
    EXPECT_EQ(viewer.light(), light_after(0.7));
    viewer.apply(command(CommandKind::toggle_light), 3.0);
    EXPECT_EQ(viewer.light(), light_after(0.7));
    EXPECT_TRUE(viewer.apply({}, 0.5));
    EXPECT_EQ(viewer.light(), light_after(0.7 + 0.5));
    viewer.apply(command(CommandKind::toggle_light), 0.25);
    EXPECT_FALSE(viewer.apply({}, 9.0));
    EXPECT_EQ(viewer.light(), light_after(0.7 + 0.5 + 0.25));
    viewer.apply(command(CommandKind::toggle_light));
    viewer.apply({}, 0.125);
    EXPECT_EQ(viewer.light(), light_after(0.7 + 0.5 + 0.25 + 0.125));
}

TEST(ViewerState, NextViewMeetsEveryViewAndPreviousGoesBack) {
    Viewer viewer;
    for (cw2::View view = 1; view <= cw2::kViews.size(); ++view) {
        EXPECT_TRUE(viewer.apply(command(CommandKind::next_view)));
        EXPECT_EQ(viewer.state.settings().view, view % cw2::kViews.size());
    }
    viewer.apply(command(CommandKind::previous_view));
    EXPECT_EQ(viewer.state.settings().view, cw2::kViews.size() - 1);
    viewer.apply(command(CommandKind::show_view, 4));
    EXPECT_EQ(viewer.state.settings().view, 4u);
}

TEST(ViewerState, NormalMapAndAlphaMaskAreSwitchedEachByItsKey) {
    Viewer viewer;
    EXPECT_TRUE(viewer.apply(command(CommandKind::toggle_normal_map)));
    EXPECT_FALSE(viewer.state.settings().normal_map);
    EXPECT_TRUE(viewer.state.settings().alpha_mask);
    EXPECT_TRUE(viewer.apply(command(CommandKind::toggle_alpha_mask)));
    EXPECT_FALSE(viewer.state.settings().alpha_mask);
    viewer.apply(command(CommandKind::toggle_normal_map));
    EXPECT_TRUE(viewer.state.settings().normal_map);
}

TEST(ViewerState, TwoSidedIsSwitchedByItsKey) {
    Viewer viewer;
    EXPECT_FALSE(viewer.state.settings().materials.two_sided);
    EXPECT_TRUE(viewer.apply(command(CommandKind::toggle_two_sided)));
    EXPECT_TRUE(viewer.state.settings().materials.two_sided);
}

TEST(ViewerState, TheLightGoesAboutTheAxisThatIsAskedFor) {
    for (const cw2::Axis axis : {cw2::Axis::x, cw2::Axis::y, cw2::Axis::z}) {
        cw2::Options options = options_at(1.0);
        options.light_position = glm::vec3(5.0f, 4.0f, 9.0f);
        options.orbit_axis = axis;
        const ViewerState state(options, kBounds, kAspect);
        const int along = static_cast<int>(axis), from = (along + 1) % 3, to = (along + 2) % 3;
        const glm::vec3 before = glm::vec3(*options.light_position) - kBounds.center;
        const glm::vec3 after = state.settings().light.position - kBounds.center;
        EXPECT_NEAR(after[along], before[along], 1e-5f);
        const float angle =
            std::atan2(after[to], after[from]) - std::atan2(before[to], before[from]);
        EXPECT_NEAR(std::remainder(angle - 1.0f, 6.2831853f), 0.0f, 1e-5f);
    }
}

TEST(ViewerState, ALightThatIsMovedStaysThereAndItsOrbitGoesOnFromThere) {
    Viewer viewer;
    const glm::vec3 there(4.0f, 5.0f, 6.0f);
    viewer.state.set_light(there);
    EXPECT_NEAR(glm::distance(viewer.light(), there), 0.0f, 1e-5f);
    viewer.apply(command(CommandKind::toggle_light));
    viewer.apply({}, 0.5);
    EXPECT_NEAR(glm::distance(viewer.light(), cw2::orbit(there, kBounds.center, 0.5)), 0.0f, 1e-5f);
}

TEST(ViewerState, FramingKeepsTheDirectionAndShowsEveryVertexAsNearAsItFits) {
    Viewer viewer;
    viewer.apply(flight({1.0f, 0.3f, -1.0f}), 2.0);
    const glm::dvec3 back = cw2::axes_of(viewer.camera()).back;
    EXPECT_TRUE(viewer.apply(command(CommandKind::frame_scene)));
    const cw2::Camera camera = viewer.camera();
    EXPECT_NEAR(glm::distance(cw2::axes_of(camera).back, back), 0.0, 1e-5);
    EXPECT_NEAR(glm::distance(camera.target, kBounds.center), 0.0f, 1e-5f);
    const glm::mat4 clip_from_world =
        cw2::clip_from_view(camera.vertical_fov, kAspect, cw2::near_distance(kBounds)) *
        cw2::view_from_world(camera);
    float farthest_out = 0.0f;
    for (const glm::vec3& vertex : kVertices) {
        const glm::vec4 clip = clip_from_world * glm::vec4(vertex, 1.0f);
        ASSERT_GT(clip.w, 0.0f);
        farthest_out =
            std::max({farthest_out, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
    }
    EXPECT_NEAR(farthest_out, 0.95f, 1e-3f);
}

TEST(ViewerState, ResetBringsBackTheExactCameraAndLight) {
    Viewer viewer;
    viewer.apply(command(CommandKind::toggle_light));
    Input input = flight({1.0f, -1.0f, 1.0f});
    input.drag = {40.0f, -70.0f};
    viewer.apply(input, 2.0);
    EXPECT_NE(viewer.camera().position, Viewer().camera().position);
    EXPECT_NE(viewer.camera().target, Viewer().camera().target);
    EXPECT_NE(viewer.light(), Viewer().light());
    EXPECT_TRUE(viewer.apply(command(CommandKind::reset)));
    EXPECT_EQ(viewer.camera().position, Viewer().camera().position);
    EXPECT_EQ(viewer.camera().target, Viewer().camera().target);
    EXPECT_EQ(viewer.light(), Viewer().light());
    EXPECT_FALSE(viewer.apply({}, 1.0)) << "the light still moves";
}

TEST(ViewerState, AKeyLetGoJustBeforeAResetDoesNotMoveTheCameraAfterIt) {
    Viewer viewer;
    Input input = flight({0.0f, 0.0f, 1.0f});
    input.commands = {{CommandKind::reset}};
    viewer.apply(input, 1.0);
    EXPECT_EQ(viewer.camera().position, Viewer().camera().position);
}

TEST(ViewerState, FliesAtTheSameSpeedWhateverTheFrameRate) {
    const Input forward = flight({0.0f, 0.0f, 1.0f});
    const float distance = distance_flown(forward, 1000);
    EXPECT_NEAR(distance, 0.25f * kBounds.radius, 1e-3f * kBounds.radius);
    EXPECT_NEAR(distance_flown(forward, 3), distance, 1e-3f * distance);
    EXPECT_NEAR(distance_flown(flight({1.0f, -1.0f, 0.0f}), 10), distance, 1e-3f * distance);
    EXPECT_NEAR(distance_flown(flight({-1.0f, 0.0f, 0.0f}, 4.0f), 10), 4.0f * distance,
                4e-3f * distance);
}

TEST(ViewerState, APressAfterALongPauseIsNoLeap) {
    Viewer viewer;
    const glm::vec3 start = viewer.camera().position;
    EXPECT_TRUE(viewer.apply(flight({0.0f, 0.0f, 1.0f}), 60.0));
    const float distance = glm::distance(start, viewer.camera().position);
    EXPECT_GT(distance, 0.0f);
    EXPECT_LT(distance, 0.01f * kBounds.radius);
}

TEST(ViewerState, CommandsAboutTheProgramLeaveThePictureAlone) {
    Viewer viewer;
    for (const CommandKind kind :
         {CommandKind::toggle_panel, CommandKind::reload_shaders, CommandKind::save_picture,
          CommandKind::save_window, CommandKind::save_settings, CommandKind::copy_camera,
          CommandKind::end}) {
        EXPECT_FALSE(viewer.apply(command(kind), 1.0));
    }
}

TEST(UserCoordinates, AreTheScenesOwnWithoutAnOrigin) {
    const glm::vec3 position(7.8f, -1e-7f, 12345.678f);
    const glm::dvec3 user = cw2::to_user(position, kBounds);
    EXPECT_EQ(user, glm::dvec3(7.8, -1e-7, 12345.678)) << "what people would type";
    EXPECT_EQ(cw2::from_user(user, kBounds), position);
}

TEST(UserCoordinates, KeepSmallDistancesFarFromTheOrigin) {
    cw2::Bounds far = kBounds;
    far.origin = {500'000.0, 4.0e6, -1.25};
    const glm::vec3 position(0.001f, 1.0f, -3.0f);
    const glm::dvec3 user = cw2::to_user(position, far);
    EXPECT_NEAR(user.x, 500'000.001, 1e-9);
    EXPECT_LT(glm::distance(cw2::from_user(user, far), position), 1e-9f);
}

}  // namespace
