#include "cw2/window/ui_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

namespace cw2 {

// Of two things there are two ways: the backend mixes presses since the last frame with where the
// cursor went afterwards; and of a key that is pressed and let go between two frames it keeps
// nothing.
#if IMGUI_VERSION_NUM >= 18700

namespace {

/// Those that ImGui itself looks at; None for others.
ImGuiKey imgui_key(int key) {
    static constexpr std::array<std::pair<int, ImGuiKey>, 22> kKeys{{
        {GLFW_KEY_TAB, ImGuiKey_Tab},
        {GLFW_KEY_LEFT, ImGuiKey_LeftArrow},
        {GLFW_KEY_RIGHT, ImGuiKey_RightArrow},
        {GLFW_KEY_UP, ImGuiKey_UpArrow},
        {GLFW_KEY_DOWN, ImGuiKey_DownArrow},
        {GLFW_KEY_PAGE_UP, ImGuiKey_PageUp},
        {GLFW_KEY_PAGE_DOWN, ImGuiKey_PageDown},
        {GLFW_KEY_HOME, ImGuiKey_Home},
        {GLFW_KEY_END, ImGuiKey_End},
        {GLFW_KEY_INSERT, ImGuiKey_Insert},
        {GLFW_KEY_DELETE, ImGuiKey_Delete},
        {GLFW_KEY_BACKSPACE, ImGuiKey_Backspace},
        {GLFW_KEY_SPACE, ImGuiKey_Space},
        {GLFW_KEY_ENTER, ImGuiKey_Enter},
        {GLFW_KEY_ESCAPE, ImGuiKey_Escape},
        {GLFW_KEY_KP_ENTER, ImGuiKey_KeypadEnter},
        {GLFW_KEY_A, ImGuiKey_A},
        {GLFW_KEY_C, ImGuiKey_C},
        {GLFW_KEY_V, ImGuiKey_V},
        {GLFW_KEY_X, ImGuiKey_X},
        {GLFW_KEY_Y, ImGuiKey_Y},
        {GLFW_KEY_Z, ImGuiKey_Z},
    }};
    const auto found = std::ranges::find(kKeys, key, &std::pair<int, ImGuiKey>::first);
    return found == kKeys.end() ? ImGuiKey_None : found->second;
}

}  // namespace

UiInput::UiInput() {
    // A frame takes all events, as the last of them leave things.
    ImGui::GetIO().ConfigInputTrickleEventQueue = false;
}

void UiInput::before_frame(GLFWwindow* window, const Input& input) {
    ImGuiIO& io = ImGui::GetIO();
    if (glfwGetWindowAttrib(window, GLFW_FOCUSED)) {
        io.AddMousePosEvent(input.cursor.x / io.DisplayFramebufferScale.x,
                            input.cursor.y / io.DisplayFramebufferScale.y);
    }
    for (std::size_t i = 0; i < input.buttons.size(); ++i)
        io.AddMouseButtonEvent(static_cast<int>(i), input.buttons[i]);
}

/// What a frame has missed is there for the next.
void UiInput::after_frame(const Input& input) {
    ImGuiIO& io = ImGui::GetIO();
    for (const int key : short_keys_) io.AddKeyEvent(imgui_key(key), false);
    short_keys_.clear();
    for (const int key : input.keys) {
        if (imgui_key(key) == ImGuiKey_None || ImGui::IsKeyDown(imgui_key(key))) continue;
        io.AddKeyEvent(imgui_key(key), true);
        short_keys_.push_back(key);
    }
}

#else

UiInput::UiInput() = default;

void UiInput::before_frame(GLFWwindow*, const Input& input) {
    ImGuiIO& io = ImGui::GetIO();
    std::ranges::copy(input.buttons, io.MouseDown);
    if (ImGui::IsMousePosValid()) {
        io.MousePos = {input.cursor.x / io.DisplayFramebufferScale.x,
                       input.cursor.y / io.DisplayFramebufferScale.y};
    }
    for (const int key : short_keys_) io.KeysDown[key] = false;
    short_keys_.clear();
    for (const int key : input.keys) {
        if (key < 0 || io.KeysDown[key]) continue;
        io.KeysDown[key] = true;
        short_keys_.push_back(key);
    }
}

void UiInput::after_frame(const Input&) {}

#endif

}  // namespace cw2
