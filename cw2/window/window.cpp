#include "cw2/window/window.h"

#define GLFW_INCLUDE_NONE
#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "cw2/window/key_bindings.h"

namespace cw2 {

namespace {

/// What GLFW said about its last failure.
std::string glfw_error() {
    const char* text = nullptr;
    return glfwGetError(&text) == GLFW_NO_ERROR ? "no reason given" : text;
}

}  // namespace

Window::Library::Library() {
#ifdef GLFW_PLATFORM
    // X11 where there is a display of it, as before version 3.4.
    if (std::getenv("DISPLAY") || !std::getenv("WAYLAND_DISPLAY"))
        glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
    if (!glfwInit()) {
        throw WindowError(fmt::format(
            "cannot open a window: {}; --output FILE.png renders without one", glfw_error()));
    }
}

Window::Library::~Library() {
    glfwTerminate();
}

Window::Window(const std::string& title, std::uint32_t width, std::uint32_t height) {
    // X11 ends the process where a window is larger than its protocol can say.
    constexpr std::uint32_t kLargest = 32767;
    if (width > kLargest || height > kLargest) {
        throw WindowError(fmt::format("--size: a window has at most {} pixels a side", kLargest));
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    handle_ = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(),
                               nullptr, nullptr);
    if (handle_ == nullptr) throw WindowError("cannot open a window: " + glfw_error());
    glfwSetWindowUserPointer(handle_, this);
    // A key that is pressed and released between two looks still counts.
    glfwSetInputMode(handle_, GLFW_STICKY_KEYS, GLFW_TRUE);
    glfwSetKeyCallback(handle_, on_key);
    glfwSetMouseButtonCallback(handle_, on_button);
    glfwSetCursorPosCallback(handle_, on_cursor);
    glfwSetCharCallback(handle_, on_character);
    glfwSetScrollCallback(handle_, on_scroll);
    glfwSetDropCallback(handle_, on_drop);
    glfwSetWindowRefreshCallback(handle_, on_refresh);
}

Window::~Window() {
    glfwDestroyWindow(handle_);
}

std::vector<const char*> Window::instance_extensions() const {
    std::uint32_t count = 0;
    const char** const names = glfwGetRequiredInstanceExtensions(&count);
    if (names == nullptr) throw WindowError("no Vulkan driver can draw into a window here");
    return {names, names + count};
}

SurfaceHandle Window::make_surface(const Instance& instance) const {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    check(glfwCreateWindowSurface(instance.get(), handle_, nullptr, &surface),
          "glfwCreateWindowSurface");
    return {instance.get(), surface, kDestroySurface};
}

void Window::show() {
    glfwShowWindow(handle_);
    glfwGetCursorPos(handle_, &cursor_.x, &cursor_.y);
}

void Window::hide() {
    glfwHideWindow(handle_);
}

void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(handle_, title.c_str());
}

