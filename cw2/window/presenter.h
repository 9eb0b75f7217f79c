// Draws frames into a window, two of them in flight: quick ones of what changes, and the mean of
// several of what does not.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "cw2/render/averager.h"
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
    bool redraw;    ///< false: what it shows is what it showed the last time
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

    /// What stands still becomes the mean of `samples` frames. `device`, `surface` and `layouts`
    /// must outlive this. Throws VulkanError.
    Presenter(const Device& device, VkSurfaceKHR surface, const Layouts& layouts,
              const ShaderCode& code, std::uint32_t samples);
    /// Waits for the frames in flight.
    ~Presenter();
    Presenter(const Presenter&) = delete;
    Presenter& operator=(const Presenter&) = delete;

    VkFormat format() const { return swapchain_.format(); }

    /// Draws and shows one frame in a window of this size. False where nothing can be shown now.
    bool show(const WindowContents& contents, VkExtent2D window);
    /// Whether the picture gets better by being shown again.
    bool refines() const { return has_picture_ && !shows_mean_; }
    /// Like show(), and gives the picture at its best, without the panel, as a file has it.
    std::optional<Picture> show_and_read(const WindowContents& contents, VkExtent2D window,
                                         const PictureBytes& form);
    /// Like show(), and gives all that the window shows with the picture at its best.
    std::optional<Picture> show_and_read_window(const WindowContents& contents, VkExtent2D window);
    /// Whether show_and_read_window() can be used.
    bool can_read_window() const { return swapchain_.readable(); }

    /// Waits until every frame is drawn.
    void finish();
    /// From the next frame on draws with these shaders. Throws VulkanError, and keeps the old ones.
    void use_shaders(const ShaderCode& code);
    /// From the next picture on the mean is of that many frames.
    void use_samples(std::uint32_t samples) { samples_ = samples; }

    const FrameTimes& times() const { return times_; }
    /// Whether only frames were seen that had to wait for pipelines.
    bool times_are_cold() const { return times_are_cold_; }
    /// Of the last picture.
    const FrameCounts& counts() const { return counts_; }
    /// Device memory of the images that are drawn into.
    VkDeviceSize memory_bytes() const;

 private:
    struct Slot {
        VkCommandBuffer commands;
        Semaphore available;  ///< the image it copies to
        Fence done;
        bool in_flight = false;
        Buffer legends;                   ///< what is copied onto the picture
        const Renderer* drawn = nullptr;  ///< what drew the scene in its latest frame, if any did
        bool builds_pipelines = false;
        double cpu = 0.0;  ///< milliseconds
    };

    /// `pixels`: what all that the window shows is read into, if it is.
    bool draw(const WindowContents& contents, VkExtent2D window, Buffer* pixels);
    void fit_picture();
    void record_scene(std::uint32_t slot, const WindowContents& contents);
    const Renderer& record_sample(std::uint32_t slot, const WindowContents& contents,
                                  std::uint32_t index, std::uint32_t count);
    void record_picture(Slot& slot, const FrameSettings& settings);
    void finish_mean(const WindowContents& contents);
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
    std::optional<Renderer> quick_;  ///< with several samples a pixel; none: one is what is quick
    Averager averager_;
    std::uint32_t samples_;
    std::uint32_t sampled_ = 0;  ///< frames in the mean
    bool shows_mean_ = false;
    FrameCounts counts_;
    /// What the scene is drawn into, and every frame of the window starts as a copy of: a panel
    /// can change where the scene takes long to draw.
    Image picture_;
    VkExtent2D picture_extent_{};
    bool has_picture_ = false;
    FrameTimes times_;
    bool times_are_cold_ = true;
};

}  // namespace cw2
