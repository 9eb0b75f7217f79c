#include "cw2/vulkan/resources.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "mesh-format/layout.h"

namespace cw2 {

namespace {

/// What images that share an allocation take together, at most, unless one alone is larger.
constexpr VkDeviceSize kSharedMemoryBytes = 64u << 20;
constexpr VkDeviceSize kStagingBytes = 32u << 20;
// Suits every block size and vkCmdCopyBufferToImage's rule of 4.
constexpr VkDeviceSize kStagingAlignment = 16;

Memory allocate(const Device& device, const VkMemoryRequirements& requirements, MemoryUse use) {
    std::uint32_t type = 0;
    switch (use) {
        case MemoryUse::device:
            type = device.memory_type(requirements.memoryTypeBits,
                                      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
            break;
        case MemoryUse::upload:
            type = device.memory_type(
                requirements.memoryTypeBits,
                VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
            break;
        case MemoryUse::readback:
            try {
                type = device.memory_type(requirements.memoryTypeBits,
                                          VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                              VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
                                              VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
            } catch (const VulkanError&) {
                return allocate(device, requirements, MemoryUse::upload);
            }
            break;
    }
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .allocationSize = requirements.size,
                                    .memoryTypeIndex = type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    check(vkAllocateMemory(device.get(), &info, nullptr, &memory), "vkAllocateMemory");
    return {device.get(), memory, requirements.size};
}

std::byte* map(const Device& device, const Memory& memory) {
    void* address = nullptr;
    check(vkMapMemory(device.get(), memory.get(), 0, VK_WHOLE_SIZE, 0, &address), "vkMapMemory");
    return static_cast<std::byte*>(address);
}

VkImageAspectFlags aspect_of(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

}  // namespace

Buffer make_buffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage,
                   MemoryUse use) {
    const VkBufferCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    VkBuffer handle = VK_NULL_HANDLE;
    check(vkCreateBuffer(device.get(), &info, nullptr, &handle), "vkCreateBuffer");
    Buffer buffer;
    buffer.handle = BufferHandle(device.get(), handle);
    VkMemoryRequirements requirements;
    vkGetBufferMemoryRequirements(device.get(), handle, &requirements);
    buffer.memory = allocate(device, requirements, use);
    check(vkBindBufferMemory(device.get(), handle, buffer.memory.get(), 0), "vkBindBufferMemory");
    if (use != MemoryUse::device) buffer.mapped = {map(device, buffer.memory), size};
    return buffer;
}

bool host_can_write(const Device& device, const ImageSettings& settings) {
    if (!device.is_cpu()) return false;
    VkFormatProperties format;
    vkGetPhysicalDeviceFormatProperties(device.physical(), settings.format, &format);
    constexpr VkFormatFeatureFlags kSampled =
        VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    if ((format.linearTilingFeatures & kSampled) != kSampled) return false;
    VkImageFormatProperties image{};
    const VkResult result = vkGetPhysicalDeviceImageFormatProperties(
        device.physical(), settings.format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_LINEAR,
        settings.usage, 0, &image);
    return result == VK_SUCCESS && image.maxMipLevels >= settings.mip_count &&
           image.maxExtent.width >= settings.extent.width &&
           image.maxExtent.height >= settings.extent.height;
}

ImageMemory bind_images(const Device& device, std::span<const VkImage> images, bool host_writes) {
    std::vector<VkMemoryRequirements> blocks;
    std::vector<std::pair<std::size_t, VkDeviceSize>> places;  ///< of the images: block and offset
    for (const VkImage image : images) {
        VkMemoryRequirements needs;
        vkGetImageMemoryRequirements(device.get(), image, &needs);
        const auto offset = [&] {
            return (blocks.back().size + needs.alignment - 1) / needs.alignment * needs.alignment;
        };
        if (blocks.empty() || blocks.back().memoryTypeBits != needs.memoryTypeBits ||
            offset() + needs.size > kSharedMemoryBytes) {
            blocks.push_back({0, needs.alignment, needs.memoryTypeBits});
        }
        places.emplace_back(blocks.size() - 1, offset());
        blocks.back().size = places.back().second + needs.size;
        blocks.back().alignment = std::max(blocks.back().alignment, needs.alignment);
    }
    ImageMemory memory;
    std::vector<std::byte*> addresses;
    for (const VkMemoryRequirements& needs : blocks) {
        const MemoryUse use = host_writes ? MemoryUse::upload : MemoryUse::device;
        memory.blocks.push_back(allocate(device, needs, use));
        addresses.push_back(host_writes ? map(device, memory.blocks.back()) : nullptr);
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        const auto [block, offset] = places[i];
        check(vkBindImageMemory(device.get(), images[i], memory.blocks[block].get(), offset),
              "vkBindImageMemory");
        memory.addresses.push_back(host_writes ? addresses[block] + offset : nullptr);
    }
    return memory;
}

LevelPlace level_place(const Device& device, VkImage image, std::uint32_t level) {
    const VkImageSubresource subresource{VK_IMAGE_ASPECT_COLOR_BIT, level, 0};
    VkSubresourceLayout layout;
    vkGetImageSubresourceLayout(device.get(), image, &subresource, &layout);
    return {layout.offset, layout.rowPitch};
}

ImageHandle make_image_handle(const Device& device, const ImageSettings& settings) {
    const VkImageCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = settings.format,
        .extent = {settings.extent.width, settings.extent.height, 1},
        .mipLevels = settings.mip_count,
        .arrayLayers = 1,
        .samples = settings.samples,
        .tiling = settings.host_writes ? VK_IMAGE_TILING_LINEAR : VK_IMAGE_TILING_OPTIMAL,
        .usage = settings.usage};
    VkImage image = VK_NULL_HANDLE;
    check(vkCreateImage(device.get(), &info, nullptr, &image), "vkCreateImage");
    return {device.get(), image};
}

ImageView make_image_view(const Device& device, VkImage image, const ImageSettings& settings) {
    const VkImageViewCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = settings.format,
        .components = {.r = settings.red},
        .subresourceRange = {aspect_of(settings.format), 0, settings.mip_count, 0, 1}};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(device.get(), &info, nullptr, &view), "vkCreateImageView");
    return {device.get(), view};
}

Image make_image(const Device& device, const ImageSettings& settings) {
    Image image;
    image.handle = make_image_handle(device, settings);
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device.get(), image.handle.get(), &requirements);
    image.memory = allocate(device, requirements, MemoryUse::device);
    check(vkBindImageMemory(device.get(), image.handle.get(), image.memory.get(), 0),
          "vkBindImageMemory");
    image.view = make_image_view(device, image.handle.get(), settings);
    return image;
}

