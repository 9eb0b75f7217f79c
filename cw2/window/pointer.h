// What the mouse does in the picture: moves the camera, the light or the divider, or points at a
// pixel.
#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "cw2/window/input.h"

namespace cw2 {

class Pointer {
 public:
    /// What the button that is held down has hold of.
    enum class Grip { nothing, orbit, pan, look, light, divider };

    struct Picture {
        float width;                   ///< pixels
        std::optional<float> divider;  ///< of a split view, in [0, 1] of the width
        float scale;                   ///< pixels of a length of 1
    };
    struct Wishes {
        std::optional<glm::vec2> clicked;         ///< pixels
        std::optional<glm::vec2> double_clicked;  ///< the same; a click there came before
        std::optional<float> divider;             ///< where it is dragged to
        Grip grip = Grip::nothing;                ///< of what is dragged by
        glm::vec2 drag{0.0f};                     ///< pixels to the right and down
    };

    /// What a button did at last, and where the cursor was then, where both are the picture's. The
    /// first button that is pressed counts until it is let go.
    Wishes follow(const std::optional<MouseAction>& action, glm::vec2 cursor,
                  const Picture& picture);

    Grip grip() const { return grip_; }
    /// Whether a press there would take hold of the divider.
    static bool at_divider(glm::vec2 cursor, const Picture& picture);

 private:
    struct Click {
        glm::vec2 at;
        double seconds;
    };
    Grip grip_of(const MouseAction& action, glm::vec2 cursor, const Picture& picture) const;
    void let_go(const MouseAction& action, const Picture& picture, Wishes& wishes);

    Grip grip_ = Grip::nothing;
    MouseButton button_{};     ///< that has the grip
    glm::vec2 pressed_{0.0f};  ///< where it took it
    glm::vec2 last_{0.0f};     ///< where the drag has come to
    bool drags_ = false;       ///< this is no click any more
    std::optional<Click> last_click_;
};

}  // namespace cw2
