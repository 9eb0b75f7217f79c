// What Dear ImGui is told of the mouse, and of keys that are up again, beside what its backend
// tells.
#pragma once

#include <vector>

#include "cw2/window/input.h"

struct GLFWwindow;

namespace cw2 {

/// ImGui takes input as values, and from its version 1.87 on as a queue of events.
class UiInput {
 public:
    /// Between the making of ImGui's context and of its backend for GLFW.
    UiInput();

    /// Around ImGui::NewFrame(), after the backend's.
    void before_frame(GLFWwindow* window, const Input& input);
    void after_frame(const Input& input);

 private:
    std::vector<int> short_keys_;  ///< that were down in the last frame only for us
};

}  // namespace cw2
