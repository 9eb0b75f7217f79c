#include "cw2/vulkan/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <string_view>

namespace cw2 {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data,
                                          void* count) {
    std::fprintf(stderr, "cw2: validation: %s\n", data->pMessage);
    ++*static_cast<int*>(count);
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(int* count) {
    VkDebugUtilsMessengerCreateInfoEXT info{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    info.pfnUserCallback = on_message;
    info.pUserData = count;
    return info;
}

bool contains(const std::vector<VkExtensionProperties>& extensions, const char* name) {
    return std::any_of(extensions.begin(), extensions.end(), [name](const auto& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

bool has_validation_layer() {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
        return std::strcmp(layer.layerName, kValidationLayer) == 0;
    });
}

/// Whether the validation layer has an instance extension.
bool validation_has_extension(const char* name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(kValidationLayer, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateInstanceExtensionProperties(kValidationLayer, &count, extensions.data());
    return contains(extensions, name);
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
    std::uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(instance, &count, devices.data()),
          "vkEnumeratePhysicalDevices");
    return devices;
}

VkPhysicalDeviceProperties properties_of(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    return properties;
}

std::vector<VkQueueFamilyProperties> queue_families_of(VkPhysicalDevice physical) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    return families;
}

/// A queue family for graphics and compute that can present to `surface` if there is one.
std::optional<std::uint32_t> queue_family_of(VkPhysicalDevice physical, VkSurfaceKHR surface) {
    const std::vector<VkQueueFamilyProperties> families = queue_families_of(physical);
    for (std::uint32_t i = 0; i < families.size(); ++i) {
        constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        if ((families[i].queueFlags & kNeeded) != kNeeded) continue;
        VkBool32 presents = VK_TRUE;
        if (surface != VK_NULL_HANDLE) {
            check(vkGetPhysicalDeviceSurfaceSupportKHR(physical, i, surface, &presents),
                  "vkGetPhysicalDeviceSurfaceSupportKHR");
        }
        if (presents) return i;
    }
    return std::nullopt;
}

std::uint32_t timestamp_bits_of(VkPhysicalDevice physical, std::uint32_t family) {
    return queue_families_of(physical)[family].timestampValidBits;
}

bool has_extension(VkPhysicalDevice physical, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    return contains(extensions, name);
}

/// The features that cw2 needs; what a device lacks and what is enabled both follow from this.
struct RequiredFeature {
    const char* name;
    VkBool32 VkPhysicalDeviceVulkan13Features::*feature;
};
constexpr RequiredFeature kRequiredFeatures[] = {
    {"dynamic rendering", &VkPhysicalDeviceVulkan13Features::dynamicRendering},
    {"synchronization2", &VkPhysicalDeviceVulkan13Features::synchronization2},
};

/// What the device lacks for cw2, or an empty string.
std::string missing_feature(VkPhysicalDevice physical, VkSurfaceKHR surface) {
    const VkPhysicalDeviceProperties properties = properties_of(physical);
    if (properties.apiVersion < VK_API_VERSION_1_3) return "no Vulkan 1.3";
    VkPhysicalDeviceVulkan13Features features13{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &features13};
    vkGetPhysicalDeviceFeatures2(physical, &features);
    for (const RequiredFeature& required : kRequiredFeatures) {
        if (!(features13.*required.feature)) return fmt::format("no {}", required.name);
    }
    if (!queue_family_of(physical, surface)) {
        return surface == VK_NULL_HANDLE ? "no graphics queue" : "no queue that presents";
    }
    if (surface != VK_NULL_HANDLE && !has_extension(physical, VK_KHR_SWAPCHAIN_EXTENSION_NAME)) {
        return "no swapchain";
    }
    return {};
}

const char* kind_of(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

/// The name of a result that a user may meet.
std::string name_of(VkResult result) {
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            return "out of host memory";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return "out of device memory";
        case VK_ERROR_INITIALIZATION_FAILED:
            return "initialisation failed";
        case VK_ERROR_DEVICE_LOST:
            return "device lost";
        case VK_ERROR_LAYER_NOT_PRESENT:
            return "layer not present";
        case VK_ERROR_EXTENSION_NOT_PRESENT:
            return "extension not present";
        case VK_ERROR_FEATURE_NOT_PRESENT:
            return "feature not present";
        case VK_ERROR_INCOMPATIBLE_DRIVER:
            return "incompatible driver";
        case VK_ERROR_TOO_MANY_OBJECTS:
            return "too many objects";
        case VK_ERROR_FORMAT_NOT_SUPPORTED:
            return "format not supported";
        case VK_ERROR_SURFACE_LOST_KHR:
            return "surface lost";
        default:
            return fmt::format("VkResult {}", static_cast<int>(result));
    }
}

int preference(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return 4;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return 3;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return 2;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return 1;
        default:
            return 0;
    }
}

bool contains_ignoring_case(std::string_view text, std::string_view part) {
    const auto equal = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) ==
               std::tolower(static_cast<unsigned char>(b));
    };
    return std::search(text.begin(), text.end(), part.begin(), part.end(), equal) != text.end();
}

