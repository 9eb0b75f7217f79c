// A Vulkan layer under which one call of a function fails, and which counts the objects that live.
// It stands between the validation layer, which sees its errors, and the driver, which does not.
//
// VULKAN_FAULT="vkCreateBuffer 3 -2": the third call of vkCreateBuffer returns VkResult -2, and
// after VK_ERROR_DEVICE_LOST all that can say so do. VULKAN_FAULT_AFTER=FILE: the third of those
// that come once there is that file. VULKAN_REPORT=FILE: when the instance is destroyed, "call NAME
// COUNT" of each function, "live TYPE COUNT" of each type with objects left, and "failed" if the
// fault has struck.
#include <unistd.h>
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

std::atomic<bool> has_failed = false;
std::atomic<bool> is_lost = false;

/// Of VULKAN_FAULT.
struct Fault {
    char name[64]{};
    long number = 0;
    int result = VK_SUCCESS;
    const char* after = std::getenv("VULKAN_FAULT_AFTER");

    bool awaited() const { return after != nullptr && access(after, F_OK) != 0; }
    Fault() {
        const char* const text = std::getenv("VULKAN_FAULT");
        if (text != nullptr && std::sscanf(text, "%63s %ld %d", name, &number, &result) != 3)
            std::abort();
    }
} const fault;

enum Trait : unsigned {
    kPlain = 0,
    /// Can say that the device is lost.
    kLosable = 1,
    /// Waits, or has an effect where it fails, too: the driver is asked all the same.
    kActs = 2,
};

struct Function {
    const char* name;
    unsigned traits;
    PFN_vkVoidFunction next = nullptr;
    std::atomic<long> calls = 0;
    std::atomic<long> counted = 0;  ///< towards the fault

    /// What this call is to return; VK_SUCCESS: what the driver does.
    VkResult due() {
        ++calls;
        if (is_lost && (traits & kLosable) != 0) return VK_ERROR_DEVICE_LOST;
        if (std::strcmp(name, fault.name) != 0 || fault.awaited()) return VK_SUCCESS;
        if (++counted != fault.number) return VK_SUCCESS;
        has_failed = true;
        const auto result = static_cast<VkResult>(fault.result);
        if (result == VK_ERROR_DEVICE_LOST) is_lost = true;
        return result;
    }
};

template <Function& function, typename Type>
struct Failing;

/// Fails when it is due.
template <Function& function, typename... Arguments>
struct Failing<function, VkResult(VKAPI_PTR*)(Arguments...)> {
    static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
        const VkResult due = function.due();
        const auto next = reinterpret_cast<VkResult(VKAPI_PTR*)(Arguments...)>(function.next);
        if (due == VK_SUCCESS) return next(arguments...);
        // What is no error succeeds; VK_TIMEOUT and VK_NOT_READY give nothing.
        if (due == VK_SUBOPTIMAL_KHR || (function.traits & kActs) != 0) next(arguments...);
        return due;
    }
};

struct Type {
    const char* name;
    std::atomic<long> live = 0;
};

/// Counts what it makes: one where its last argument is the place of one handle.
template <Function& function, Type& type, typename Pointer>
struct Making;
template <Function& function, Type& type, typename... Arguments>
struct Making<function, type, VkResult(VKAPI_PTR*)(Arguments...)> {
    static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
        const VkResult result =
            Failing<function, VkResult(VKAPI_PTR*)(Arguments...)>::call(arguments...);
        if (result >= 0) type.live += count(arguments...);
        return result;
    }

 private:
    template <typename... All>
    static long count(const All&...) {
        return 1;
    }
    template <typename Info>
    static long count(VkDevice, VkPipelineCache, std::uint32_t count, const Info*,
                      const VkAllocationCallbacks*, VkPipeline*) {
        return count;
    }
};

