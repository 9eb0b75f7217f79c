// Draws frames into a window, two of them in flight.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "cw2/device.h"
#include "cw2/renderer.h"
#include "cw2/resources.h"
#include "cw2/swapchain.h"

namespace cw2 {

/// What a window shows: rows from the top, 8-bit RGBA, sRGB-encoded.
struct Picture {
    VkExtent2D extent;
    std::vector<std::byte> pixels;
};

class Presenter {
 public:
    /// `device`, `surface` and `layouts` must outlive this. Throws VulkanError.
    Presenter(const Device& device, VkSurfaceKHR surface, const Layouts& layouts,
              const ShaderCode& code, VkSampleCountFlagBits samples);
    /// Waits for the frames in flight.
    ~Presenter();
    Presenter(const Presenter&) = delete;
    Presenter& operator=(const Presenter&) = delete;

    /// Draws and shows one frame in a window of this size. False where nothing can be shown now.
    bool show(const Scene& scene, const FrameSettings& settings, VkExtent2D window);
    /// Whether show_and_read() can be used.
    bool can_read() const { return swapchain_.readable(); }
    /// Like show(), and gives the picture that is shown.
    std::optional<Picture> show_and_read(const Scene& scene, const FrameSettings& settings,
                                         VkExtent2D window);

    /// Waits until every frame is drawn.
    void finish();
    /// From the next frame on draws with these shaders. Throws VulkanError, and keeps the old ones.
    void use_shaders(const ShaderCode& code);

    /// Device time of a frame, smoothed over the latest that were seen to be drawn; nothing before
    /// the first, and where the device has no timestamps.
    std::optional<double> gpu_milliseconds() const { return gpu_milliseconds_; }

 private:
    struct Slot {
        VkCommandBuffer commands;
        Semaphore available;  ///< the image it draws into
        Fence drawn;
        bool in_flight = false;
    };

    bool draw(const Scene& scene, const FrameSettings& settings, VkExtent2D window, Buffer* pixels);
    void record(std::uint32_t slot, std::uint32_t image, const Scene& scene,
                const FrameSettings& settings, const Buffer* pixels);
    void submit(const Slot& slot, std::uint32_t image) const;
    void wait_for(std::uint32_t slot);

    const Device& device_;
    Swapchain swapchain_;
    CommandPool pool_;
    std::array<Slot, 2> slots_;
    std::uint32_t next_slot_ = 0;
    Renderer renderer_;
    std::optional<double> gpu_milliseconds_;
};

}  // namespace cw2
