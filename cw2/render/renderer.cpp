#include "cw2/render/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "cw2/render/visibility.h"

namespace cw2 {

namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

constexpr ImageUse kDepthAttachmentUse{
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT};

constexpr VkShaderStageFlags kConstantsStages =
    VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

/// The contents are discarded, but what used the image before must be over.
ImageUse discarded(const ImageUse& use) {
    return {VK_IMAGE_LAYOUT_UNDEFINED, use.stages, use.access};
}

void require_samples(const Device& device, VkFormat format, VkImageUsageFlags usage,
                     VkSampleCountFlagBits samples) {
    VkImageFormatProperties properties{};
    const VkResult result =
        vkGetPhysicalDeviceImageFormatProperties(device.physical(), format, VK_IMAGE_TYPE_2D,
                                                 VK_IMAGE_TILING_OPTIMAL, usage, 0, &properties);
    if (result != VK_SUCCESS || !(properties.sampleCounts & samples)) {
        throw VulkanError(fmt::format("device '{}' cannot render with {} samples a pixel",
                                      device.properties().deviceName, static_cast<int>(samples)));
    }
}

QueryPool make_query_pool(const Device& device, const VkQueryPoolCreateInfo& info) {
    VkQueryPool pool = VK_NULL_HANDLE;
    check(vkCreateQueryPool(device.get(), &info, nullptr, &pool), "vkCreateQueryPool");
    return {device.get(), pool};
}

QueryPool make_timestamps(const Device& device, std::uint32_t count) {
    if (device.timestamp_bits() == 0) return {};
    return make_query_pool(device, {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                    .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                    .queryCount = count});
}

QueryPool make_fragment_counter(const Device& device) {
    if (!device.counts_fragments()) return {};
    return make_query_pool(
        device,
        {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
         .queryType = VK_QUERY_TYPE_PIPELINE_STATISTICS,
         .queryCount = 1,
         .pipelineStatistics = VK_QUERY_PIPELINE_STATISTIC_FRAGMENT_SHADER_INVOCATIONS_BIT});
}

interop::SceneUniforms scene_uniforms(const Scene& scene, const FrameTarget& target,
                                      const FrameSettings& settings) {
    const VkExtent2D extent = target.extent;
    const float aspect = static_cast<float>(extent.width) / static_cast<float>(extent.height);
    interop::SceneUniforms uniforms{};
    uniforms.camera = view_from_world(settings.camera);
    uniforms.projection =
        clip_from_view(settings.camera.vertical_fov, aspect, near_distance(scene.bounds()));
    // What is at the sample moves to the centre; w is -z.
    uniforms.projection[2][0] = 2.0f * target.sample.offset.x / static_cast<float>(extent.width);
    uniforms.projection[2][1] = 2.0f * target.sample.offset.y / static_cast<float>(extent.height);
    uniforms.projCam = uniforms.projection * uniforms.camera;
    uniforms.cameraPosition = settings.camera.position;
    uniforms.lightPosition = settings.light.position;
    uniforms.lightColor = settings.light.color;
    uniforms.ambientColor = settings.light.ambient;
    return uniforms;
}

PipelineKey pipeline_key(const Draw& draw, Side side, const FrameSettings& settings) {
    if (settings.one_pipeline) side.view = interop::kViewOfDisplay;
    // What a material has none of makes no other pipeline.
    side.alpha_mask |= !draw.alpha_mask;
    side.normal_map |= draw.constants.has_normal_map == 0;
    return {.shading = draw.shading,
            .forms = draw.forms,
            .side = side,
            .alpha_mask = draw.alpha_mask,
            .merged_maps = draw.merged_maps,
            .roughness_map = !settings.materials.roughness,
            .metalness_map = !settings.materials.metalness,
            .false_color = settings.false_color.has_value(),
            .unlit = draw.unlit,
            .changing_uvs = draw.changing_uvs};
}

interop::DrawConstants draw_constants(const Draw& draw, const MaterialOverrides& materials) {
    interop::DrawConstants constants = draw.constants;
    constants.roughness = materials.roughness.value_or(constants.roughness);
    constants.metalness = materials.metalness.value_or(constants.metalness);
    constants.normal_scale *= materials.normal_strength;
    if (materials.two_sided) constants.back_normals = -1.0f;
    return constants;
}

interop::DisplayConstants display_constants(const Side& side, const FrameTarget& target,
                                            const FrameSettings& settings) {
    const float stops = settings.exposure.value_or(kViews[side.view].exposure);
    interop::DisplayConstants constants{
        .exposure = std::exp2(stops), .view = side.view, .lod_bias = target.sample.lod_bias};
    if (settings.false_color) {
        const ValueRange range = settings.false_color->range_of(side.view);
        constants.false_color_low = range.low;
        constants.false_color_high = range.high;
    }
    return constants;
}

VkRect2D area_of(const FrameTarget& target) {
    return target.area.value_or(VkRect2D{{0, 0}, target.extent});
}

/// What of `area` is in the columns from `left` to before `right`.
VkRect2D columns_of(const VkRect2D& area, std::uint32_t left, std::uint32_t right) {
    const auto begin = static_cast<std::uint32_t>(area.offset.x);
    const std::uint32_t low = std::max(left, begin);
    const std::uint32_t high = std::max(low, std::min(right, begin + area.extent.width));
    return {{static_cast<std::int32_t>(low), area.offset.y}, {high - low, area.extent.height}};
}

/// Makes the part of the clip space of a picture that shows `area` a whole one.
glm::mat4 clip_from_picture(const VkRect2D& area, VkExtent2D extent) {
    const glm::vec2 low = glm::vec2(area.offset.x, area.offset.y);
    const glm::vec2 size = glm::vec2(area.extent.width, area.extent.height);
    const glm::vec2 whole = glm::vec2(extent.width, extent.height);
    const glm::vec2 scale = whole / size;
    const glm::vec2 offset = (whole - 2.0f * low - size) / size;
    glm::mat4 clip(1.0f);
    clip[0][0] = scale.x;
    clip[1][1] = scale.y;
    clip[3][0] = offset.x;
    clip[3][1] = offset.y;
    return clip;
}

std::vector<std::uint32_t> visible_chunks(const Scene& scene, const FrameTarget& target,
                                          const FrameSettings& settings, const glm::mat4& clip) {
    std::vector<std::uint32_t> visible;
    find_visible(scene.chunks(), scene.draws(),
                 clip_from_picture(area_of(target), target.extent) * clip, settings.camera.position,
                 visible);
    return visible;
}

/// A white line, a pixel to either side of where the columns of the right side begin.
void draw_divider(VkCommandBuffer commands, std::uint32_t column, VkExtent2D extent) {
    const std::uint32_t left = column > 0 ? column - 1 : 0;
    const std::uint32_t right = std::min(column + 1, extent.width);
    const VkClearAttachment white{.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
                                  .clearValue = {.color = {.float32 = {1.0f, 1.0f, 1.0f, 1.0f}}}};
    const VkClearRect rectangle{
        {{static_cast<std::int32_t>(left), 0}, {right - left, extent.height}}, 0, 1};
    vkCmdClearAttachments(commands, 1, &white, 1, &rectangle);
}

}  // namespace

