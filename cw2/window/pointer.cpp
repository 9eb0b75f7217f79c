#include "cw2/window/pointer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace cw2 {

namespace {

// Lengths, in pixels at scale 1.
constexpr float kReach = 6.0f;       // from the divider
constexpr float kSteadyHand = 4.0f;  // that a click may be long

}  // namespace

bool Pointer::at_divider(glm::vec2 cursor, const Picture& picture) {
    return picture.divider &&
           std::abs(cursor.x - *picture.divider * picture.width) <= kReach * picture.scale;
}

Pointer::Wishes Pointer::follow(const std::optional<MouseAction>& action, glm::vec2 cursor,
                                const Picture& picture) {
    Wishes wishes;
    if (action && action->button == MouseButton::right) {
        turns_ = action->pressed;
        pressed_.reset();
    } else if (action && action->pressed) {
        drags_ = at_divider(cursor, picture);
        if (!drags_ && !turns_) pressed_ = cursor;
    }
    if (drags_) wishes.divider = std::clamp(cursor.x / picture.width, 0.0f, 1.0f);
    if (action && action->button == MouseButton::left && !action->pressed) {
        drags_ = false;
        if (pressed_ && glm::distance(*pressed_, cursor) <= kSteadyHand * picture.scale) {
            wishes.clicked = pressed_;
        }
        pressed_.reset();
    }
    return wishes;
}

}  // namespace cw2
