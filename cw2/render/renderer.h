// Records the commands that draw a scene into an image; knows neither window nor file.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cw2/render/frame_settings.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/scene.h"
#include "cw2/render/triangle_culling.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/resources.h"

namespace cw2 {

/// What a frame with one sample a pixel samples.
struct PixelSample {
    glm::vec2 offset{0.0f};  ///< from the pixels' centres, pixels to the right and down
    float lod_bias = 0.0f;   ///< added to textures' level of detail
};

/// The image that a frame ends up in. Its old contents are discarded.
struct FrameTarget {
    VkImage image;
    VkImageView view;
    VkExtent2D extent;
    /// The stage that whoever waits for the image's availability blocks.
    VkPipelineStageFlags2 available_at;
    ImageUse after;                               ///< what it is used for next
    std::optional<VkRect2D> area = std::nullopt;  ///< that is drawn; none: all of it
    PixelSample sample{};
    /// Nothing is seen: a triangle for each material is drawn and culled, so that a device that
    /// compiles shaders when they first draw does it. Reads no texture.
    bool rehearses = false;
    bool counts_fragments = false;  ///< see Renderer::fragments()
};

/// What is left of a scene after culling.
struct FrameCounts {
    std::uint64_t triangles = 0;
    std::uint32_t draws = 0;     ///< draw calls
    bool new_pipelines = false;  ///< some were built, and compiled when they first drew
};

class Renderer {
 public:
    /// Renders to targets of `color_format` with `samples` a pixel. `slots` frames may be in
    /// flight at once. `device` and `layouts` must outlive this. Throws VulkanError, also where the
    /// device cannot do that many samples.
    Renderer(const Device& device, const Layouts& layouts, const ShaderCode& code,
             VkFormat color_format, VkSampleCountFlagBits samples, std::uint32_t slots);

    /// Records one frame. The slot's previous frame must be done.
    void record(VkCommandBuffer commands, std::uint32_t slot, const Scene& scene,
                const FrameTarget& target, const FrameSettings& settings);

    /// On a CPU, what frames would draw, up to TriangleCulling::kViews of them, see its find();
    /// on others nothing.
    std::vector<TriangleCulling::Shown> shown(const Scene& scene,
                                              std::span<const FrameTarget> targets,
                                              const FrameSettings& settings);

    /// From now on draws with these shaders. No frame may be in flight. Throws VulkanError, and
    /// keeps the old ones.
    void use_shaders(const ShaderCode& code);

    /// What the last frame recorded was made of.
    const FrameCounts& counts() const { return counts_; }
    /// Device memory of the images that are drawn into beside the target.
    VkDeviceSize memory_bytes() const {
        return depth_.memory.bytes() + multisampled_.memory.bytes();
    }

    /// Device time of the slot's last frame, once it is done; nothing where the device has no
    /// timestamps.
    std::optional<double> gpu_milliseconds(std::uint32_t slot) const;
    /// How many fragments the last frame that counted them has shaded, once it is done, as the
    /// device counts them (lavapipe: hidden ones, too); nothing where it cannot.
    std::optional<std::uint64_t> fragments() const;
    std::size_t pipeline_count() const { return pipelines_.built(); }

 private:
    struct Slot {
        Buffer uniforms;
        VkDescriptorSet set;
    };

    void make_slots(std::uint32_t count);
    void resize(VkExtent2D extent);
    void begin_attachments(VkCommandBuffer commands, const FrameTarget& target,
                           const FrameSettings& settings) const;
    void draw_sides(VkCommandBuffer commands, VkDescriptorSet scene_set, const Scene& scene,
                    const FrameTarget& target, const FrameSettings& settings);
    void find_ranges(const Scene& scene, const FrameTarget& target, const FrameSettings& settings);
    void draw_ranges(VkCommandBuffer commands, VkDescriptorSet scene_set, const Scene& scene,
                     const Side& side, const FrameSettings& settings);
    void write_timestamp(VkCommandBuffer commands, VkPipelineStageFlags2 stage,
                         std::uint32_t query) const;

    const Device& device_;
    const Layouts& layouts_;
    AttachmentFormats formats_;
    Pipelines pipelines_;
    DescriptorPool descriptor_pool_;
    std::vector<Slot> slots_;
    QueryPool timestamps_;                     ///< two a slot; empty where the device has none
    QueryPool fragments_;                      ///< one; empty where the device cannot count
    std::optional<TriangleCulling> culling_;   ///< on CPUs
    std::vector<DrawRange> ranges_;            ///< that it draws
    VkBuffer shown_indices_ = VK_NULL_HANDLE;  ///< that hold the ranges; null: the scene's
    bool rehearses_ = false;                   ///< the frame at hand, see FrameTarget
    FrameCounts counts_;
    VkExtent2D extent_{};
    Image depth_;
    Image multisampled_;  ///< empty with one sample a pixel
};

}  // namespace cw2
