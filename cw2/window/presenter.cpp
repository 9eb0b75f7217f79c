#include "cw2/window/presenter.h"

#include <chrono>
#include <utility>

#include "cw2/render/legend.h"

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
/// An image of the swapchain, whose availability the copy waits for; its old contents are lost.
constexpr ImageUse kAcquired{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_COPY_BIT,
                             VK_ACCESS_2_NONE};
constexpr ImageUse kCopiedFrom{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr ImageUse kCopiedTo{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                             VK_ACCESS_2_TRANSFER_WRITE_BIT};
/// Waits for the device, also where something fails.
struct WaitAtEnd {
    const Device& device;
    ~WaitAtEnd() { device.wait_idle(); }
};

/// Of the latest frame in the smoothed time.
constexpr double kWeightOfLatest = 0.3;

std::optional<double> smoothed(std::optional<double> mean, std::optional<double> latest) {
    return mean && latest ? *mean + kWeightOfLatest * (*latest - *mean) : latest;
}

}  // namespace

Presenter::Presenter(const Device& device, VkSurfaceKHR surface, const Layouts& layouts,
                     const ShaderCode& code, std::uint32_t samples)
    : device_(device),
      swapchain_(device, surface),
      pool_(make_command_pool(device)),
      averager_(device, layouts, code, kSlots),
      samples_(samples) {
    if (!device.is_cpu()) {
        quick_.emplace(device, layouts, code, swapchain_.format(), VK_SAMPLE_COUNT_4_BIT, kSlots);
    }
    for (Slot& slot : slots_) {
        slot.commands = allocate_commands(device, pool_.get());
        slot.available = make_semaphore(device);
        slot.done = make_fence(device);
    }
}

Presenter::~Presenter() {
    device_.wait_idle();
}

bool Presenter::show(const WindowContents& contents, VkExtent2D window) {
    return draw(contents, window, nullptr);
}