Renderer::Renderer(const Device& device, const Layouts& layouts, const ShaderCode& code,
                   VkFormat color_format, VkSampleCountFlagBits samples, std::uint32_t slots)
    : device_(device),
      layouts_(layouts),
      formats_{color_format, kDepthFormat, samples},
      pipelines_(device, layouts, code, formats_),
      timestamps_(make_timestamps(device, 2 * slots)),
      fragments_(make_fragment_counter(device)) {
    require_samples(device, color_format, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, samples);
    require_samples(device, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, samples);
    // Which triangles several samples a pixel show is not known.
    if (device.is_cpu() && samples == VK_SAMPLE_COUNT_1_BIT) culling_.emplace(device);
    make_slots(slots);
}

void Renderer::make_slots(std::uint32_t count) {
    descriptor_pool_ =
        make_descriptor_pool(device_, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, count, count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Slot slot;
        slot.uniforms = make_buffer(device_, sizeof(interop::SceneUniforms),
                                    VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, MemoryUse::upload);
        device_.name(slot.uniforms.handle.get(), fmt::format("scene uniforms {}", i));
        slot.set = allocate_set(device_, descriptor_pool_.get(), layouts_.scene_set.get());
        const VkDescriptorBufferInfo buffer{slot.uniforms.handle.get(), 0, VK_WHOLE_SIZE};
        const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                         .dstSet = slot.set,
                                         .dstBinding = interop::kSceneBinding,
                                         .descriptorCount = 1,
                                         .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                         .pBufferInfo = &buffer};
        vkUpdateDescriptorSets(device_.get(), 1, &write, 0, nullptr);
        slots_.push_back(std::move(slot));
    }
}