template <Function& function, Type& type, typename Pointer>
struct Ending;
template <Function& function, Type& type, typename Owner, typename Handle>
struct Ending<function, type, void(VKAPI_PTR*)(Owner, Handle, const VkAllocationCallbacks*)> {
    static VKAPI_ATTR void VKAPI_CALL call(Owner owner, Handle handle,
                                           const VkAllocationCallbacks* callbacks) {
        using Next = void(VKAPI_PTR*)(Owner, Handle, const VkAllocationCallbacks*);
        if (handle != VK_NULL_HANDLE) --type.live;
        reinterpret_cast<Next>(function.next)(owner, handle, callbacks);
    }
};

/// Which functions there are: of the instance, and of the device.
#define INSTANCE_CALLS(X)                              \
    X(EnumeratePhysicalDevices, kPlain)                \
    X(GetPhysicalDeviceImageFormatProperties, kPlain)  \
    X(GetPhysicalDeviceSurfaceCapabilitiesKHR, kPlain) \
    X(GetPhysicalDeviceSurfaceFormatsKHR, kPlain)      \
    X(GetPhysicalDeviceSurfaceSupportKHR, kPlain)
#define DEVICE_CALLS(X)                  \
    X(AcquireNextImageKHR, kLosable)     \
    X(AllocateCommandBuffers, kPlain)    \
    X(AllocateDescriptorSets, kPlain)    \
    X(BeginCommandBuffer, kPlain)        \
    X(BindBufferMemory, kPlain)          \
    X(BindImageMemory, kPlain)           \
    X(DeviceWaitIdle, kLosable | kActs)  \
    X(EndCommandBuffer, kPlain)          \
    X(FlushMappedMemoryRanges, kPlain)   \
    X(GetFenceStatus, kLosable)          \
    X(GetQueryPoolResults, kLosable)     \
    X(GetSwapchainImagesKHR, kPlain)     \
    X(MapMemory, kPlain)                 \
    X(QueuePresentKHR, kLosable | kActs) \
    X(QueueSubmit, kLosable)             \
    X(QueueSubmit2, kLosable)            \
    X(QueueWaitIdle, kLosable | kActs)   \
    X(ResetCommandPool, kPlain)          \
    X(ResetFences, kPlain)               \
    X(WaitForFences, kLosable | kActs)
#define DEVICE_OBJECTS(X)                                                         \
    X(Buffer, CreateBuffer, DestroyBuffer)                                        \
    X(CommandPool, CreateCommandPool, DestroyCommandPool)                         \
    X(DescriptorPool, CreateDescriptorPool, DestroyDescriptorPool)                \
    X(DescriptorSetLayout, CreateDescriptorSetLayout, DestroyDescriptorSetLayout) \
    X(DeviceMemory, AllocateMemory, FreeMemory)                                   \
    X(Fence, CreateFence, DestroyFence)                                           \
    X(Framebuffer, CreateFramebuffer, DestroyFramebuffer)                         \
    X(Image, CreateImage, DestroyImage)                                           \
    X(ImageView, CreateImageView, DestroyImageView)                               \
    X(PipelineLayout, CreatePipelineLayout, DestroyPipelineLayout)                \
    X(QueryPool, CreateQueryPool, DestroyQueryPool)                               \
    X(RenderPass, CreateRenderPass, DestroyRenderPass)                            \
    X(Sampler, CreateSampler, DestroySampler)                                     \
    X(Semaphore, CreateSemaphore, DestroySemaphore)                               \
    X(ShaderModule, CreateShaderModule, DestroyShaderModule)                      \
    X(SwapchainKHR, CreateSwapchainKHR, DestroySwapchainKHR)

// The functions of a platform's windows, without its header.
using PFN_vkCreateXlibSurfaceKHR = VkResult(VKAPI_PTR*)(VkInstance, const void*,
                                                        const VkAllocationCallbacks*,
                                                        VkSurfaceKHR*);
using PFN_vkCreateXcbSurfaceKHR = PFN_vkCreateXlibSurfaceKHR;

