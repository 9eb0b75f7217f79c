// Owners of Vulkan handles: the one place that destroys anything.
#pragma once

#include <vulkan/vulkan.h>

#include <utility>

namespace cw2 {

/// Owns a handle that was made from a device, and destroys it on that device; movable, empty by
/// default.
template <typename T, void(VKAPI_PTR* Destroy)(VkDevice, T, const VkAllocationCallbacks*)>
class DeviceHandle {
 public:
    DeviceHandle() = default;
    DeviceHandle(VkDevice device, T handle) : device_(device), handle_(handle) {}
    ~DeviceHandle() {
        if (handle_ != VK_NULL_HANDLE) Destroy(device_, handle_, nullptr);
    }
    DeviceHandle(DeviceHandle&& other) noexcept
        : device_(other.device_), handle_(std::exchange(other.handle_, T{})) {}
    DeviceHandle& operator=(DeviceHandle&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        return *this;
    }

    T get() const { return handle_; }
    explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
    VkDevice device_ = VK_NULL_HANDLE;
    T handle_ = VK_NULL_HANDLE;
};

using BufferHandle = DeviceHandle<VkBuffer, vkDestroyBuffer>;
using ImageHandle = DeviceHandle<VkImage, vkDestroyImage>;
using ImageView = DeviceHandle<VkImageView, vkDestroyImageView>;
using Sampler = DeviceHandle<VkSampler, vkDestroySampler>;
using DescriptorSetLayout = DeviceHandle<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using DescriptorPool = DeviceHandle<VkDescriptorPool, vkDestroyDescriptorPool>;
using PipelineLayout = DeviceHandle<VkPipelineLayout, vkDestroyPipelineLayout>;
using Pipeline = DeviceHandle<VkPipeline, vkDestroyPipeline>;
using ShaderModule = DeviceHandle<VkShaderModule, vkDestroyShaderModule>;
using CommandPool = DeviceHandle<VkCommandPool, vkDestroyCommandPool>;
using Fence = DeviceHandle<VkFence, vkDestroyFence>;
using Semaphore = DeviceHandle<VkSemaphore, vkDestroySemaphore>;
using QueryPool = DeviceHandle<VkQueryPool, vkDestroyQueryPool>;
using RenderPass = DeviceHandle<VkRenderPass, vkDestroyRenderPass>;
using Framebuffer = DeviceHandle<VkFramebuffer, vkDestroyFramebuffer>;
using SwapchainHandle = DeviceHandle<VkSwapchainKHR, vkDestroySwapchainKHR>;

/// Owns device memory and knows its size.
class Memory {
 public:
    Memory() = default;
    Memory(VkDevice device, VkDeviceMemory memory, VkDeviceSize bytes)
        : handle_(device, memory), bytes_(bytes) {}

    VkDeviceMemory get() const { return handle_.get(); }
    VkDeviceSize bytes() const { return bytes_; }

 private:
    DeviceHandle<VkDeviceMemory, vkFreeMemory> handle_;
    VkDeviceSize bytes_ = 0;
};

/// Owns what is destroyed by itself alone (instance, device).
template <typename T, void(VKAPI_PTR* Destroy)(T, const VkAllocationCallbacks*)>
class RootHandle {
 public:
    RootHandle() = default;
    explicit RootHandle(T handle) : handle_(handle) {}
    ~RootHandle() {
        if (handle_ != VK_NULL_HANDLE) Destroy(handle_, nullptr);
    }
    RootHandle(RootHandle&& other) noexcept : handle_(std::exchange(other.handle_, T{})) {}
    RootHandle& operator=(RootHandle&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }

    T get() const { return handle_; }

 private:
    T handle_ = VK_NULL_HANDLE;
};

using InstanceHandle = RootHandle<VkInstance, vkDestroyInstance>;
using LogicalDevice = RootHandle<VkDevice, vkDestroyDevice>;

/// Owns what was made from an instance.
template <typename T>
class InstanceChild {
 public:
    using Destroy = void(VKAPI_PTR*)(VkInstance, T, const VkAllocationCallbacks*);
    InstanceChild() = default;
    InstanceChild(VkInstance instance, T handle, Destroy destroy)
        : instance_(instance), handle_(handle), destroy_(destroy) {}
    ~InstanceChild() {
        if (handle_ != VK_NULL_HANDLE) destroy_(instance_, handle_, nullptr);
    }
    InstanceChild(InstanceChild&& other) noexcept
        : instance_(other.instance_),
          handle_(std::exchange(other.handle_, T{})),
          destroy_(other.destroy_) {}
    InstanceChild& operator=(InstanceChild&& other) noexcept {
        std::swap(instance_, other.instance_);
        std::swap(handle_, other.handle_);
        std::swap(destroy_, other.destroy_);
        return *this;
    }

    T get() const { return handle_; }

 private:
    VkInstance instance_ = VK_NULL_HANDLE;
    T handle_ = VK_NULL_HANDLE;
    Destroy destroy_ = nullptr;
};

using DebugMessenger = InstanceChild<VkDebugUtilsMessengerEXT>;
using SurfaceHandle = InstanceChild<VkSurfaceKHR>;

/// The function pointer that destroys a DebugMessenger of `instance`.
inline DebugMessenger::Destroy messenger_destroyer(VkInstance instance) {
    return reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
}

/// The function pointer that destroys a SurfaceHandle.
inline constexpr SurfaceHandle::Destroy kDestroySurface = vkDestroySurfaceKHR;

}  // namespace cw2
