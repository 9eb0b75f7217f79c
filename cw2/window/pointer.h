// What the mouse does in the picture: turns the camera, drags the divider, or points at a pixel.
#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "cw2/window/input.h"

namespace cw2 {

class Pointer {
 public:
    struct Picture {
        float width;                   ///< pixels
        std::optional<float> divider;  ///< of a split view, in [0, 1] of the width
        float scale;                   ///< pixels of a length of 1
    };
    struct Wishes {
        std::optional<glm::vec2> clicked;  ///< pixels
        std::optional<float> divider;      ///< where it is dragged to
    };

    /// What a button did at last, and where the cursor was then, where both are the picture's.
    Wishes follow(const std::optional<MouseAction>& action, glm::vec2 cursor,
                  const Picture& picture);

    bool turns() const { return turns_; }
    bool drags() const { return drags_; }
    /// Whether a press there would take hold of the divider.
    static bool at_divider(glm::vec2 cursor, const Picture& picture);

 private:
    bool turns_ = false;
    bool drags_ = false;
    std::optional<glm::vec2> pressed_;  ///< where, while this may become a click
};

}  // namespace cw2
