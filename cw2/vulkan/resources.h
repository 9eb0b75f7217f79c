// Buffers, images, and the way into them.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"

namespace cw2 {

/// A buffer with memory of its own; `mapped` is its memory where the host may see it.
struct Buffer {
    Memory memory;
    BufferHandle handle;
    std::span<std::byte> mapped;
};

enum class MemoryUse {
    device,    ///< read and written by the device alone
    upload,    ///< written by the host, coherent
    readback,  ///< read by the host, coherent and cached where that exists
};

/// `size` bytes, at least 1. Throws VulkanError.
Buffer make_buffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage,
                   MemoryUse use);

/// A 2D image with memory of its own and a view of all its levels.
struct Image {
    Memory memory;
    ImageHandle handle;
    ImageView view;
};

struct ImageSettings {
    VkFormat format{};
    VkExtent2D extent{};
    std::uint32_t mip_count = 1;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    VkImageUsageFlags usage = 0;
    VkComponentSwizzle red = VK_COMPONENT_SWIZZLE_IDENTITY;  ///< what a view shows as red
    bool host_writes = false;                                ///< see host_can_write()
};

/// Whether the host can write the contents of such an image in place: where the device is the CPU,
/// and it samples images whose rows lie one after the other.
bool host_can_write(const Device& device, const ImageSettings& settings);

/// An image and its memory. Throws VulkanError.
Image make_image(const Device& device, const ImageSettings& settings);

/// The memory of images.
struct ImageMemory {
    std::vector<Memory> blocks;
    std::vector<std::byte*> addresses;  ///< of the images, if the host writes them
};

/// Binds images to a few allocations, which must outlive their use, each shared by images that
/// follow each other: devices allow as few as 4096 allocations. Throws VulkanError.
ImageMemory bind_images(const Device& device, std::span<const VkImage> images, bool host_writes);

/// Where a level of an image that the host writes begins, and the bytes from a row to the next.
struct LevelPlace {
    VkDeviceSize offset;
    VkDeviceSize pitch;
};
LevelPlace level_place(const Device& device, VkImage image, std::uint32_t level);

/// An image without memory or view.
ImageHandle make_image_handle(const Device& device, const ImageSettings& settings);
ImageView make_image_view(const Device& device, VkImage image, const ImageSettings& settings);

/// What is done to an image before and after a barrier.
struct ImageUse {
    VkImageLayout layout;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
};
inline constexpr ImageUse kColorAttachmentUse{
    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT};

void image_barrier(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect,
                   const ImageUse& before, const ImageUse& after);

/// Copies level 0 of a colour image, in layout TRANSFER_SRC_OPTIMAL, to the start of `buffer`,
/// tightly packed, for the host to read once the commands are done.
void read_back(VkCommandBuffer commands, VkImage image, VkExtent2D extent, const Buffer& buffer);
/// The same for an area of it, to `offset` in the buffer.
void read_back(VkCommandBuffer commands, VkImage image, const VkRect2D& area, const Buffer& buffer,
               VkDeviceSize offset);

/// A pool for `sets` descriptor sets that together hold `descriptors` of one type.
DescriptorPool make_descriptor_pool(const Device& device, VkDescriptorType type,
                                    std::uint32_t descriptors, std::uint32_t sets);
VkDescriptorSet allocate_set(const Device& device, VkDescriptorPool pool,
                             VkDescriptorSetLayout layout);

/// A pool whose command buffers are recorded anew each time.
CommandPool make_command_pool(const Device& device);
VkCommandBuffer allocate_commands(const Device& device, VkCommandPool pool);
void begin_commands(VkCommandBuffer commands);
/// Ends `commands`, submits them, and waits until the device has run them.
void submit_and_wait(const Device& device, VkCommandBuffer commands);

/// A square of texels that an image holds as one: `extent` texels a side; 1 without compression.
struct TexelBlock {
    std::uint32_t extent;
    std::uint32_t bytes;
};

/// Copies from host memory into buffers and images through a staging buffer of bounded size.
class Uploader {
 public:
    explicit Uploader(const Device& device);

    void write_buffer(VkBuffer buffer, std::span<const std::byte> bytes);
    /// Writes `count` rows of blocks of `level`, tightly packed, to `out`; the first is a multiple
    /// of 4, and so is the count unless the level ends with them.
    using WriteRows = std::function<void(std::uint32_t level, std::uint32_t first,
                                         std::uint32_t count, std::byte* out)>;
    /// Writes every level of `image`, which was undefined and is then ready to be sampled.
    void write_image(VkImage image, const ImageSettings& settings, TexelBlock block,
                     const WriteRows& write_rows);
    /// Waits until the device has done every copy.
    void finish();

 private:
    /// The offset of `size` bytes of the staging buffer. Flushes when it is full.
    VkDeviceSize stage(VkDeviceSize size);
    void flush();

    const Device& device_;
    Buffer staging_;
    VkDeviceSize used_ = 0;
    CommandPool pool_;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

}  // namespace cw2
