// What a user asks of the window.
#pragma once

#include <array>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "cw2/options/controls.h"
#include "cw2/render/view.h"

namespace cw2 {

struct Command {
    CommandKind kind;
    View view = interop::kViewShaded;  ///< of show_view
};

/// In Dear ImGui's order.
enum class MouseButton { left, right, middle };

/// A mouse button was pressed or let go.
struct MouseAction {
    MouseButton button;
    bool pressed;
    double seconds = 0.0;      ///< when, from some beginning
    bool shift = false;        ///< is held
    bool moves_light = false;  ///< the key for it is held
};

/// What the user did since the last look at it, and where the cursor was then. It ends with the
/// first press or release of a mouse button, so that nobody takes it to have happened where the
/// cursor went afterwards, and with a command to open a file, after which keys are letters.
struct Input {
    std::vector<Command> commands;            ///< in their order; none beside a mouse action
    std::vector<int> keys;                    ///< that were pressed, by GLFW's numbers
    std::optional<MouseAction> mouse_action;  ///< the latest event of all
    std::array<bool, 3> buttons{};            ///< by MouseButton: whether it is held down
    glm::vec3 direction{0.0f};  ///< of the keys held: right, up, forward; each -1, 0 or 1
    float pace = 1.0f;          ///< a factor on the speed
    glm::vec2 cursor{0.0f};     ///< pixels from the picture's upper left corner
    glm::vec2 drag{0.0f};       ///< of the hidden cursor: screen units to the right and down
    float wheel = 0.0f;         ///< notches away from the user
    glm::vec2 wheel_at{0.0f};   ///< where the cursor was when the wheel turned last
    std::vector<std::filesystem::path> dropped;  ///< files
    bool exposed = false;                        ///< the window's picture is lost
    bool anything = false;                       ///< there was any event at all
};

}  // namespace cw2
