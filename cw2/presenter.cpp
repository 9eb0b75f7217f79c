#include "cw2/presenter.h"

#include <utility>

namespace cw2 {

namespace {

Fence make_fence(const Device& device) {
    const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkFence fence = VK_NULL_HANDLE;
    check(vkCreateFence(device.get(), &info, nullptr, &fence), "vkCreateFence");
    return {device.get(), fence};
}

void swap_red_and_blue(std::span<std::byte> pixels) {
    for (std::size_t i = 0; i < pixels.size(); i += 4) std::swap(pixels[i], pixels[i + 2]);
}

// Presenting needs no access of ours; the semaphore it waits for makes the image visible to it.
constexpr ImageUse kPresented{VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_2_NONE,
                              VK_ACCESS_2_NONE};
constexpr ImageUse kCopied{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                           VK_ACCESS_2_TRANSFER_READ_BIT};
/// Of the latest frame in the smoothed time.
constexpr double kWeightOfLatest = 0.3;
constexpr VkPipelineStageFlags2 kDrawingStage = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;

}  // namespace

Presenter::Presenter(const Device& device, VkSurfaceKHR surface, const Layouts& layouts,
                     const ShaderCode& code, VkSampleCountFlagBits samples)
    : device_(device),
      swapchain_(device, surface),
      pool_(make_command_pool(device)),
      renderer_(device, layouts, code, swapchain_.format(), samples,
                static_cast<std::uint32_t>(slots_.size())) {
    for (Slot& slot : slots_) {
        slot.commands = allocate_commands(device, pool_.get());
        slot.available = make_semaphore(device);
        slot.drawn = make_fence(device);
    }
}

Presenter::~Presenter() {
    vkDeviceWaitIdle(device_.get());
}

bool Presenter::show(const Scene& scene, const FrameSettings& settings, VkExtent2D window) {
    return draw(scene, settings, window, nullptr);
}

std::optional<Picture> Presenter::show_and_read(const Scene& scene, const FrameSettings& settings,
                                                VkExtent2D window) {
    Buffer pixels;
    if (!draw(scene, settings, window, &pixels)) return std::nullopt;
    finish();
    Picture picture{swapchain_.extent(), {pixels.mapped.begin(), pixels.mapped.end()}};
    if (swapchain_.format() == VK_FORMAT_B8G8R8A8_SRGB) swap_red_and_blue(picture.pixels);
    return picture;
}

bool Presenter::draw(const Scene& scene, const FrameSettings& settings, VkExtent2D window,
                     Buffer* pixels) {
    Slot& slot = slots_[next_slot_];
    wait_for(next_slot_);
    if (!swapchain_.fit(window)) return false;
    const std::optional<std::uint32_t> image = swapchain_.acquire(slot.available.get());
    if (!image) return false;
    if (pixels != nullptr) {
        const VkExtent2D extent = swapchain_.extent();
        *pixels = make_buffer(device_, VkDeviceSize{extent.width} * extent.height * 4,
                              VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
    }
    record(next_slot_, *image, scene, settings, pixels);
    submit(slot, *image);
    slot.in_flight = true;
    next_slot_ = (next_slot_ + 1) % static_cast<std::uint32_t>(slots_.size());
    swapchain_.present(*image);
    return true;
}

void Presenter::record(std::uint32_t slot, std::uint32_t image, const Scene& scene,
                       const FrameSettings& settings, const Buffer* pixels) {
    const VkCommandBuffer commands = slots_[slot].commands;
    begin_commands(commands);
    renderer_.record(commands, slot, scene,
                     {.image = swapchain_.image(image),
                      .view = swapchain_.view(image),
                      .extent = swapchain_.extent(),
                      .available_at = kDrawingStage,
                      .after = pixels != nullptr ? kCopied : kPresented},
                     settings);
    if (pixels != nullptr) {
        read_back(commands, swapchain_.image(image), swapchain_.extent(), *pixels);
        image_barrier(commands, swapchain_.image(image), VK_IMAGE_ASPECT_COLOR_BIT, kCopied,
                      kPresented);
    }
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
}

void Presenter::submit(const Slot& slot, std::uint32_t image) const {
    const VkSemaphoreSubmitInfo available{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                          .semaphore = slot.available.get(),
                                          .stageMask = kDrawingStage};
    const VkSemaphoreSubmitInfo rendered{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                         .semaphore = swapchain_.rendered(image),
                                         .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = slot.commands};
    const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .waitSemaphoreInfoCount = 1,
                             .pWaitSemaphoreInfos = &available,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands,
                             .signalSemaphoreInfoCount = 1,
                             .pSignalSemaphoreInfos = &rendered};
    check(vkQueueSubmit2(device_.queue(), 1, &info, slot.drawn.get()), "vkQueueSubmit2");
}

void Presenter::wait_for(std::uint32_t index) {
    Slot& slot = slots_[index];
    if (!slot.in_flight) return;
    const VkFence fence = slot.drawn.get();
    check(vkWaitForFences(device_.get(), 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vkResetFences(device_.get(), 1, &fence), "vkResetFences");
    slot.in_flight = false;
    if (const std::optional<double> latest = renderer_.gpu_milliseconds(index)) {
        const double mean = gpu_milliseconds_.value_or(*latest);
        gpu_milliseconds_ = mean + kWeightOfLatest * (*latest - mean);
    }
}

void Presenter::finish() {
    // The slot that is next is the one that was drawn into longest ago.
    for (std::uint32_t i = 0; i < slots_.size(); ++i) {
        wait_for((next_slot_ + i) % static_cast<std::uint32_t>(slots_.size()));
    }
}

void Presenter::use_shaders(const ShaderCode& code) {
    finish();
    renderer_.use_shaders(code);
}

}  // namespace cw2
