// What a user asks of the window.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "cw2/view.h"

namespace cw2 {

enum class CommandKind {
    toggle_light,
    show_view,
    next_view,
    previous_view,
    toggle_normal_map,
    toggle_alpha_mask,
    reset,
    reload_shaders,
    save_screenshot,
    end,
};

struct Command {
    CommandKind kind;
    View view = interop::kViewShaded;  ///< of show_view
};

/// What the user did since the last look at it.
struct Input {
    std::vector<Command> commands;  ///< in their order
    glm::vec3 direction{0.0f};      ///< of the keys held: right, up, forward; each -1, 0 or 1
    float pace = 1.0f;              ///< a factor on the speed
    glm::vec2 drag{0.0f};           ///< of the mouse: screen units to the right and down
    bool exposed = false;           ///< the window's picture is lost
};

}  // namespace cw2
