// What a user asks of the window.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "cw2/render/view.h"

namespace cw2 {

enum class CommandKind {
    toggle_light,
    show_view,
    next_view,
    previous_view,
    toggle_normal_map,
    toggle_alpha_mask,
    reset,
    toggle_panel,
    reload_shaders,
    save_picture,
    save_window,  ///< the panel included
    save_settings,
    save_settings_in_panel,  ///< the same where the panel has the focus; else the key is not for it
    copy_camera,
    end,
};

struct Command {
    CommandKind kind;
    View view = interop::kViewShaded;  ///< of show_view
};

enum class MouseButton { left, right };

/// A mouse button was pressed or let go.
struct MouseAction {
    MouseButton button;
    bool pressed;
};

/// What the user did since the last look at it, and where the cursor was then. It ends with the
/// first press or release of a mouse button, so that nobody takes it to have happened where the
/// cursor went afterwards.
struct Input {
    std::vector<Command> commands;            ///< in their order; none beside a mouse action
    std::optional<MouseAction> mouse_action;  ///< the latest event of all
    std::array<bool, 2> buttons{};            ///< by MouseButton: whether it is held down
    glm::vec3 direction{0.0f};  ///< of the keys held: right, up, forward; each -1, 0 or 1
    float pace = 1.0f;          ///< a factor on the speed
    glm::vec2 cursor{0.0f};     ///< pixels from the picture's upper left corner
    glm::vec2 drag{0.0f};       ///< of the hidden cursor: screen units to the right and down
    bool exposed = false;       ///< the window's picture is lost
    bool anything = false;      ///< there was any event at all
};

}  // namespace cw2