void Renderer::use_shaders(const ShaderCode& code) {
    pipelines_ = Pipelines(device_, layouts_, code, formats_);
}

void Renderer::resize(VkExtent2D extent) {
    if (extent.width == extent_.width && extent.height == extent_.height) return;
    // A frame of the old size may still be in flight.
    check(device_.wait_idle(), "vkDeviceWaitIdle");
    depth_ = make_image(device_, {.format = kDepthFormat,
                                  .extent = extent,
                                  .samples = formats_.samples,
                                  .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT});
    device_.name(depth_.handle.get(), "depth");
    if (formats_.samples != VK_SAMPLE_COUNT_1_BIT) {
        multisampled_ = make_image(device_, {.format = formats_.color,
                                             .extent = extent,
                                             .samples = formats_.samples,
                                             .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT});
        device_.name(multisampled_.handle.get(), "multisampled colour");
    }
    extent_ = extent;
}

void Renderer::begin_attachments(VkCommandBuffer commands, const FrameTarget& target,
                                 const FrameSettings& settings) const {
    const bool multisample = formats_.samples != VK_SAMPLE_COUNT_1_BIT;
    image_barrier(commands, target.image, VK_IMAGE_ASPECT_COLOR_BIT,
                  {VK_IMAGE_LAYOUT_UNDEFINED, target.available_at, VK_ACCESS_2_NONE},
                  kColorAttachmentUse);
    image_barrier(commands, depth_.handle.get(), VK_IMAGE_ASPECT_DEPTH_BIT,
                  discarded(kDepthAttachmentUse), kDepthAttachmentUse);
    if (multisample) {
        image_barrier(commands, multisampled_.handle.get(), VK_IMAGE_ASPECT_COLOR_BIT,
                      discarded(kColorAttachmentUse), kColorAttachmentUse);
    }

    const glm::vec3 back = settings.background.value_or(glm::vec3(0.0f));
    VkRenderingAttachmentInfo color{
        .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
        .imageView = multisample ? multisampled_.view.get() : target.view,
        .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
        .storeOp = multisample ? VK_ATTACHMENT_STORE_OP_DONT_CARE : VK_ATTACHMENT_STORE_OP_STORE,
        .clearValue = {.color = {.float32 = {back.r, back.g, back.b, 0.0f}}}};
    if (multisample) {
        color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
        color.resolveImageView = target.view;
        color.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    const VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                          .imageView = depth_.view.get(),
                                          .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                                          .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                          .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                          .clearValue = {.depthStencil = {.depth = 0.0f}}};
    const VkRenderingInfo info{
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        // Nothing is drawn that more would have to be cleared for.
        .renderArea = target.rehearses ? VkRect2D{{0, 0}, {1, 1}} : area_of(target),
        .layerCount = 1,
        .colorAttachmentCount = 1,
        .pColorAttachments = &color,
        .pDepthAttachment = &depth};
    vkCmdBeginRendering(commands, &info);

    const VkViewport viewport{.width = static_cast<float>(target.extent.width),
                              .height = static_cast<float>(target.extent.height),
                              .minDepth = 0.0f,
                              .maxDepth = 1.0f};
    vkCmdSetViewport(commands, 0, 1, &viewport);
}

