// Descriptor set layouts, pipeline layouts, and the pipelines that are built from them on demand.
#pragma once

#include <vulkan/vulkan.h>

#include <compare>
#include <map>
#include <span>

#include "cw2/render/view.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "mesh-format/layout.h"

namespace cw2 {

/// The two pipelines; they differ in their fragment shader and in the layout of set 1.
enum class Shading { opaque, alpha_mask };

/// The three descriptor set layouts (scene, opaque material, alpha-mask material) and the two
/// pipeline layouts over them.
struct Layouts {
    explicit Layouts(const Device& device);

    VkDescriptorSetLayout material_set(Shading shading) const {
        return (shading == Shading::opaque ? opaque_set : alpha_mask_set).get();
    }
    VkPipelineLayout pipeline(Shading shading) const {
        return (shading == Shading::opaque ? opaque_pipeline : alpha_mask_pipeline).get();
    }

    DescriptorSetLayout scene_set;
    DescriptorSetLayout opaque_set;
    DescriptorSetLayout alpha_mask_set;
    PipelineLayout opaque_pipeline;
    PipelineLayout alpha_mask_pipeline;
};

/// What a pipeline depends on beside the attachments.
struct PipelineKey {
    Shading shading;
    mesh_format::VertexForms forms;
    Side side;
    bool roughness_map;  ///< false: the factor alone counts
    bool metalness_map;  ///< the same
    bool false_color;
    auto operator<=>(const PipelineKey&) const = default;
};

/// SPIR-V of the three shaders.
struct ShaderCode {
    std::span<const std::uint32_t> vertex;
    std::span<const std::uint32_t> opaque_fragment;
    std::span<const std::uint32_t> alpha_mask_fragment;
};
/// The shaders as they were when the executable was built.
ShaderCode built_in_shaders();

/// The attachments that a pipeline renders to.
struct AttachmentFormats {
    VkFormat color;
    VkFormat depth;
    VkSampleCountFlagBits samples;
};

class Pipelines {
 public:
    /// `layouts` must outlive this. Throws VulkanError.
    Pipelines(const Device& device, const Layouts& layouts, const ShaderCode& code,
              const AttachmentFormats& formats);

    /// The pipeline for `key`, built when it is first asked for. The cull mode is dynamic.
    VkPipeline get(const PipelineKey& key);
    /// How many were built so far.
    std::size_t built() const { return built_; }

 private:
    Pipeline build(const PipelineKey& key) const;

    const Device* device_;
    const Layouts* layouts_;
    AttachmentFormats formats_;
    ShaderModule vertex_;
    ShaderModule opaque_fragment_;
    ShaderModule alpha_mask_fragment_;
    std::map<PipelineKey, Pipeline> pipelines_;
    std::size_t built_ = 0;
};

}  // namespace cw2
