// What the mouse does in the picture.
#include <gtest/gtest.h>

#include "cw2/window/pointer.h"

namespace {

using cw2::MouseAction;
using cw2::MouseButton;
using cw2::Pointer;
using glm::vec2;

constexpr Pointer::Picture kWhole{.width = 200.0f, .divider = std::nullopt, .scale = 1.0f};
constexpr Pointer::Picture kSplit{.width = 200.0f, .divider = 0.5f, .scale = 1.0f};

constexpr MouseAction kPress{MouseButton::left, true};
constexpr MouseAction kRelease{MouseButton::left, false};
constexpr MouseAction kRightPress{MouseButton::right, true};
constexpr MouseAction kRightRelease{MouseButton::right, false};

TEST(Pointer, APressAndAReleaseAtOnePlaceAreAClickThere) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    EXPECT_FALSE(pointer.follow(kPress, at, kWhole).clicked);
    EXPECT_FALSE(pointer.follow({}, at, kWhole).clicked);
    const auto wishes = pointer.follow(kRelease, at + vec2(1.0f), kWhole);
    EXPECT_EQ(wishes.clicked, at);
    EXPECT_FALSE(wishes.divider);
    EXPECT_FALSE(pointer.follow({}, at, kWhole).clicked);
}

TEST(Pointer, WhatIsDraggedIsNoClick) {
    Pointer pointer;
    pointer.follow(kPress, {30.0f, 40.0f}, kWhole);
    EXPECT_FALSE(pointer.follow(kRelease, {60.0f, 40.0f}, kWhole).clicked);
}

TEST(Pointer, AReleaseWhosePressWasNotForThePictureIsNoClick) {
    Pointer pointer;
    EXPECT_FALSE(pointer.follow(kRelease, {30.0f, 40.0f}, kWhole).clicked);
}

TEST(Pointer, TheRightButtonTurnsAndNeverClicks) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    pointer.follow(kRightPress, at, kWhole);
    EXPECT_TRUE(pointer.turns());
    pointer.follow(kPress, at, kWhole);
    EXPECT_FALSE(pointer.follow(kRelease, at, kWhole).clicked);
    EXPECT_TRUE(pointer.turns());
    EXPECT_FALSE(pointer.follow(kRightRelease, at, kWhole).clicked);
    EXPECT_FALSE(pointer.turns());
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