#define DECLARE_FUNCTION(name, traits) Function name##_{"vk" #name, traits};
#define DECLARE_OBJECT(name, make, end)   \
    Type name##Type{#name};               \
    Function make##_{"vk" #make, kPlain}; \
    Function end##_{"vk" #end, kPlain};
INSTANCE_CALLS(DECLARE_FUNCTION)
DEVICE_CALLS(DECLARE_FUNCTION)
DEVICE_OBJECTS(DECLARE_OBJECT)
Type PipelineType{"Pipeline"}, SurfaceType{"Surface"}, InstanceType{"Instance"},
    DeviceType{"Device"};
Function CreateGraphicsPipelines_{"vkCreateGraphicsPipelines", kPlain};
Function CreateComputePipelines_{"vkCreateComputePipelines", kPlain};
Function DestroyPipeline_{"vkDestroyPipeline", kPlain};
Function CreateXlibSurfaceKHR_{"vkCreateXlibSurfaceKHR", kPlain};
Function CreateXcbSurfaceKHR_{"vkCreateXcbSurfaceKHR", kPlain};
Function DestroySurfaceKHR_{"vkDestroySurfaceKHR", kPlain};
Function CreateInstance_{"vkCreateInstance", kPlain};
Function DestroyInstance_{"vkDestroyInstance", kPlain};
Function CreateDevice_{"vkCreateDevice", kPlain};
Function DestroyDevice_{"vkDestroyDevice", kPlain};

PFN_vkGetInstanceProcAddr next_instance_function = nullptr;
PFN_vkGetDeviceProcAddr next_device_function = nullptr;

struct Entry {
    Function& function;
    PFN_vkVoidFunction ours;
    bool of_device;
};
extern const Entry kEntries[];
extern const std::size_t kEntryCount;
#define COUNT_TYPE(name, make, end) &name##Type,
const Type* const kTypes[] = {DEVICE_OBJECTS(COUNT_TYPE) & PipelineType, &SurfaceType,
                              &InstanceType, &DeviceType};

void report() {
    const char* const path = std::getenv("VULKAN_REPORT");
    FILE* const file = path != nullptr ? std::fopen(path, "w") : nullptr;
    if (file == nullptr) return;
    for (std::size_t i = 0; i < kEntryCount; ++i) {
        const Function& function = kEntries[i].function;
        if (function.calls > 0)
            std::fprintf(file, "call %s %ld\n", function.name, function.calls.load());
    }
    for (const Type* type : kTypes)
        if (type->live != 0) std::fprintf(file, "live %s %ld\n", type->name, type->live.load());
    if (has_failed) std::fputs("failed\n", file);
    std::fclose(file);
}

