// The Vulkan instance and device.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cw2/vulkan/handle.h"

namespace cw2 {

/// What Vulkan cannot do here; what() is one line that names the device or the call, and the cause.
class VulkanError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Nothing can be done any more with the device.
class DeviceLost : public VulkanError {
    using VulkanError::VulkanError;
};

/// Throws VulkanError naming `call` unless `result` is VK_SUCCESS; DeviceLost where it says that.
void check(VkResult result, const char* call);

/// The instance; with validation on, every message of the validation layers (synchronisation
/// validation included) is printed to standard error and counted.
class Instance {
 public:
    /// `extensions` are those that presenting to a window needs. Throws VulkanError where there is
    /// no driver, or no validation layer though `validation` asks for it.
    Instance(bool validation, const std::vector<const char*>& extensions);

    VkInstance get() const { return instance_.get(); }
    /// Warnings and errors of the validation layers so far.
    int validation_messages() const { return *message_count_; }
    /// Null without validation.
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name() const { return set_object_name_; }

 private:
    std::unique_ptr<int> message_count_ = std::make_unique<int>(0);
    InstanceHandle instance_;
    DebugMessenger messenger_;
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
};

/// The object types that messages of the validation layers name.
template <typename Handle>
constexpr VkObjectType kObjectType = VK_OBJECT_TYPE_UNKNOWN;
template <>
inline constexpr VkObjectType kObjectType<VkBuffer> = VK_OBJECT_TYPE_BUFFER;
template <>
inline constexpr VkObjectType kObjectType<VkImage> = VK_OBJECT_TYPE_IMAGE;
template <>
inline constexpr VkObjectType kObjectType<VkPipeline> = VK_OBJECT_TYPE_PIPELINE;
template <>
inline constexpr VkObjectType kObjectType<VkDescriptorSet> = VK_OBJECT_TYPE_DESCRIPTOR_SET;

/// Between two timestamps of which that many bits count, in [1, 64]: they start again at 0 at most
/// once.
std::uint64_t elapsed_ticks(std::uint64_t begin, std::uint64_t end, std::uint32_t valid_bits);

/// A line for each physical device: index, name, kind, Vulkan version, and whether cw2 can use it.
std::vector<std::string> describe_devices(const Instance& instance);

/// A device with one queue for graphics and transfer.
class Device {
 public:
    /// Picks a physical device that has what cw2 needs: by `selector` (an index of
    /// describe_devices, or a part of a name in any case), else a discrete GPU before an integrated
    /// one before a virtual one before a CPU. With a `surface` its queue can present there.
    /// Throws VulkanError where there is none.
    Device(const Instance& instance, const std::optional<std::string>& selector,
           VkSurfaceKHR surface = VK_NULL_HANDLE);

    VkDevice get() const { return device_.get(); }
    VkPhysicalDevice physical() const { return physical_; }
    /// For one thread at a time, as vkQueue...() want it.
    class Queue {
     public:
        explicit Queue(const Device& device) : lock_(device.queue_mutex_), queue_(device.queue_) {}
        VkQueue get() const { return queue_; }

     private:
        std::unique_lock<std::mutex> lock_;
        VkQueue queue_;
    };
    /// Waits for whoever has it.
    Queue queue() const { return Queue(*this); }
    /// Waits until the device has nothing to do; once more where that fails, since what it uses is
    /// about to be destroyed.
    VkResult wait_idle() const {
        const Queue no_submissions = queue();
        const VkResult result = vkDeviceWaitIdle(device_.get());
        return result == VK_SUCCESS ? result : vkDeviceWaitIdle(device_.get());
    }
    std::uint32_t queue_family() const { return queue_family_; }
    const VkPhysicalDeviceProperties& properties() const { return properties_; }
    /// Whether images may be in the formats BC1 to BC7.
    bool samples_blocks() const { return samples_blocks_; }
    /// Whether queries may ask for pipeline statistics.
    bool counts_fragments() const { return counts_fragments_; }
    bool is_cpu() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }

    /// How many bits of a timestamp count on the queue; 0 where it has none.
    std::uint32_t timestamp_bits() const { return timestamp_bits_; }

    /// Names an object for the validation layers, if they are on.
    template <typename Handle>
    void name(Handle handle, const std::string& name) const {
        static_assert(kObjectType<Handle> != VK_OBJECT_TYPE_UNKNOWN);
        if (set_object_name_ == nullptr) return;
        set_name(kObjectType<Handle>, reinterpret_cast<std::uint64_t>(handle), name);
    }

    /// The index of a memory type among `type_bits` that has `flags`, or else throws VulkanError.
    std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags flags) const;

 private:
    void set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties_{};
    VkPhysicalDeviceMemoryProperties memory_{};
    std::uint32_t queue_family_ = 0;
    std::uint32_t timestamp_bits_ = 0;
    bool samples_blocks_ = false;
    bool counts_fragments_ = false;
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
    LogicalDevice device_;
    VkQueue queue_ = VK_NULL_HANDLE;
    mutable std::mutex queue_mutex_;
};

}  // namespace cw2