VkExtent2D Window::extent() const {
    if (glfwGetWindowAttrib(handle_, GLFW_ICONIFIED)) return {0, 0};
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(handle_, &width, &height);
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

bool Window::closed() const {
    return glfwWindowShouldClose(handle_);
}

bool Window::held(int key) const {
    return glfwGetKey(handle_, key) == GLFW_PRESS;
}

/// What follows belongs to another input.
void Window::end_input() {
    Input& input = inputs_.back();
    input.cursor = in_pixels(cursor_);
    inputs_.emplace_back().buttons = input.buttons;
}

Input Window::poll(double seconds) {
    if (seconds > 0.0 && inputs_.size() == 1) {
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwPollEvents();
    }
    if (inputs_.size() == 1) end_input();
    Input input = std::move(inputs_.front());
    inputs_.pop_front();
    const auto axis = [this](int positive, int negative) {
        // Both are asked, because asking is what lets go of a sticky key.
        const bool forth = held(positive);
        const bool back = held(negative);
        return static_cast<float>(forth) - static_cast<float>(back);
    };
    input.direction = {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                       axis(GLFW_KEY_W, GLFW_KEY_S)};
    if (axis(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT) != 0.0f) input.pace = 4.0f;
    if (axis(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL) != 0.0f) input.pace = 0.25f;
    return input;
}

void Window::hide_cursor(bool hidden) {
    if (hidden == cursor_hidden_) return;
    cursor_hidden_ = hidden;
    glfwSetInputMode(handle_, GLFW_CURSOR, hidden ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    glfwGetCursorPos(handle_, &cursor_.x, &cursor_.y);
}

void Window::copy(const std::string& text) {
    glfwSetClipboardString(handle_, text.c_str());
}

float Window::content_scale() const {
    float x = 1.0f;
    float y = 1.0f;
    glfwGetWindowContentScale(handle_, &x, &y);
    return std::max(x, y);
}

glm::vec2 Window::in_pixels(const glm::dvec2& cursor) const {
    int width = 0;
    int height = 0;
    glfwGetWindowSize(handle_, &width, &height);
    const VkExtent2D pixels = extent();
    if (width == 0 || height == 0) return {0.0f, 0.0f};
    return glm::vec2(cursor * glm::dvec2(pixels.width, pixels.height) / glm::dvec2(width, height));
}

Window& Window::of(GLFWwindow* handle) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(handle));
}

void Window::on_key(GLFWwindow* handle, int key, int, int action, int modifiers) {
    Input& input = of(handle).inputs_.back();
    input.anything = true;
    if (key == kLightKey) of(handle).light_key_held_ = action != GLFW_RELEASE;
    if (action != GLFW_PRESS) return;
    input.keys.push_back(key);
    const auto command = command_of(key, modifiers);
    if (!command) return;
    input.commands.push_back(*command);
    // The keys that follow are for the field that it opens.
    if (command->kind == CommandKind::open) of(handle).end_input();
}

void Window::on_character(GLFWwindow* handle, unsigned int character) {
    Input& input = of(handle).inputs_.back();
    input.anything = true;
    if (const auto command = command_of_character(character)) input.commands.push_back(*command);
}

void Window::on_scroll(GLFWwindow* handle, double, double y) {
    Window& window = of(handle);
    Input& input = window.inputs_.back();
    input.anything = true;
    input.wheel += static_cast<float>(y);
    input.wheel_at = window.in_pixels(window.cursor_);
}

void Window::on_drop(GLFWwindow* handle, int count, const char** paths) {
    Input& input = of(handle).inputs_.back();
    input.anything = true;
    input.dropped.assign(paths, paths + count);
}

void Window::on_button(GLFWwindow* handle, int button, int action, int modifiers) {
    Window& window = of(handle);
    window.inputs_.back().anything = true;
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    static_assert(static_cast<int>(MouseButton::middle) == GLFW_MOUSE_BUTTON_MIDDLE);
    const auto which = static_cast<MouseButton>(button);
    const bool pressed = action == GLFW_PRESS;
    // A hidden cursor points at nothing.
    if (which != MouseButton::right && pressed && window.cursor_hidden_) return;
    if (!window.inputs_.back().commands.empty()) window.end_input();
    Input& input = window.inputs_.back();
    input.mouse_action = {which, pressed, glfwGetTime(), (modifiers & GLFW_MOD_SHIFT) != 0,
                          window.light_key_held_};
    input.buttons[static_cast<std::size_t>(button)] = pressed;
    window.end_input();
}

void Window::on_cursor(GLFWwindow* handle, double x, double y) {
    Window& window = of(handle);
    Input& input = window.inputs_.back();
    input.anything = true;
    if (window.cursor_hidden_) input.drag += glm::vec2(glm::dvec2(x, y) - window.cursor_);
    window.cursor_ = {x, y};
}

void Window::on_refresh(GLFWwindow* handle) {
    of(handle).inputs_.back().exposed = true;
}

}  // namespace cw2
