#include "cw2/render/averager.h"

#include <cmath>
#include <span>

#include "add_frame.comp.h"
#include "encode_mean.comp.h"

namespace cw2 {

namespace {

constexpr VkFormat kColors = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr VkExtent2D kOnePixel{1, 1};

/// Both ways, so that what comes next may read and write.
constexpr ImageUse kComputed{
    VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
constexpr ImageUse kCopied{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                           VK_ACCESS_2_TRANSFER_READ_BIT};

DescriptorSetLayout make_set_layout(const Device& device) {
    std::array<VkDescriptorSetLayoutBinding, 3> bindings;
    for (std::uint32_t i = 0; i < bindings.size(); ++i) {
        bindings[i] = {.binding = i,
                       .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                       .descriptorCount = 1,
                       .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    const VkDescriptorSetLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = bindings.size(),
        .pBindings = bindings.data()};
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    check(vkCreateDescriptorSetLayout(device.get(), &info, nullptr, &layout),
          "vkCreateDescriptorSetLayout");
    return {device.get(), layout};
}

PipelineLayout make_layout(const Device& device, VkDescriptorSetLayout set) {
    const VkPushConstantRange constants{.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
                                        .size = sizeof(interop::AverageConstants)};
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = 1,
                                          .pSetLayouts = &set,
                                          .pushConstantRangeCount = 1,
                                          .pPushConstantRanges = &constants};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout), "vkCreatePipelineLayout");
    return {device.get(), layout};
}

Pipeline make_pipeline(const Device& device, VkPipelineLayout layout,
                       std::span<const std::uint32_t> code) {
    const VkShaderModuleCreateInfo module_info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                               .codeSize = code.size_bytes(),
                                               .pCode = code.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device.get(), &module_info, nullptr, &module),
          "vkCreateShaderModule");
    const ShaderModule owner(device.get(), module);
    const VkComputePipelineCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(vkCreateComputePipelines(device.get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
          "vkCreateComputePipelines");
    return {device.get(), pipeline};
}

}  // namespace

PixelSample pixel_sample(std::uint32_t index, std::uint32_t count) {
    const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(count)));
    const std::uint32_t column = index / side, row = index % side;
    const auto place = [&](std::uint32_t cell, std::uint32_t part) {
        return (static_cast<float>(cell * side + part) + 0.5f) / static_cast<float>(count) - 0.5f;
    };
    return {{place(column, row), place(row, side - 1 - column)},
            -std::log2(static_cast<float>(side))};
}

Averager::Averager(const Device& device, const Layouts& layouts, const ShaderCode& code,
                   std::uint32_t slots)
    : device_(device),
      renderer_(device, layouts, code, kColors, VK_SAMPLE_COUNT_1_BIT, slots),
      set_layout_(make_set_layout(device)),
      layout_(make_layout(device, set_layout_.get())),
      add_(make_pipeline(device, layout_.get(), add_frame_comp)),
      encode_(make_pipeline(device, layout_.get(), encode_mean_comp)),
      pool_(make_descriptor_pool(device, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 6, 2)),
      mean_set_(allocate_set(device, pool_.get(), set_layout_.get())),
      frame_set_(allocate_set(device, pool_.get(), set_layout_.get())) {}

void Averager::fit(VkExtent2D extent) {
    if (extent.width == extent_.width && extent.height == extent_.height) return;
    // Frames of the old size may still be in flight.
    check(device_.wait_idle(), "vkDeviceWaitIdle");
    constexpr VkImageUsageFlags kStored =
        VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    frame_ = make_image(device_, {.format = kColors,
                                  .extent = extent,
                                  .usage = kStored | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT});
    bytes_ = make_image(device_,
                        {.format = VK_FORMAT_R8G8B8A8_UNORM, .extent = extent, .usage = kStored});
    mean_ = {};
    device_.name(frame_.handle.get(), "frame");
    device_.name(bytes_.handle.get(), "bytes of the picture");
    write_set(frame_set_, frame_.view.get());
    extent_ = extent;
}

void Averager::make_mean() {
    if (mean_.handle.get()) return;
    mean_ = make_image(device_,
                       {.format = kColors,
                        .extent = extent_,
                        .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    device_.name(mean_.handle.get(), "mean of frames");
    write_set(mean_set_, mean_.view.get());
}

void Averager::write_set(VkDescriptorSet set, VkImageView mean) const {
    const std::array views{frame_.view.get(), mean, bytes_.view.get()};
    std::array<VkDescriptorImageInfo, views.size()> images;
    std::array<VkWriteDescriptorSet, views.size()> writes;
    for (std::uint32_t i = 0; i < views.size(); ++i) {
        images[i] = {VK_NULL_HANDLE, views[i], VK_IMAGE_LAYOUT_GENERAL};
        writes[i] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                     .dstSet = set,
                     .dstBinding = i,
                     .descriptorCount = 1,
                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                     .pImageInfo = &images[i]};
    }
    vkUpdateDescriptorSets(device_.get(), writes.size(), writes.data(), 0, nullptr);
}

void Averager::dispatch(VkCommandBuffer commands, VkPipeline pipeline, VkExtent2D extent,
                        const interop::AverageConstants& constants) const {
    const auto groups = [](std::uint32_t pixels) {
        return (pixels + interop::kAverageGroup - 1) / interop::kAverageGroup;
    };
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1,
                            is_frame_ ? &frame_set_ : &mean_set_, 0, nullptr);
    vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants,
                       &constants);
    vkCmdDispatch(commands, groups(extent.width), groups(extent.height), 1);
}

