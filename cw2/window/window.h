// The window and what a user does in it; it knows GLFW.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "cw2/window/input.h"

struct GLFWwindow;

namespace cw2 {

/// Why there is no window; what() is one line.
class WindowError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The process's one window.
class Window {
 public:
    /// A window that is hidden at first, of width x height pixels where the desktop lets it.
    /// Throws WindowError, also where there is no display.
    Window(const std::string& title, std::uint32_t width, std::uint32_t height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// What an Instance needs for make_surface(). Throws WindowError where no Vulkan driver can
    /// draw into a window.
    std::vector<const char*> instance_extensions() const;
    /// Throws VulkanError. `instance` must outlive the surface, and the surface must not outlive
    /// this.
    SurfaceHandle make_surface(const Instance& instance) const;

    void show();
    void hide();
    void set_title(const std::string& title);
    /// Size in pixels; 0 x 0 while nothing of it is to be seen.
    VkExtent2D extent() const;
    /// Whether the user has closed it.
    bool closed() const;

    /// Gives what the user did next; waits up to `seconds` for an event if there was none.
    Input poll(double seconds);
    /// Hides the cursor, so that it never meets the screen's edge, and measures how it is dragged;
    /// or shows it again.
    void hide_cursor(bool hidden);

    /// Puts text into the clipboard.
    void copy(const std::string& text);
    /// Pixels that a length of 1 should have on this screen.
    float content_scale() const;
    /// For those who extend GLFW.
    GLFWwindow* handle() const { return handle_; }

 private:
    /// GLFW itself; destroyed after the window.
    struct Library {
        Library();
        ~Library();
        Library(const Library&) = delete;
        Library& operator=(const Library&) = delete;
    };

    static Window& of(GLFWwindow* handle);
    static void on_key(GLFWwindow* handle, int key, int scancode, int action, int modifiers);
    static void on_button(GLFWwindow* handle, int button, int action, int modifiers);
    static void on_cursor(GLFWwindow* handle, double x, double y);
    static void on_character(GLFWwindow* handle, unsigned int character);
    static void on_scroll(GLFWwindow* handle, double x, double y);
    static void on_drop(GLFWwindow* handle, int count, const char** paths);
    static void on_refresh(GLFWwindow* handle);
    bool held(int key) const;
    void end_input();
    glm::vec2 in_pixels(const glm::dvec2& cursor) const;

    Library library_;
    GLFWwindow* handle_ = nullptr;
    std::deque<Input> inputs_{1};  ///< collected by the callbacks; the last one is not at its end
    bool cursor_hidden_ = false;
    bool light_key_held_ = false;
    glm::dvec2 cursor_{0.0};  ///< screen units, as of the latest event
};

}  // namespace cw2
