// The images that a window shows in turn.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"

namespace cw2 {

class Swapchain {
 public:
    /// No images yet. `device` and `surface` must outlive this. Throws VulkanError where the
    /// surface has no sRGB format, or its images cannot be copied to.
    Swapchain(const Device& device, VkSurfaceKHR surface);

    /// Makes the images fit a window of this size where they do not, once the device is idle.
    /// False while there is nothing to draw into: a window without area.
    bool fit(VkExtent2D window);

    /// The next image to draw into, ready when `available` is signalled. None when the images do
    /// not fit any more, or none comes free within a second.
    std::optional<std::uint32_t> acquire(VkSemaphore available);
    /// Shows the image once its rendered() is signalled.
    void present(std::uint32_t index);

    VkFormat format() const { return format_.format; }
    VkExtent2D extent() const { return extent_; }
    /// Whether images may be copied from while they are ours.
    bool readable() const { return readable_; }
    VkImage image(std::uint32_t index) const { return images_[index].image; }
    VkImageView view(std::uint32_t index) const { return images_[index].view.get(); }
    VkSemaphore rendered(std::uint32_t index) const { return images_[index].rendered.get(); }

 private:
    struct PresentImage {
        VkImage image;
        ImageView view;
        Semaphore rendered;
    };

    void make(const VkSurfaceCapabilitiesKHR& surface, VkExtent2D extent);

    const Device& device_;
    VkSurfaceKHR surface_;
    VkSurfaceFormatKHR format_;
    VkExtent2D window_{};  ///< that the images were made for
    VkExtent2D extent_{};
    bool readable_ = false;
    bool stale_ = true;
    SwapchainHandle handle_;
    std::vector<PresentImage> images_;
};

Semaphore make_semaphore(const Device& device);

}  // namespace cw2
