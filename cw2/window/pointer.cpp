#include "cw2/window/pointer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace cw2 {

namespace {

// Lengths, in pixels at scale 1.
constexpr float kReach = 6.0f;       // from the divider
constexpr float kSteadyHand = 4.0f;  // that a click may be long
/// From the end of a click to the end of the next that makes them a double click.
constexpr double kDoubleClickSeconds = 0.5;

}  // namespace

bool Pointer::at_divider(glm::vec2 cursor, const Picture& picture) {
    return picture.divider &&
           std::abs(cursor.x - *picture.divider * picture.width) <= kReach * picture.scale;
}

Pointer::Grip Pointer::grip_of(const MouseAction& action, glm::vec2 cursor,
                               const Picture& picture) const {
    if (action.button == MouseButton::right) return Grip::look;
    if (action.button == MouseButton::middle) return Grip::pan;
    if (action.moves_light) return Grip::light;
    if (action.shift) return Grip::pan;
    return at_divider(cursor, picture) ? Grip::divider : Grip::orbit;
}

Pointer::Wishes Pointer::follow(const std::optional<MouseAction>& action, glm::vec2 cursor,
                                const Picture& picture) {
    Wishes wishes;
    if (action && action->pressed && grip_ == Grip::nothing) {
        grip_ = grip_of(*action, cursor, picture);
        button_ = action->button;
        pressed_ = last_ = cursor;
        drags_ = false;
    }
    if (grip_ == Grip::divider) wishes.divider = std::clamp(cursor.x / picture.width, 0.0f, 1.0f);
    drags_ |= glm::distance(pressed_, cursor) > kSteadyHand * picture.scale;
    // What looks around is told by a cursor that is hidden.
    if (drags_ && grip_ != Grip::nothing && grip_ != Grip::look && grip_ != Grip::divider) {
        wishes.grip = grip_;
        wishes.drag = cursor - std::exchange(last_, cursor);
    }
    if (action && !action->pressed && action->button == button_) let_go(*action, picture, wishes);
    return wishes;
}

void Pointer::let_go(const MouseAction& action, const Picture& picture, Wishes& wishes) {
    const bool clicks = grip_ == Grip::orbit && !drags_;
    grip_ = Grip::nothing;
    if (!clicks) {
        last_click_.reset();
        return;
    }
    const bool again = last_click_ && action.seconds - last_click_->seconds < kDoubleClickSeconds &&
                       glm::distance(last_click_->at, pressed_) <= kSteadyHand * picture.scale;
    (again ? wishes.double_clicked : wishes.clicked) = pressed_;
    last_click_ = again ? std::nullopt : std::optional(Click{pressed_, action.seconds});
}

}  // namespace cw2
