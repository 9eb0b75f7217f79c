// What the mouse does in the picture.
#include <gtest/gtest.h>

#include <vector>

#include "cw2/pointer.h"

namespace {

using cw2::MouseAction;
using cw2::MouseButton;
using cw2::Pointer;
using glm::vec2;
using Actions = std::vector<MouseAction>;

constexpr Pointer::Picture kWhole{.width = 200.0f, .divider = std::nullopt, .scale = 1.0f};
constexpr Pointer::Picture kSplit{.width = 200.0f, .divider = 0.5f, .scale = 1.0f};

MouseAction press(MouseButton button, vec2 where) {
    return {button, true, where};
}
MouseAction release(MouseButton button, vec2 where) {
    return {button, false, where};
}

TEST(Pointer, APressAndAReleaseAtOnePlaceAreAClickThere) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    EXPECT_FALSE(pointer.follow(Actions{press(MouseButton::left, at)}, at, kWhole).clicked);
    EXPECT_FALSE(pointer.follow({}, at, kWhole).clicked);
    const auto wishes =
        pointer.follow(Actions{release(MouseButton::left, at + vec2(1.0f))}, at, kWhole);
    EXPECT_EQ(wishes.clicked, at);
    EXPECT_FALSE(wishes.divider);
    EXPECT_FALSE(pointer.follow({}, at, kWhole).clicked);
    // Both since the last look.
    const Actions both{press(MouseButton::left, at), release(MouseButton::left, at)};
    EXPECT_EQ(pointer.follow(both, at, kWhole).clicked, at);
}

TEST(Pointer, WhatIsDraggedIsNoClick) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f), there(60.0f, 40.0f);
    pointer.follow(Actions{press(MouseButton::left, at)}, at, kWhole);
    EXPECT_FALSE(pointer.follow(Actions{release(MouseButton::left, there)}, there, kWhole).clicked);
}

TEST(Pointer, AReleaseWhosePressWasNotForThePictureIsNoClick) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    EXPECT_FALSE(pointer.follow(Actions{release(MouseButton::left, at)}, at, kWhole).clicked);
}

TEST(Pointer, TheRightButtonTurnsAndNeverClicks) {
    Pointer pointer;
    const vec2 at(30.0f, 40.0f);
    pointer.follow(Actions{press(MouseButton::right, at)}, at, kWhole);
    EXPECT_TRUE(pointer.turns());
    const Actions left{press(MouseButton::left, at), release(MouseButton::left, at)};
    EXPECT_FALSE(pointer.follow(left, at, kWhole).clicked);
    EXPECT_TRUE(pointer.turns());
    pointer.follow(Actions{release(MouseButton::right, at)}, at, kWhole);
    EXPECT_FALSE(pointer.turns());
}

TEST(Pointer, TheDividerFollowsTheCursorFromAPressOnItToTheRelease) {
    Pointer pointer;
    EXPECT_FALSE(pointer.follow({}, {100.0f, 5.0f}, kSplit).divider);
    EXPECT_EQ(
        pointer.follow(Actions{press(MouseButton::left, {103.0f, 5.0f})}, {120.0f, 9.0f}, kSplit)
            .divider,
        0.6f);
    EXPECT_EQ(pointer.follow({}, {50.0f, 9.0f}, kSplit).divider, 0.25f);
    EXPECT_EQ(pointer.follow({}, {-50.0f, 9.0f}, kSplit).divider, 0.0f);
    EXPECT_EQ(pointer.follow({}, {900.0f, 9.0f}, kSplit).divider, 1.0f);
    const auto end =
        pointer.follow(Actions{release(MouseButton::left, {40.0f, 9.0f})}, {180.0f, 9.0f}, kSplit);
    EXPECT_EQ(end.divider, 0.2f);
    EXPECT_FALSE(end.clicked);
    EXPECT_FALSE(pointer.follow({}, {50.0f, 9.0f}, kSplit).divider);
}

TEST(Pointer, OnlyAPressAtTheDividerTakesHoldOfIt) {
    for (const float x : {80.0f, 120.0f}) {
        Pointer pointer;
        pointer.follow(Actions{press(MouseButton::left, {x, 5.0f})}, {x, 5.0f}, kSplit);
        EXPECT_FALSE(pointer.follow({}, {50.0f, 9.0f}, kSplit).divider);
    }
    Pointer pointer;
    pointer.follow(Actions{press(MouseButton::left, {100.0f, 5.0f})}, {100.0f, 5.0f}, kWhole);
    EXPECT_FALSE(pointer.follow({}, {50.0f, 9.0f}, kWhole).divider);
}

}  // namespace
