// What the mouse does in the picture.
#include <gtest/gtest.h>

#include "cw2/window/pointer.h"

namespace {

using cw2::MouseAction;
using cw2::MouseButton;
using cw2::Pointer;
using glm::vec2;
using Grip = Pointer::Grip;

constexpr Pointer::Picture kWhole{.width = 200.0f, .divider = std::nullopt, .scale = 1.0f};
constexpr Pointer::Picture kSplit{.width = 200.0f, .divider = 0.5f, .scale = 1.0f};

constexpr MouseAction kPress{MouseButton::left, true};
constexpr MouseAction kRelease{MouseButton::left, false};
constexpr MouseAction kShiftPress{MouseButton::left, true, 0.0, true};
constexpr MouseAction kLightPress{MouseButton::left, true, 0.0, false, true};
constexpr MouseAction kMiddlePress{MouseButton::middle, true};
constexpr MouseAction kMiddleRelease{MouseButton::middle, false};
constexpr MouseAction kRightPress{MouseButton::right, true};
constexpr MouseAction kRightRelease{MouseButton::right, false};

MouseAction at_time(MouseAction action, double seconds) {
    action.seconds = seconds;
    return action;
}

TEST(Pointer, APressAndAReleaseAtOnePlaceAreAClickThere) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    EXPECT_FALSE(pointer.follow(kPress, at, kWhole).clicked);
    EXPECT_FALSE(pointer.follow({}, at, kWhole).clicked);
    const auto wishes = pointer.follow(kRelease, at + vec2(1.0f), kWhole);
    EXPECT_EQ(wishes.clicked, at);
    EXPECT_FALSE(wishes.divider);
    EXPECT_EQ(wishes.grip, Grip::nothing);
    EXPECT_FALSE(pointer.follow({}, at, kWhole).clicked);
}

TEST(Pointer, WhatWasDraggedIsNoClickThoughItComesBack) {
    Pointer pointer;
    pointer.follow(kPress, {30.0f, 40.0f}, kWhole);
    pointer.follow({}, {60.0f, 40.0f}, kWhole);
    EXPECT_FALSE(pointer.follow(kRelease, {30.0f, 40.0f}, kWhole).clicked);
}

TEST(Pointer, TheSecondOfTwoClicksInAShortTimeIsADoubleClick) {
    const vec2 at(30.0f, 40.0f);
    const auto clicks = [&](double pause, vec2 step, int count) {
        Pointer pointer;
        Pointer::Wishes wishes;
        for (int i = 0; i < count; ++i) {
            const vec2 place = at + static_cast<float>(i) * step;
            pointer.follow(at_time(kPress, i * pause), place, kWhole);
            wishes = pointer.follow(at_time(kRelease, i * pause), place, kWhole);
        }
        return wishes;
    };
    EXPECT_EQ(clicks(0.2, {0.0f, 0.0f}, 2).double_clicked, at);
    EXPECT_FALSE(clicks(0.2, {0.0f, 0.0f}, 2).clicked);
    EXPECT_TRUE(clicks(0.2, {0.0f, 0.0f}, 3).clicked);
    EXPECT_TRUE(clicks(0.2, {0.0f, 0.0f}, 4).double_clicked);
    EXPECT_FALSE(clicks(0.8, {0.0f, 0.0f}, 2).double_clicked);
    EXPECT_FALSE(clicks(0.2, {20.0f, 0.0f}, 2).double_clicked);
}

TEST(Pointer, AReleaseWhosePressWasNotForThePictureIsNoClick) {
    Pointer pointer;
    EXPECT_FALSE(pointer.follow(kRelease, {30.0f, 40.0f}, kWhole).clicked);
}

TEST(Pointer, EachButtonHasHoldOfItsOwn) {
    const std::pair<MouseAction, Grip> kGrips[] = {{kPress, Grip::orbit},
                                                   {kShiftPress, Grip::pan},
                                                   {kMiddlePress, Grip::pan},
                                                   {kLightPress, Grip::light},
                                                   {kRightPress, Grip::look}};
    for (const auto& [press, grip] : kGrips) {
        Pointer pointer;
        pointer.follow(press, {30.0f, 40.0f}, kWhole);
        EXPECT_EQ(pointer.grip(), grip);
        MouseAction release = press;
        release.pressed = false;
        pointer.follow(release, {30.0f, 40.0f}, kWhole);
        EXPECT_EQ(pointer.grip(), Grip::nothing);
    }
}

TEST(Pointer, ADragGivesAllOfItsWayAndNothingOfASteadyHand) {
    Pointer pointer;
    pointer.follow(kMiddlePress, {30.0f, 40.0f}, kWhole);
    EXPECT_EQ(pointer.follow({}, {33.0f, 40.0f}, kWhole).grip, Grip::nothing);
    const auto first = pointer.follow({}, {40.0f, 45.0f}, kWhole);
    EXPECT_EQ(first.grip, Grip::pan);
    EXPECT_EQ(first.drag, vec2(10.0f, 5.0f));
    EXPECT_EQ(pointer.follow({}, {41.0f, 45.0f}, kWhole).drag, vec2(1.0f, 0.0f));
    EXPECT_EQ(pointer.follow(kMiddleRelease, {41.0f, 40.0f}, kWhole).drag, vec2(0.0f, -5.0f));
    EXPECT_EQ(pointer.follow({}, {90.0f, 90.0f}, kWhole).grip, Grip::nothing);
}

TEST(Pointer, TheFirstButtonCountsUntilItIsLetGo) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    pointer.follow(kRightPress, at, kWhole);
    pointer.follow(kPress, at, kWhole);
    EXPECT_FALSE(pointer.follow(kRelease, at, kWhole).clicked);
    EXPECT_EQ(pointer.grip(), Grip::look);
    EXPECT_FALSE(pointer.follow(kRightRelease, at, kWhole).clicked);
    EXPECT_EQ(pointer.grip(), Grip::nothing);
}

TEST(Pointer, TheDividerFollowsTheCursorFromAPressOnItToTheRelease) {
    Pointer pointer;
    EXPECT_FALSE(pointer.follow({}, {100.0f, 5.0f}, kSplit).divider);
    EXPECT_EQ(pointer.follow(kPress, {103.0f, 5.0f}, kSplit).divider, 103.0f / 200.0f);
    EXPECT_EQ(pointer.follow({}, {50.0f, 9.0f}, kSplit).divider, 0.25f);
    EXPECT_EQ(pointer.follow({}, {-50.0f, 9.0f}, kSplit).divider, 0.0f);
    EXPECT_EQ(pointer.follow({}, {900.0f, 9.0f}, kSplit).divider, 1.0f);
    const auto end = pointer.follow(kRelease, {40.0f, 9.0f}, kSplit);
    EXPECT_EQ(end.divider, 0.2f);
    EXPECT_FALSE(end.clicked);
    EXPECT_EQ(end.grip, Grip::nothing);
    EXPECT_FALSE(pointer.follow({}, {50.0f, 9.0f}, kSplit).divider);
}

TEST(Pointer, OnlyAPressAtTheDividerTakesHoldOfIt) {
    for (const float x : {80.0f, 120.0f}) {
        Pointer pointer;
        pointer.follow(kPress, {x, 5.0f}, kSplit);
        EXPECT_FALSE(pointer.follow({}, {50.0f, 9.0f}, kSplit).divider);
    }
    Pointer pointer;
    pointer.follow(kPress, {100.0f, 5.0f}, kWhole);
    EXPECT_FALSE(pointer.follow({}, {50.0f, 9.0f}, kWhole).divider);
}

}  // namespace