FrameTarget Averager::target(VkExtent2D extent, std::uint32_t index, std::uint32_t count) const {
    return {.image = frame_.handle.get(),
            .view = frame_.view.get(),
            .extent = extent,
            .available_at = kComputed.stages | kCopied.stages,
            .after = kComputed,
            .sample = pixel_sample(index, count)};
}

void Averager::add_to_mean(VkCommandBuffer commands, VkExtent2D extent,
                           const interop::AverageConstants& constants) {
    make_mean();
    // Earlier contents go where a mean starts; their readers have to be done all the same.
    ImageUse before = picture_use_;
    if (constants.starts) before.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    image_barrier(commands, mean_.handle.get(), VK_IMAGE_ASPECT_COLOR_BIT, before, kComputed);
    dispatch(commands, add_.get(), extent, constants);
}

void Averager::add(VkCommandBuffer commands, std::uint32_t slot, const Scene& scene,
                   const FrameSettings& settings, VkExtent2D extent, std::uint32_t index,
                   std::uint32_t count, bool clamps) {
    fit(extent);
    renderer_.record(commands, slot, scene, target(extent, index, count), settings);
    is_frame_ = count == 1;
    if (!is_frame_)
        add_to_mean(
            commands, extent,
            {.weight = 1.0f / static_cast<float>(count), .starts = index == 0, .clamps = clamps});
    picture_use_ = kComputed;
}

void Averager::rehearse(VkCommandBuffer commands, std::uint32_t slot, const Scene& scene,
                        const FrameSettings& settings, VkExtent2D extent, std::uint32_t count) {
    fit(extent);
    FrameTarget target = this->target(extent, 0, count);
    target.rehearses = true;
    renderer_.record(commands, slot, scene, target, settings);
    is_frame_ = count == 1;
    if (!is_frame_) add_to_mean(commands, kOnePixel, {.weight = 1.0f, .starts = true});
    picture_use_ = kComputed;
    encode(commands, {}, kOnePixel);
}

std::vector<TriangleCulling::Shown> Averager::shown(const Scene& scene,
                                                    const FrameSettings& settings,
                                                    VkExtent2D extent, std::uint32_t count) {
    if (count > TriangleCulling::kViews) return {};
    std::vector<FrameTarget> targets;
    for (std::uint32_t i = 0; i < count; ++i) targets.push_back(target(extent, i, count));
    return renderer_.shown(scene, targets, settings);
}

void Averager::expect(const Scene& scene, const FrameSettings& settings, VkExtent2D extent,
                      std::uint32_t index, std::uint32_t count) {
    const FrameTarget target = this->target(extent, index, count);
    renderer_.shown(scene, {&target, 1}, settings);
}

void Averager::count_fragments(VkCommandBuffer commands, const Scene& scene,
                               const FrameSettings& settings, VkExtent2D extent) {
    fit(extent);
    FrameTarget target = this->target(extent, 0, 1);
    target.counts_fragments = true;
    renderer_.record(commands, 0, scene, target, settings);
}

VkImage Averager::encode(VkCommandBuffer commands, const PictureBytes& form) {
    return encode(commands, form, extent_);
}

VkImage Averager::encode(VkCommandBuffer commands, const PictureBytes& form, VkExtent2D extent) {
    image_barrier(commands, picture(), VK_IMAGE_ASPECT_COLOR_BIT, picture_use_, kComputed);
    picture_use_ = kComputed;
    image_barrier(commands, bytes_.handle.get(), VK_IMAGE_ASPECT_COLOR_BIT,
                  {VK_IMAGE_LAYOUT_UNDEFINED, kCopied.stages, VK_ACCESS_2_NONE}, kComputed);
    dispatch(commands, encode_.get(), extent,
             {.divides_by_alpha = form.straight_alpha,
              .encodes_srgb = form.srgb,
              .swaps_red_and_blue = form.blue_green_red});
    image_barrier(commands, bytes_.handle.get(), VK_IMAGE_ASPECT_COLOR_BIT, kComputed, kCopied);
    return bytes_.handle.get();
}

VkImage Averager::mean(VkCommandBuffer commands) {
    image_barrier(commands, picture(), VK_IMAGE_ASPECT_COLOR_BIT, picture_use_, kCopied);
    picture_use_ = kCopied;
    return picture();
}

VkDeviceSize Averager::memory_bytes() const {
    return frame_.memory.bytes() + mean_.memory.bytes() + bytes_.memory.bytes() +
           renderer_.memory_bytes();
}

}  // namespace cw2
