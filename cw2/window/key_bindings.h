// Which key of GLFW's is which command, as the table of controls says.
#pragma once

#include <optional>

#include "cw2/window/input.h"

namespace cw2 {

/// GLFW's number of the key that makes a drag move the light.
extern const int kLightKey;

/// The command of a key that is pressed while GLFW's `modifiers` are held; none for the keys that
/// move the camera and for all others. With Shift a key does what it does without, unless the
/// table has something else for that; other modifiers make it another key.
std::optional<Command> command_of(int key, int modifiers);

/// The command of a character, wherever a keyboard has it.
std::optional<Command> command_of_character(unsigned int character);

}  // namespace cw2
