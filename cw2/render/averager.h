// Pictures as the mean of several frames with one sample a pixel each.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "cw2/render/renderer.h"

namespace cw2 {

/// What frame `index` of `count`, a square number, samples: the points of a grid that is rotated so
/// far that no two share a row or column; of one frame the pixel's centre. Textures are as sharp as
/// the sample's share of the pixel asks for.
PixelSample pixel_sample(std::uint32_t index, std::uint32_t count);

/// How the bytes of a picture are made.
struct PictureBytes {
    bool srgb = true;             ///< sRGB-encoded; false: the values themselves
    bool straight_alpha = false;  ///< colours are divided by their alpha
    bool blue_green_red = false;  ///< the order of the channels
};

/// The mean of frames and the device's images for it. The same frames give the same mean.
class Averager {
 public:
    /// `slots` frames may be in flight at once. `device` and `layouts` must outlive this. Throws
    /// VulkanError.
    Averager(const Device& device, const Layouts& layouts, const ShaderCode& code,
             std::uint32_t slots);

    /// Records frame `index` of `count` into the mean of a picture of this size; the first one
    /// starts a new mean. `clamps`: each frame's colours to [0, 1].
    void add(VkCommandBuffer commands, std::uint32_t slot, const Scene& scene,
             const FrameSettings& settings, VkExtent2D extent, std::uint32_t index,
             std::uint32_t count, bool clamps);

    /// Records what has a device compile what pictures of `count` frames of the scene will need,
    /// without reading its textures; see FrameTarget::rehearses. What there is of a mean is lost.
    void rehearse(VkCommandBuffer commands, std::uint32_t slot, const Scene& scene,
                  const FrameSettings& settings, VkExtent2D extent, std::uint32_t count);

    /// What the frames of a picture draw, see Renderer::shown(); nothing for more than it keeps.
    std::vector<TriangleCulling::Shown> shown(const Scene& scene, const FrameSettings& settings,
                                              VkExtent2D extent, std::uint32_t count);

    /// Finds out what frame `index` of `count` will draw, which add() then knows.
    void expect(const Scene& scene, const FrameSettings& settings, VkExtent2D extent,
                std::uint32_t index, std::uint32_t count);

    /// Records a frame at the pixels' centres whose fragments are counted, see
    /// Renderer::fragments(). What there is of a mean stays.
    void count_fragments(VkCommandBuffer commands, const Scene& scene,
                         const FrameSettings& settings, VkExtent2D extent);

    /// Records the making of the mean's bytes; the image, R8G8B8A8_UNORM, is then ready to be
    /// copied from.
    VkImage encode(VkCommandBuffer commands, const PictureBytes& form);
    /// Makes the mean itself, R32G32B32A32_SFLOAT, ready to be copied from.
    VkImage mean(VkCommandBuffer commands);

    void use_shaders(const ShaderCode& code) { renderer_.use_shaders(code); }
    const Renderer& renderer() const { return renderer_; }
    /// Device memory of the images.
    VkDeviceSize memory_bytes() const;

 private:
    void fit(VkExtent2D extent);
    /// For pictures of several frames.
    void make_mean();
    void write_set(VkDescriptorSet set, VkImageView mean) const;
    /// Where a frame of several, or the only one, is drawn.
    FrameTarget target(VkExtent2D extent, std::uint32_t index, std::uint32_t count) const;
    VkImage picture() const { return is_frame_ ? frame_.handle.get() : mean_.handle.get(); }
    /// Of the pixels of `extent`, and of some beside them.
    void add_to_mean(VkCommandBuffer commands, VkExtent2D extent,
                     const interop::AverageConstants& constants);
    VkImage encode(VkCommandBuffer commands, const PictureBytes& form, VkExtent2D extent);
    void dispatch(VkCommandBuffer commands, VkPipeline pipeline, VkExtent2D extent,
                  const interop::AverageConstants& constants) const;

    const Device& device_;
    Renderer renderer_;
    DescriptorSetLayout set_layout_;
    PipelineLayout layout_;
    Pipeline add_;
    Pipeline encode_;
    DescriptorPool pool_;
    VkDescriptorSet mean_set_;
    VkDescriptorSet frame_set_;  ///< in which a single frame is the mean
    Image frame_;
    Image mean_;  ///< empty until there is one of several frames
    Image bytes_;
    VkExtent2D extent_{};
    bool is_frame_ = false;   ///< the picture at hand is a single frame
    ImageUse picture_use_{};  ///< of it or of the mean, the last one recorded
};

}  // namespace cw2