void Renderer::draw_sides(VkCommandBuffer commands, VkDescriptorSet scene_set, const Scene& scene,
                          const FrameTarget& target, const FrameSettings& settings) {
    const VkRect2D area = area_of(target);
    const std::uint32_t end =
        settings.split ? settings.split->column(target.extent.width) : target.extent.width;
    const auto draw = [&](const Side& side, std::uint32_t left, std::uint32_t right) {
        const VkRect2D scissor = columns_of(area, left, right);
        if (scissor.extent.width == 0) return;
        vkCmdSetScissor(commands, 0, 1, &scissor);
        const interop::DisplayConstants display = display_constants(side, target, settings);
        // The layouts have the same push constants: what is pushed through one is there for all.
        vkCmdPushConstants(commands, layouts_.pipeline(Shading::opaque), kConstantsStages,
                           interop::kDisplayOffset, sizeof display, &display);
        draw_ranges(commands, scene_set, scene, side, settings);
    };
    draw(settings, 0, end);
    if (!settings.split) return;
    draw(settings.split->right, end, target.extent.width);
    if (!target.rehearses) draw_divider(commands, end, target.extent);
}

void Renderer::draw_ranges(VkCommandBuffer commands, VkDescriptorSet scene_set, const Scene& scene,
                           const Side& side, const FrameSettings& settings) {
    VkPipeline bound_pipeline = VK_NULL_HANDLE;
    VkPipelineLayout bound_layout = VK_NULL_HANDLE;
    VkDescriptorSet bound_material = VK_NULL_HANDLE;
    const Draw* bound_draw = nullptr;
    if (shown_indices_) vkCmdBindIndexBuffer(commands, shown_indices_, 0, VK_INDEX_TYPE_UINT16);
    for (const DrawRange& range : ranges_) {
        const Draw& draw = scene.draws()[range.draw];
        if (&draw != bound_draw) {
            const VkPipeline pipeline = pipelines_.get(pipeline_key(draw, side, settings));
            const VkPipelineLayout layout = layouts_.pipeline(draw.shading);
            if (pipeline != bound_pipeline) {
                vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
                bound_pipeline = pipeline;
            }
            if (layout != bound_layout) {
                vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout,
                                        interop::kSceneSet, 1, &scene_set, 0, nullptr);
                bound_layout = layout;
            }
            if (draw.material != bound_material) {
                vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout,
                                        interop::kMaterialSet, 1, &draw.material, 0, nullptr);
                bound_material = draw.material;
            }
            const interop::DrawConstants constants = draw_constants(draw, settings.materials);
            vkCmdPushConstants(commands, layout, kConstantsStages, 0, sizeof constants, &constants);
            vkCmdSetCullMode(commands, rehearses_       ? VK_CULL_MODE_FRONT_AND_BACK
                                       : draw.cull_back ? VK_CULL_MODE_BACK_BIT
                                                        : VK_CULL_MODE_NONE);
            const VkBuffer vertices = scene.vertices();
            vkCmdBindVertexBuffers(commands, 0, 1, &vertices, &draw.vertex_offset);
            if (!shown_indices_)
                vkCmdBindIndexBuffer(commands, scene.indices(), draw.index_offset,
                                     VK_INDEX_TYPE_UINT16);
            bound_draw = &draw;
        }
        vkCmdDrawIndexed(commands, rehearses_ ? 3 : range.index_count, 1, range.first_index, 0, 0);
        counts_.triangles += range.index_count / 3;
        ++counts_.draws;
    }
}

std::vector<TriangleCulling::Shown> Renderer::shown(const Scene& scene,
                                                    std::span<const FrameTarget> targets,
                                                    const FrameSettings& settings) {
    if (!culling_) return {};
    std::vector<TriangleCulling::Wanted> views;
    for (const FrameTarget& target : targets) {
        const glm::mat4 clip = scene_uniforms(scene, target, settings).projCam;
        views.push_back({{clip, near_distance(scene.bounds()), target.extent, area_of(target)},
                         visible_chunks(scene, target, settings, clip)});
    }
    return culling_->find(scene, views);
}

