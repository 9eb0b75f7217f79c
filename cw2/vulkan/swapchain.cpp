#include "cw2/vulkan/swapchain.h"

#include <fmt/format.h>

#include <algorithm>

#include "cw2/vulkan/resources.h"

namespace cw2 {

namespace {

constexpr std::uint64_t kAcquireTimeout = 1'000'000'000;  // nanoseconds

VkSurfaceFormatKHR srgb_format(const Device& device, VkSurfaceKHR surface) {
    std::uint32_t count = 0;
    check(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, nullptr),
          "vkGetPhysicalDeviceSurfaceFormatsKHR");
    std::vector<VkSurfaceFormatKHR> formats(count);
    check(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, formats.data()),
          "vkGetPhysicalDeviceSurfaceFormatsKHR");
    for (const VkSurfaceFormatKHR& format : formats) {
        if ((format.format == VK_FORMAT_B8G8R8A8_SRGB ||
             format.format == VK_FORMAT_R8G8B8A8_SRGB) &&
            format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) {
            return format;
        }
    }
    throw VulkanError(fmt::format("device '{}' cannot show an sRGB picture in this window",
                                  device.properties().deviceName));
}

VkSurfaceCapabilitiesKHR capabilities(const Device& device, VkSurfaceKHR surface) {
    VkSurfaceCapabilitiesKHR result;
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical(), surface, &result),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    return result;
}

/// The surface's own size, or the window's where the surface takes any.
VkExtent2D image_extent(const VkSurfaceCapabilitiesKHR& surface, VkExtent2D window) {
    constexpr std::uint32_t kAnySize = 0xffffffff;
    if (surface.currentExtent.width != kAnySize) return surface.currentExtent;
    const VkExtent2D low = surface.minImageExtent;
    const VkExtent2D high = surface.maxImageExtent;
    return {std::clamp(window.width, low.width, high.width),
            std::clamp(window.height, low.height, high.height)};
}

VkCompositeAlphaFlagBitsKHR composite_alpha(VkCompositeAlphaFlagsKHR supported) {
    if (supported & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) return VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    return static_cast<VkCompositeAlphaFlagBitsKHR>(supported & ~(supported - 1));
}

}  // namespace

Semaphore make_semaphore(const Device& device) {
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    check(vkCreateSemaphore(device.get(), &info, nullptr, &semaphore), "vkCreateSemaphore");
    return {device.get(), semaphore};
}

Swapchain::Swapchain(const Device& device, VkSurfaceKHR surface)
    : device_(device),
      surface_(surface),
      format_(srgb_format(device, surface)),
      readable_(capabilities(device, surface).supportedUsageFlags &
                VK_IMAGE_USAGE_TRANSFER_SRC_BIT) {
    if (!(capabilities(device, surface).supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT)) {
        throw VulkanError(fmt::format("device '{}' cannot copy a picture into this window",
                                      device.properties().deviceName));
    }
}

bool Swapchain::fit(VkExtent2D window) {
    if (window.width == 0 || window.height == 0) return false;
    if (!stale_ && window.width == window_.width && window.height == window_.height) return true;
    const VkSurfaceCapabilitiesKHR surface = capabilities(device_, surface_);
    const VkExtent2D extent = image_extent(surface, window);
    if (extent.width == 0 || extent.height == 0) return false;
    check(device_.wait_idle(), "vkDeviceWaitIdle");
    make(surface, extent);
    window_ = window;
    stale_ = false;
    return true;
}

void Swapchain::make(const VkSurfaceCapabilitiesKHR& surface, VkExtent2D extent) {
    // One more than the least, so that drawing seldom waits for the screen.
    const std::uint32_t most =
        surface.maxImageCount > 0 ? surface.maxImageCount : surface.minImageCount + 1;
    VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount = std::min(surface.minImageCount + 1, most);
    info.imageFormat = format_.format;
    info.imageColorSpace = format_.colorSpace;
    info.imageExtent = extent;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (readable_) info.imageUsage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    info.preTransform = surface.currentTransform;
    info.compositeAlpha = composite_alpha(surface.supportedCompositeAlpha);
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    // Hidden pixels too are drawn, for screenshots.
    info.clipped = VK_FALSE;
    info.oldSwapchain = handle_.get();
    VkSwapchainKHR handle = VK_NULL_HANDLE;
    check(vkCreateSwapchainKHR(device_.get(), &info, nullptr, &handle), "vkCreateSwapchainKHR");
    images_.clear();
    handle_ = SwapchainHandle(device_.get(), handle);
    extent_ = extent;

    std::uint32_t count = 0;
    check(vkGetSwapchainImagesKHR(device_.get(), handle, &count, nullptr),
          "vkGetSwapchainImagesKHR");
    std::vector<VkImage> images(count);
    check(vkGetSwapchainImagesKHR(device_.get(), handle, &count, images.data()),
          "vkGetSwapchainImagesKHR");
    for (const VkImage image : images) {
        images_.push_back({image, make_image_view(device_, image, {.format = format_.format}),
                           make_semaphore(device_)});
    }
}

std::optional<std::uint32_t> Swapchain::acquire(VkSemaphore available) {
    std::uint32_t index = 0;
    const VkResult result = vkAcquireNextImageKHR(device_.get(), handle_.get(), kAcquireTimeout,
                                                  available, VK_NULL_HANDLE, &index);
    if (result == VK_TIMEOUT || result == VK_NOT_READY) return std::nullopt;
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
        stale_ = true;
        return std::nullopt;
    }
    if (result == VK_SUBOPTIMAL_KHR) {
        // The image can still be shown, and `available` will be signalled.
        stale_ = true;
    } else {
        check(result, "vkAcquireNextImageKHR");
    }
    return index;
}

void Swapchain::present(std::uint32_t index) {
    const VkSwapchainKHR handle = handle_.get();
    const VkSemaphore semaphore = rendered(index);
    const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                .waitSemaphoreCount = 1,
                                .pWaitSemaphores = &semaphore,
                                .swapchainCount = 1,
                                .pSwapchains = &handle,
                                .pImageIndices = &index};
    const VkResult result = vkQueuePresentKHR(device_.queue().get(), &info);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) {
        stale_ = true;
    } else {
        check(result, "vkQueuePresentKHR");
    }
}

}  // namespace cw2