void image_barrier(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect,
                   const ImageUse& before, const ImageUse& after) {
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = before.stages,
        .srcAccessMask = before.access,
        .dstStageMask = after.stages,
        .dstAccessMask = after.access,
        .oldLayout = before.layout,
        .newLayout = after.layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .imageMemoryBarrierCount = 1,
                                      .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

void read_back(VkCommandBuffer commands, VkImage image, VkExtent2D extent, const Buffer& buffer) {
    read_back(commands, image, {{0, 0}, extent}, buffer, 0);
}

void read_back(VkCommandBuffer commands, VkImage image, const VkRect2D& area, const Buffer& buffer,
               VkDeviceSize offset) {
    const VkBufferImageCopy copy{.bufferOffset = offset,
                                 .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageOffset = {area.offset.x, area.offset.y, 0},
                                 .imageExtent = {area.extent.width, area.extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           buffer.handle.get(), 1, &copy);
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                   .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .memoryBarrierCount = 1,
                                      .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

DescriptorPool make_descriptor_pool(const Device& device, VkDescriptorType type,
                                    std::uint32_t descriptors, std::uint32_t sets) {
    const VkDescriptorPoolSize size{type, descriptors};
    // Dear ImGui frees its set.
    const VkDescriptorPoolCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
        .maxSets = sets,
        .poolSizeCount = 1,
        .pPoolSizes = &size};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device.get(), &info, nullptr, &pool), "vkCreateDescriptorPool");
    return {device.get(), pool};
}

VkDescriptorSet allocate_set(const Device& device, VkDescriptorPool pool,
                             VkDescriptorSetLayout layout) {
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(vkAllocateDescriptorSets(device.get(), &info, &set), "vkAllocateDescriptorSets");
    return set;
}

CommandPool make_command_pool(const Device& device) {
    const VkCommandPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                       .queueFamilyIndex = device.queue_family()};
    VkCommandPool pool = VK_NULL_HANDLE;
    check(vkCreateCommandPool(device.get(), &info, nullptr, &pool), "vkCreateCommandPool");
    return {device.get(), pool};
}