VkPhysicalDevice selected_device(const std::vector<VkPhysicalDevice>& devices,
                                 const std::string& selector, VkSurfaceKHR surface) {
    std::size_t index = devices.size();
    const char* const end = selector.data() + selector.size();
    const auto parsed = std::from_chars(selector.data(), end, index);
    if (parsed.ec != std::errc{} || parsed.ptr != end) {
        const auto found = std::find_if(devices.begin(), devices.end(), [&](auto physical) {
            return contains_ignoring_case(properties_of(physical).deviceName, selector);
        });
        index = static_cast<std::size_t>(found - devices.begin());
    }
    if (selector.empty() || index >= devices.size()) {
        throw VulkanError(
            fmt::format("no such device '{}'; --list-devices shows what there is", selector));
    }
    const std::string missing = missing_feature(devices[index], surface);
    if (!missing.empty()) {
        throw VulkanError(fmt::format("device '{}' cannot be used: {}",
                                      properties_of(devices[index]).deviceName, missing));
    }
    return devices[index];
}

VkPhysicalDevice best_device(const std::vector<VkPhysicalDevice>& devices, VkSurfaceKHR surface) {
    VkPhysicalDevice best = VK_NULL_HANDLE;
    int best_preference = -1;
    std::string reasons;
    for (const VkPhysicalDevice physical : devices) {
        const VkPhysicalDeviceProperties properties = properties_of(physical);
        const std::string missing = missing_feature(physical, surface);
        if (!missing.empty()) {
            reasons += fmt::format("; {} has {}", properties.deviceName, missing);
        } else if (preference(properties.deviceType) > best_preference) {
            best = physical;
            best_preference = preference(properties.deviceType);
        }
    }
    if (best == VK_NULL_HANDLE) throw VulkanError("no usable Vulkan device" + reasons);
    return best;
}

}  // namespace

void check(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    const std::string message = fmt::format("{} failed: {}", call, name_of(result));
    if (result == VK_ERROR_DEVICE_LOST) throw DeviceLost(message);
    throw VulkanError(message);
}

Instance::Instance(bool validation, const std::vector<const char*>& extensions) {
    if (validation && !has_validation_layer()) {
        throw VulkanError(fmt::format("--validation: layer {} is not installed", kValidationLayer));
    }
    std::vector<const char*> enabled = extensions;
    if (validation) enabled.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    const bool validates_more =
        validation && validation_has_extension(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    if (validates_more) enabled.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);

    VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(message_count_.get());
    const VkValidationFeatureEnableEXT synchronisation =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                     .pNext = &messenger,
                                     .enabledValidationFeatureCount = 1,
                                     .pEnabledValidationFeatures = &synchronisation};
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "cw2",
                                        .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                              .pApplicationInfo = &application};
    info.enabledExtensionCount = static_cast<std::uint32_t>(enabled.size());
    info.ppEnabledExtensionNames = enabled.data();
    if (validation) {
        info.pNext = validates_more ? static_cast<const void*>(&features) : &messenger;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
    }
    VkInstance instance = VK_NULL_HANDLE;
    const VkResult result = vkCreateInstance(&info, nullptr, &instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw VulkanError("no Vulkan driver is installed");
    check(result, "vkCreateInstance");
    instance_ = InstanceHandle(instance);
    if (!validation) return;

    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
    VkDebugUtilsMessengerEXT handle = VK_NULL_HANDLE;
    check(create(instance, &messenger, nullptr, &handle), "vkCreateDebugUtilsMessengerEXT");
    messenger_ = DebugMessenger(instance, handle, messenger_destroyer(instance));
    set_object_name_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
        vkGetInstanceProcAddr(instance, "vkSetDebugUtilsObjectNameEXT"));
}