void Renderer::find_ranges(const Scene& scene, const FrameTarget& target,
                           const FrameSettings& settings) {
    ranges_.clear();
    shown_indices_ = VK_NULL_HANDLE;
    if (culling_) {
        const TriangleCulling::Shown shown = this->shown(scene, {&target, 1}, settings).front();
        shown_indices_ = shown.buffer;
        ranges_.assign(shown.ranges.begin(), shown.ranges.end());
    } else {
        const glm::mat4 clip = scene_uniforms(scene, target, settings).projCam;
        for (const std::uint32_t index : visible_chunks(scene, target, settings, clip)) {
            const SceneChunk& chunk = scene.chunks()[index];
            ranges_.push_back({chunk.draw, chunk.first_index, chunk.index_count});
        }
    }
    if (!target.rehearses) return;
    std::set<VkDescriptorSet> materials;
    std::erase_if(ranges_, [&](const DrawRange& range) {
        return !materials.insert(scene.draws()[range.draw].material).second;
    });
}

void Renderer::write_timestamp(VkCommandBuffer commands, VkPipelineStageFlags2 stage,
                               std::uint32_t query) const {
    if (timestamps_) vkCmdWriteTimestamp2(commands, stage, timestamps_.get(), query);
}

void Renderer::record(VkCommandBuffer commands, std::uint32_t slot, const Scene& scene,
                      const FrameTarget& target, const FrameSettings& settings) {
    resize(target.extent);
    counts_ = {};
    const std::size_t built_before = pipelines_.built();
    const interop::SceneUniforms uniforms = scene_uniforms(scene, target, settings);
    std::memcpy(slots_[slot].uniforms.mapped.data(), &uniforms, sizeof uniforms);
    rehearses_ = target.rehearses;
    find_ranges(scene, target, settings);
    if (timestamps_) vkCmdResetQueryPool(commands, timestamps_.get(), 2 * slot, 2);
    write_timestamp(commands, VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT, 2 * slot);
    const bool counts_fragments = target.counts_fragments && fragments_;
    if (counts_fragments) {
        vkCmdResetQueryPool(commands, fragments_.get(), 0, 1);
        vkCmdBeginQuery(commands, fragments_.get(), 0, 0);
    }
    begin_attachments(commands, target, settings);
    draw_sides(commands, slots_[slot].set, scene, target, settings);
    vkCmdEndRendering(commands);
    if (counts_fragments) vkCmdEndQuery(commands, fragments_.get(), 0);
    counts_.new_pipelines = pipelines_.built() != built_before;
    write_timestamp(commands, VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT, 2 * slot + 1);
    // Resolving, too, is a colour attachment write.
    image_barrier(commands, target.image, VK_IMAGE_ASPECT_COLOR_BIT, kColorAttachmentUse,
                  target.after);
}

std::optional<double> Renderer::gpu_milliseconds(std::uint32_t slot) const {
    if (!timestamps_) return std::nullopt;
    std::uint64_t ticks[2];
    const VkResult result =
        vkGetQueryPoolResults(device_.get(), timestamps_.get(), 2 * slot, 2, sizeof ticks, ticks,
                              sizeof ticks[0], VK_QUERY_RESULT_64_BIT);
    if (result != VK_SUCCESS) return std::nullopt;
    return static_cast<double>(elapsed_ticks(ticks[0], ticks[1], device_.timestamp_bits())) *
           static_cast<double>(device_.properties().limits.timestampPeriod) * 1e-6;
}

std::optional<std::uint64_t> Renderer::fragments() const {
    if (!fragments_) return std::nullopt;
    std::uint64_t count = 0;
    const VkResult result =
        vkGetQueryPoolResults(device_.get(), fragments_.get(), 0, 1, sizeof count, &count,
                              sizeof count, VK_QUERY_RESULT_64_BIT);
    return result == VK_SUCCESS ? std::optional(count) : std::nullopt;
}

}  // namespace cw2