std::optional<Picture> Presenter::show_and_read(const WindowContents& contents, VkExtent2D window,
                                                const PictureBytes& form) {
    if (!show(contents, window)) return std::nullopt;
    finish_mean(contents);
    const VkExtent2D extent = picture_extent_;
    const Buffer pixels = make_buffer(device_, VkDeviceSize{extent.width} * extent.height * 4,
                                      VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
    const VkCommandBuffer commands = slots_[next_slot_].commands;
    begin_commands(commands);
    read_back(commands, averager_.encode(commands, form), extent, pixels);
    submit_and_wait(device_, commands);
    Picture picture{extent, {pixels.mapped.begin(), pixels.mapped.end()}};
    draw_legends(picture.pixels, extent.width, extent.height, contents.settings);
    return picture;
}

std::optional<Picture> Presenter::show_and_read_window(const WindowContents& contents,
                                                       VkExtent2D window) {
    if (!show(contents, window)) return std::nullopt;
    finish_mean(contents);
    WindowContents again = contents;
    again.redraw = false;
    Buffer pixels;
    const WaitAtEnd until_they_are_written{device_};
    if (!draw(again, window, &pixels)) return std::nullopt;
    finish();
    Picture picture{swapchain_.extent(), {pixels.mapped.begin(), pixels.mapped.end()}};
    if (swapchain_.format() == VK_FORMAT_B8G8R8A8_SRGB) swap_red_and_blue(picture.pixels);
    return picture;
}

void Presenter::finish_mean(const WindowContents& contents) {
    finish();
    const VkCommandBuffer commands = slots_[next_slot_].commands;
    while (sampled_ < samples_) {
        begin_commands(commands);
        record_sample(next_slot_, contents, sampled_, samples_);
        ++sampled_;
        submit_and_wait(device_, commands);
    }
}

void Presenter::fit_picture() {
    const VkExtent2D extent = swapchain_.extent();
    if (extent.width == picture_extent_.width && extent.height == picture_extent_.height) return;
    finish();
    picture_ = make_image(
        device_, {.format = swapchain_.format(),
                  .extent = extent,
                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                           VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    picture_extent_ = extent;
    has_picture_ = false;
}

bool Presenter::draw(const WindowContents& contents, VkExtent2D window, Buffer* pixels) {
    wait_for(next_slot_);
    if (!swapchain_.fit(window)) return false;
    fit_picture();
    Slot& slot = slots_[next_slot_];
    const std::optional<std::uint32_t> image = swapchain_.acquire(slot.available.get());
    if (!image) return false;
    if (pixels != nullptr) {
        const VkExtent2D extent = swapchain_.extent();
        *pixels = make_buffer(device_, VkDeviceSize{extent.width} * extent.height * 4,
                              VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
    }
    const auto start = std::chrono::steady_clock::now();
    begin_commands(slot.commands);
    record_scene(next_slot_, contents);
    record_window(next_slot_, *image, contents.panel, pixels);
    check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
    submit(slot, *image);
    slot.cpu =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    slot.in_flight = true;
    next_slot_ = (next_slot_ + 1) % kSlots;
    swapchain_.present(*image);
    return true;
}

void Presenter::record_scene(std::uint32_t index, const WindowContents& contents) {
    Slot& slot = slots_[index];
    slot.drawn = nullptr;
    if (contents.redraw || !has_picture_) {
        sampled_ = samples_ == 1 ? 1 : 0;
        shows_mean_ = sampled_ == samples_;
        if (quick_ && !shows_mean_) {
            quick_->record(slot.commands, index, contents.scene,
                           {.image = picture_.handle.get(),
                            .view = picture_.view.get(),
                            .extent = picture_extent_,
                            .available_at = kCopiedFrom.stages,
                            .after = kCopiedFrom},
                           contents.settings);
            record_legends(slot, contents.settings);
            slot.drawn = &*quick_;
        } else {
            slot.drawn = &record_sample(index, contents, 0, 1);
            record_picture(slot, contents.settings);
        }
        has_picture_ = true;
    } else if (!shows_mean_) {
        if (sampled_ < samples_) {
            slot.drawn = &record_sample(index, contents, sampled_, samples_);
            ++sampled_;
        }
        if (sampled_ == samples_) {
            record_picture(slot, contents.settings);
            shows_mean_ = true;
        }
    }
    if (slot.drawn == nullptr) return;
    counts_ = slot.drawn->counts();
    slot.builds_pipelines = counts_.new_pipelines;
}

const Renderer& Presenter::record_sample(std::uint32_t slot, const WindowContents& contents,
                                         std::uint32_t index, std::uint32_t count) {
    averager_.add(slots_[slot].commands, slot, contents.scene, contents.settings, picture_extent_,
                  index, count, true);
    return averager_.renderer();
}

/// Makes the mean the picture.
void Presenter::record_picture(Slot& slot, const FrameSettings& settings) {
    const VkImage bytes = averager_.encode(
        slot.commands, {.blue_green_red = swapchain_.format() == VK_FORMAT_B8G8R8A8_SRGB});
    const VkImage picture = picture_.handle.get();
    image_barrier(slot.commands, picture, VK_IMAGE_ASPECT_COLOR_BIT,
                  {VK_IMAGE_LAYOUT_UNDEFINED, kCopiedFrom.stages, VK_ACCESS_2_NONE}, kCopiedTo);
    const VkImageSubresourceLayers layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    const VkImageCopy copy{.srcSubresource = layers,
                           .dstSubresource = layers,
                           .extent = {picture_extent_.width, picture_extent_.height, 1}};
    vkCmdCopyImage(slot.commands, bytes, kCopiedFrom.layout, picture, kCopiedTo.layout, 1, &copy);
    image_barrier(slot.commands, picture, VK_IMAGE_ASPECT_COLOR_BIT, kCopiedTo, kCopiedFrom);
    record_legends(slot, settings);
}

void Presenter::record_legends(Slot& slot, const FrameSettings& settings) {
    if (!settings.false_color) return;
    const auto [width, height] = picture_extent_;
    const VkDeviceSize bytes = VkDeviceSize{width} * height * 4;
    if (slot.legends.mapped.size() != bytes) {
        slot.legends =
            make_buffer(device_, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload);
    }
    const std::span<std::byte> pixels = slot.legends.mapped;
    std::vector<VkBufferImageCopy> copies;
    for (const PixelArea& area : draw_legends(pixels, width, height, settings)) {
        const std::size_t first = (std::size_t{area.top} * width + area.left) * 4;
        if (swapchain_.format() == VK_FORMAT_B8G8R8A8_SRGB) {
            for (std::size_t row = 0; row < area.height; ++row) {
                swap_red_and_blue(
                    pixels.subspan(first + row * width * 4, std::size_t{area.width} * 4));
            }
        }
        copies.push_back({.bufferOffset = first,
                          .bufferRowLength = width,
                          .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                          .imageOffset = {static_cast<std::int32_t>(area.left),
                                          static_cast<std::int32_t>(area.top), 0},
                          .imageExtent = {area.width, area.height, 1}});
    }
    if (copies.empty()) return;
    const VkImage picture = picture_.handle.get();
    image_barrier(slot.commands, picture, VK_IMAGE_ASPECT_COLOR_BIT, kCopiedFrom, kCopiedTo);
    vkCmdCopyBufferToImage(slot.commands, slot.legends.handle.get(), picture, kCopiedTo.layout,
                           static_cast<std::uint32_t>(copies.size()), copies.data());
    image_barrier(slot.commands, picture, VK_IMAGE_ASPECT_COLOR_BIT, kCopiedTo, kCopiedFrom);
}

void Presenter::record_window(std::uint32_t slot, std::uint32_t image, UiPass* panel,
                              const Buffer* pixels) {
    const VkCommandBuffer commands = slots_[slot].commands;
    const VkImage target = swapchain_.image(image);
    const auto barrier = [&](const ImageUse& before, const ImageUse& after) {
        image_barrier(commands, target, VK_IMAGE_ASPECT_COLOR_BIT, before, after);
    };
    barrier(kAcquired, kCopiedTo);
    const VkImageSubresourceLayers layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    const VkImageCopy copy{.srcSubresource = layers,
                           .dstSubresource = layers,
                           .extent = {picture_extent_.width, picture_extent_.height, 1}};
    vkCmdCopyImage(commands, picture_.handle.get(), kCopiedFrom.layout, target, kCopiedTo.layout, 1,
                   &copy);
    ImageUse last = kCopiedTo;
    if (panel != nullptr) {
        barrier(last, kColorAttachmentUse);
        panel->record(commands, slot, swapchain_.view(image), swapchain_.extent());
        last = kColorAttachmentUse;
    }
    if (pixels != nullptr) {
        barrier(last, kCopiedFrom);
        read_back(commands, target, swapchain_.extent(), *pixels);
        last = kCopiedFrom;
    }
    barrier(last, kPresented);
}

void Presenter::submit(const Slot& slot, std::uint32_t image) const {
    const VkSemaphoreSubmitInfo available{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                          .semaphore = slot.available.get(),
                                          .stageMask = VK_PIPELINE_STAGE_2_COPY_BIT};
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
    check(vkQueueSubmit2(device_.queue().get(), 1, &info, slot.done.get()), "vkQueueSubmit2");
}

void Presenter::wait_for(std::uint32_t index) {
    Slot& slot = slots_[index];
    if (!slot.in_flight) return;
    const VkFence fence = slot.done.get();
    check(vkWaitForFences(device_.get(), 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vkResetFences(device_.get(), 1, &fence), "vkResetFences");
    slot.in_flight = false;
    if (slot.drawn != nullptr) take_times(slot, slot.drawn->gpu_milliseconds(index));
}

void Presenter::take_times(const Slot& slot, std::optional<double> gpu) {
    if (slot.builds_pipelines && !times_are_cold_) return;
    const FrameTimes before = times_are_cold_ ? FrameTimes{} : times_;
    times_ = {smoothed(before.cpu, slot.cpu), smoothed(before.gpu, gpu)};
    times_are_cold_ = slot.builds_pipelines;
}

void Presenter::finish() {
    // The slot that is next is the one that was drawn into longest ago.
    for (std::uint32_t i = 0; i < kSlots; ++i) wait_for((next_slot_ + i) % kSlots);
}

void Presenter::use_shaders(const ShaderCode& code) {
    finish();
    averager_.use_shaders(code);
    if (quick_) quick_->use_shaders(code);
}

VkDeviceSize Presenter::memory_bytes() const {
    return picture_.memory.bytes() + averager_.memory_bytes() +
           (quick_ ? quick_->memory_bytes() : 0);
}

}  // namespace cw2