std::vector<std::string> describe_devices(const Instance& instance) {
    std::vector<std::string> lines;
    for (const VkPhysicalDevice physical : physical_devices(instance.get())) {
        const VkPhysicalDeviceProperties properties = properties_of(physical);
        const std::string missing = missing_feature(physical, VK_NULL_HANDLE);
        lines.push_back(fmt::format("{}: {} ({}, Vulkan {}.{}){}", lines.size(),
                                    properties.deviceName, kind_of(properties.deviceType),
                                    VK_API_VERSION_MAJOR(properties.apiVersion),
                                    VK_API_VERSION_MINOR(properties.apiVersion),
                                    missing.empty() ? "" : ": cannot be used: " + missing));
    }
    return lines;
}

Device::Device(const Instance& instance, const std::optional<std::string>& selector,
               VkSurfaceKHR surface) {
    const std::vector<VkPhysicalDevice> devices = physical_devices(instance.get());
    if (devices.empty()) throw VulkanError("no Vulkan device");
    physical_ =
        selector ? selected_device(devices, *selector, surface) : best_device(devices, surface);
    properties_ = properties_of(physical_);
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
    queue_family_ = *queue_family_of(physical_, surface);
    timestamp_bits_ = timestamp_bits_of(physical_, queue_family_);
    set_object_name_ = instance.set_object_name();

    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = queue_family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    VkPhysicalDeviceFeatures supported;
    vkGetPhysicalDeviceFeatures(physical_, &supported);
    VkPhysicalDeviceVulkan13Features features13{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    for (const RequiredFeature& required : kRequiredFeatures) {
        features13.*required.feature = VK_TRUE;
    }
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &features13};
    features.features.samplerAnisotropy = supported.samplerAnisotropy;
    features.features.textureCompressionBC = supported.textureCompressionBC;
    features.features.pipelineStatisticsQuery = supported.pipelineStatisticsQuery;
    samples_blocks_ = supported.textureCompressionBC;
    counts_fragments_ = supported.pipelineStatisticsQuery;
    VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                            .pNext = &features,
                            .queueCreateInfoCount = 1,
                            .pQueueCreateInfos = &queue};
    const char* const swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    if (surface != VK_NULL_HANDLE) {
        info.enabledExtensionCount = 1;
        info.ppEnabledExtensionNames = &swapchain;
    }
    VkDevice device = VK_NULL_HANDLE;
    check(vkCreateDevice(physical_, &info, nullptr, &device), "vkCreateDevice");
    device_ = LogicalDevice(device);
    vkGetDeviceQueue(device, queue_family_, 0, &queue_);
    // Without the feature no sampler may ask for anisotropy.
    if (!supported.samplerAnisotropy) properties_.limits.maxSamplerAnisotropy = 1.0f;
}

std::uint64_t elapsed_ticks(std::uint64_t begin, std::uint64_t end, std::uint32_t valid_bits) {
    return (end - begin) & (~std::uint64_t{0} >> (64 - valid_bits));
}

void Device::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
    const VkDebugUtilsObjectNameInfoEXT info{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
        .objectType = type,
        .objectHandle = handle,
        .pObjectName = name.c_str()};
    check(set_object_name_(device_.get(), &info), "vkSetDebugUtilsObjectNameEXT");
}

std::uint32_t Device::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags flags) const {
    for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
        if ((type_bits & (1u << i)) && (memory_.memoryTypes[i].propertyFlags & flags) == flags) {
            return i;
        }
    }
    throw VulkanError(fmt::format("device '{}' has no memory type with flags {:#x}",
                                  properties_.deviceName, flags));
}

}  // namespace cw2
