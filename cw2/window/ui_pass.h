// Dear ImGui: its context, its input from the window, and the pass that draws it. Its Vulkan
// backend wants a VkRenderPass, so this is a pass of its own over a finished image.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "cw2/window/input.h"
#include "cw2/window/ui_input.h"

struct GLFWwindow;

namespace cw2 {

/// The process's one; between begin_frame() and end_frame() ImGui's functions may be called.
class UiPass {
 public:
    /// For images of `format`, an sRGB one; `slots` frames may be in flight at once. Sizes are
    /// multiplied by `scale`. All arguments must outlive this. Throws VulkanError.
    UiPass(GLFWwindow* window, const Instance& instance, const Device& device, VkFormat format,
           std::uint32_t slots, float scale);
    /// No frame may be in flight.
    ~UiPass() = default;
    UiPass(const UiPass&) = delete;
    UiPass& operator=(const UiPass&) = delete;

    /// Of `input` it takes what the mouse does, and keys that are up again; other keys and text it
    /// gets by itself. `has_mouse`: false
    /// while the mouse does something else.
    void begin_frame(const Input& input, bool has_mouse);
    void end_frame();

    // From begin_frame() on: whom the user's actions are for.
    bool wants_mouse() const;  ///< what the mouse does now
    bool wants_keys() const;   ///< a panel has the focus
    bool wants_text() const;   ///< a field is being filled in
    /// Takes the focus away from all panels.
    void drop_focus();

    /// Draws the last frame over `target`, which is used as a colour attachment before and after.
    /// The slot's previous frame must be done.
    void record(VkCommandBuffer commands, std::uint32_t slot, VkImageView target,
                VkExtent2D extent);

 private:
    /// ImGui's context; destroyed after its backends.
    struct Context {
        Context();
        ~Context();
        Context(const Context&) = delete;
        Context& operator=(const Context&) = delete;
    };

    /// Ends of ImGui's backends what has begun, also where they could not begin.
    struct Backends {
        Backends() = default;
        ~Backends();
        Backends(const Backends&) = delete;
        Backends& operator=(const Backends&) = delete;
    };

    void fill() const;

    const Device& device_;
    GLFWwindow* window_;
    Context context_;
    UiInput input_;
    RenderPass pass_;
    DescriptorPool descriptor_pool_;
    Backends backends_;
    std::vector<Framebuffer> framebuffers_;  ///< of each slot
};

}  // namespace cw2