VkCommandBuffer allocate_commands(const Device& device, VkCommandPool pool) {
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(vkAllocateCommandBuffers(device.get(), &info, &commands), "vkAllocateCommandBuffers");
    return commands;
}

void begin_commands(VkCommandBuffer commands) {
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(commands, &info), "vkBeginCommandBuffer");
}

void submit_and_wait(const Device& device, VkCommandBuffer commands) {
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = commands};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &buffer};
    const Device::Queue queue = device.queue();
    const VkResult submitted = vkQueueSubmit2(queue.get(), 1, &submit, VK_NULL_HANDLE);
    const VkResult waited = submitted == VK_SUCCESS ? vkQueueWaitIdle(queue.get()) : submitted;
    // What the commands use is about to be destroyed.
    if (waited != VK_SUCCESS) vkDeviceWaitIdle(device.get());
    check(submitted, "vkQueueSubmit2");
    check(waited, "vkQueueWaitIdle");
}

Uploader::Uploader(const Device& device)
    : device_(device),
      staging_(
          make_buffer(device, kStagingBytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload)),
      pool_(make_command_pool(device)),
      commands_(allocate_commands(device, pool_.get())) {
    device_.name(staging_.handle.get(), "staging");
    begin_commands(commands_);
}

void Uploader::flush() {
    submit_and_wait(device_, commands_);
    begin_commands(commands_);
    used_ = 0;
}

void Uploader::finish() {
    // Nothing waits for these copies but later submissions on the same queue.
    const VkMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
        .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT,
        .dstAccessMask = VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .memoryBarrierCount = 1,
                                      .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands_, &dependency);
    flush();
}

VkDeviceSize Uploader::stage(VkDeviceSize size) {
    if (used_ + size > kStagingBytes) flush();
    const VkDeviceSize offset = used_;
    used_ = (offset + size + kStagingAlignment - 1) / kStagingAlignment * kStagingAlignment;
    return offset;
}

void Uploader::write_buffer(VkBuffer buffer, std::span<const std::byte> bytes) {
    VkDeviceSize done = 0;
    while (done < bytes.size()) {
        const auto piece = bytes.subspan(done, std::min(bytes.size() - done, kStagingBytes));
        const VkBufferCopy copy{
            .srcOffset = stage(piece.size()), .dstOffset = done, .size = piece.size()};
        std::memcpy(staging_.mapped.data() + copy.srcOffset, piece.data(), piece.size());
        vkCmdCopyBuffer(commands_, staging_.handle.get(), buffer, 1, &copy);
        done += piece.size();
    }
}

void Uploader::write_image(VkImage image, const ImageSettings& settings, TexelBlock block,
                           const WriteRows& write_rows) {
    const ImageUse written{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                           VK_ACCESS_2_TRANSFER_WRITE_BIT};
    image_barrier(commands_, image, VK_IMAGE_ASPECT_COLOR_BIT,
                  {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE}, written);
    for (std::uint32_t level = 0; level < settings.mip_count; ++level) {
        const std::uint32_t width = mesh_format::mip_extent(settings.extent.width, level);
        const std::uint32_t height = mesh_format::mip_extent(settings.extent.height, level);
        const std::size_t row_bytes =
            std::size_t{(width + block.extent - 1) / block.extent} * block.bytes;
        const std::uint32_t row_count = (height + block.extent - 1) / block.extent;
        assert(row_bytes > 0);
        const auto rows_at_once = static_cast<std::uint32_t>(kStagingBytes / row_bytes) & ~3u;
        for (std::uint32_t row = 0; row < row_count; row += rows_at_once) {
            const std::uint32_t rows = std::min(rows_at_once, row_count - row);
            const std::uint32_t y = row * block.extent;
            const VkBufferImageCopy copy{
                .bufferOffset = stage(rows * row_bytes),
                .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
                .imageOffset = {0, static_cast<std::int32_t>(y), 0},
                .imageExtent = {width, std::min(rows * block.extent, height - y), 1}};
            write_rows(level, row, rows, staging_.mapped.data() + copy.bufferOffset);
            vkCmdCopyBufferToImage(commands_, staging_.handle.get(), image,
                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
        }
    }
    image_barrier(commands_, image, VK_IMAGE_ASPECT_COLOR_BIT, written,
                  {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                   VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT});
}

}  // namespace cw2
