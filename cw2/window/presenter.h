// Draws frames into a window, two of them in flight.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "cw2/render/renderer.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/resources.h"
#include "cw2/vulkan/swapchain.h"
#include "cw2/window/ui_pass.h"

namespace cw2 {

/// Rows from the top, 8-bit RGBA, sRGB-encoded.
struct Picture {
    VkExtent2D extent;
    std::vector<std::byte> pixels;
};

/// What a window shows.
struct WindowContents {
    const Scene& scene;
    const FrameSettings& settings;
    bool redraw;    ///< false: the picture of the last time is still right
    UiPass* panel;  ///< its last frame lies over the picture; null: nothing does
};

/// How long frames take, in milliseconds, smoothed over the latest that were seen to be drawn, and
/// not waiting for pipelines where others have been seen; nothing before the first.
struct FrameTimes {
    std::optional<double> cpu;  ///< of this thread to record and submit
    std::optional<double> gpu;  ///< of the device; nothing where it has no timestamps
};

class Presenter {
 public:
    static constexpr std::uint32_t kSlots = 2;

    /// `device`, `surface` and `layouts` must outlive this. Throws VulkanError.
    Presenter(const Device& device, VkSurfaceKHR surface, const Layouts& layouts,
              const ShaderCode& code, VkSampleCountFlagBits samples);
    /// Waits for the frames in flight.
    ~Presenter();
    Presenter(const Presenter&) = delete;
    Presenter& operator=(const Presenter&) = delete;

    VkFormat format() const { return swapchain_.format(); }

    /// Draws and shows one frame in a window of this size. False where nothing can be shown now.
    bool show(const WindowContents& contents, VkExtent2D window);
    /// Like show(), and gives the picture, without the panel.
    std::optional<Picture> show_and_read(const WindowContents& contents, VkExtent2D window);
    /// Like show(), and gives all that the window shows.
    std::optional<Picture> show_and_read_window(const WindowContents& contents, VkExtent2D window);
    /// Whether show_and_read_window() can be used.
    bool can_read_window() const { return swapchain_.readable(); }

    /// Waits until every frame is drawn.
    void finish();
    /// From the next frame on draws with these shaders. Throws VulkanError, and keeps the old ones.
    void use_shaders(const ShaderCode& code);
    /// From the next frame on draws with that many samples a pixel. Throws VulkanError, and keeps
    /// the old number.
    void use_samples(VkSampleCountFlagBits samples);

    const FrameTimes& times() const { return times_; }
    /// Whether only frames were seen that had to wait for pipelines.
    bool times_are_cold() const { return times_are_cold_; }
    /// Of the last picture.
    const FrameCounts& counts() const { return renderer_.counts(); }
    /// Device memory of the images that are drawn into.
    VkDeviceSize memory_bytes() const { return picture_.memory.bytes() + renderer_.memory_bytes(); }

 private:
    struct Slot {
        VkCommandBuffer commands;
        Semaphore available;  ///< the image it copies to
        Fence drawn;
        bool in_flight = false;
        Buffer legends;            ///< what is copied onto the picture
        bool draws_scene = false;  ///< its latest frame did
        bool builds_pipelines = false;
        double cpu = 0.0;  ///< milliseconds
    };
    enum class Read { nothing, picture, window };

    bool draw(const WindowContents& contents, VkExtent2D window, Read what, Buffer* pixels);
    std::optional<Picture> draw_and_read(const WindowContents& contents, VkExtent2D window,
                                         Read what);
    void fit_picture();
    void record(std::uint32_t slot, std::uint32_t image, const WindowContents& contents, Read what,
                const Buffer* pixels);
    void record_legends(Slot& slot, const FrameSettings& settings);
    void record_window(std::uint32_t slot, std::uint32_t image, UiPass* panel,
                       const Buffer* pixels);
    void submit(const Slot& slot, std::uint32_t image) const;
    void wait_for(std::uint32_t slot);
    void take_times(const Slot& slot, std::optional<double> gpu);

    const Device& device_;
    Swapchain swapchain_;
    CommandPool pool_;
    std::array<Slot, kSlots> slots_;
    std::uint32_t next_slot_ = 0;
    Renderer renderer_;
    /// What the scene is drawn into, and every frame of the window starts as a copy of: a panel
    /// can change where the scene takes long to draw.
    Image picture_;
    VkExtent2D picture_extent_{};
    bool has_picture_ = false;
    FrameTimes times_;
    bool times_are_cold_ = true;
};

}  // namespace cw2