/// The loader's link to the next layer, which it wants to be moved on.
template <typename Link>
Link* link_of(const void* chain, VkStructureType type) {
    auto* info = static_cast<const VkBaseInStructure*>(chain);
    while (info != nullptr &&
           (info->sType != type ||
            reinterpret_cast<const Link*>(info)->function != VK_LAYER_LINK_INFO)) {
        info = info->pNext;
    }
    return const_cast<Link*>(reinterpret_cast<const Link*>(info));
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                               const VkAllocationCallbacks* callbacks,
                                               VkInstance* instance) {
    auto* const link = link_of<VkLayerInstanceCreateInfo>(
        info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    next_instance_function = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    if (const VkResult due = CreateInstance_.due(); due != VK_SUCCESS) {
        report();
        return due;
    }
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(
        next_instance_function(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkResult result = create(info, callbacks, instance);
    if (result != VK_SUCCESS) return result;
    for (std::size_t i = 0; i < kEntryCount; ++i)
        if (!kEntries[i].of_device)
            kEntries[i].function.next =
                next_instance_function(*instance, kEntries[i].function.name);
    ++InstanceType.live;
    report();  // stays if nobody destroys it
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance,
                                            const VkAllocationCallbacks* callbacks) {
    reinterpret_cast<PFN_vkDestroyInstance>(DestroyInstance_.next)(instance, callbacks);
    --InstanceType.live;
    report();
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical,
                                             const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* callbacks,
                                             VkDevice* device) {
    auto* const link =
        link_of<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    next_device_function = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    if (const VkResult due = CreateDevice_.due(); due != VK_SUCCESS) return due;
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(CreateDevice_.next);
    const VkResult result = create(physical, info, callbacks, device);
    if (result != VK_SUCCESS) return result;
    for (std::size_t i = 0; i < kEntryCount; ++i)
        if (kEntries[i].of_device)
            kEntries[i].function.next = next_device_function(*device, kEntries[i].function.name);
    ++DeviceType.live;
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* callbacks) {
    if (device == VK_NULL_HANDLE) return;
    --DeviceType.live;
    reinterpret_cast<PFN_vkDestroyDevice>(DestroyDevice_.next)(device, callbacks);
}

template <typename Ours>
PFN_vkVoidFunction plain(Ours* ours) {
    return reinterpret_cast<PFN_vkVoidFunction>(ours);
}

#define FAILING(name, of_device) {name##_, plain(Failing<name##_, PFN_vk##name>::call), of_device},
#define OF_INSTANCE(name, traits) FAILING(name, false)
#define OF_DEVICE(name, traits) FAILING(name, true)
#define MAKING(make, type, of_device) \
    {make##_, plain(Making<make##_, type##Type, PFN_vk##make>::call), of_device},
#define ENDING(end, type, of_device) \
    {end##_, plain(Ending<end##_, type##Type, PFN_vk##end>::call), of_device},
#define OBJECT_OF_DEVICE(name, make, end) MAKING(make, name, true) ENDING(end, name, true)
const Entry kEntries[] = {
    INSTANCE_CALLS(OF_INSTANCE)                      //
    DEVICE_CALLS(OF_DEVICE)                          //
    DEVICE_OBJECTS(OBJECT_OF_DEVICE)                 //
    MAKING(CreateGraphicsPipelines, Pipeline, true)  //
    MAKING(CreateComputePipelines, Pipeline, true)   //
    ENDING(DestroyPipeline, Pipeline, true)          //
    MAKING(CreateXlibSurfaceKHR, Surface, false)     //
    MAKING(CreateXcbSurfaceKHR, Surface, false)      //
    ENDING(DestroySurfaceKHR, Surface, false)        //
    {CreateInstance_, plain(create_instance), false},
    {DestroyInstance_, plain(destroy_instance), false},
    {CreateDevice_, plain(create_device), false},
    {DestroyDevice_, plain(destroy_device), true},
};
const std::size_t kEntryCount = std::size(kEntries);

/// Null where the next has none: an extension that is not enabled.
PFN_vkVoidFunction function_of(const char* name, PFN_vkVoidFunction next) {
    for (const Entry& entry : kEntries)
        if (std::string_view(entry.function.name) == name) return next ? entry.ours : nullptr;
    return next;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char* name) {
    if (std::string_view(name) == "vkGetDeviceProcAddr") return plain(get_device_function);
    return function_of(name, next_device_function(device, name));
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_function(VkInstance instance,
                                                               const char* name) {
    const std::string_view wanted(name);
    if (wanted == "vkGetInstanceProcAddr") return plain(get_instance_function);
    if (wanted == "vkGetDeviceProcAddr") return plain(get_device_function);
    if (wanted == "vkCreateInstance") return plain(create_instance);
    if (instance == VK_NULL_HANDLE) return nullptr;
    return function_of(name, next_instance_function(instance, name));
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult vkNegotiateLoaderLayerInterfaceVersion(
    VkNegotiateLayerInterface* version) {
    version->loaderLayerInterfaceVersion = 2;
    version->pfnGetInstanceProcAddr = get_instance_function;
    version->pfnGetDeviceProcAddr = get_device_function;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
