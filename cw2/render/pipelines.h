// Descriptor set layouts, pipeline layouts, and the pipelines that are built from them on demand.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <compare>
#include <map>
#include <span>

#include "cw2/render/view.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "mesh-format/layout.h"

namespace cw2 {

/// The kinds of pipelines; they differ in their fragment shader and in the layout of set 1.
enum class Shading {
    opaque,
    alpha_mask,
    emissive,  ///< with or without an alpha mask
    count
};
inline constexpr std::size_t kShadingCount = static_cast<std::size_t>(Shading::count);

/// How many maps the layout of set 1 has: the first ones of mesh_format::MapUse.
constexpr std::uint32_t map_count(Shading shading) {
    using mesh_format::MapUse;
    switch (shading) {
        case Shading::opaque:
            return static_cast<std::uint32_t>(MapUse::normal) + 1;
        case Shading::alpha_mask:
            return static_cast<std::uint32_t>(MapUse::alpha_mask) + 1;
        default:
            return static_cast<std::uint32_t>(MapUse::emission) + 1;
    }
}

/// The descriptor set layouts of the scene and of the materials of each shading, and the pipeline
/// layouts over them.
struct Layouts {
    explicit Layouts(const Device& device);

    VkDescriptorSetLayout material_set(Shading shading) const {
        return material_sets[static_cast<std::size_t>(shading)].get();
    }
    VkPipelineLayout pipeline(Shading shading) const {
        return pipelines[static_cast<std::size_t>(shading)].get();
    }

    DescriptorSetLayout scene_set;
    std::array<DescriptorSetLayout, kShadingCount> material_sets;
    std::array<PipelineLayout, kShadingCount> pipelines;
};

/// What a pipeline depends on beside the attachments.
struct PipelineKey {
    Shading shading;
    mesh_format::VertexForms forms;
    Side side;
    bool alpha_mask;     ///< the material has one
    bool merged_maps;    ///< the normal map holds roughness and metalness, too
    bool roughness_map;  ///< false: the factor alone counts
    bool metalness_map;  ///< the same
    bool false_color;
    bool unlit;
    bool changing_uvs;  ///< neighbouring pixels sample maps in different points
    auto operator<=>(const PipelineKey&) const = default;
};

/// The vertex shader, then the fragment shader of each Shading.
inline constexpr std::array<const char*, 1 + kShadingCount> kShaderFiles{
    "mesh.vert", "opaque.frag", "alpha_mask.frag", "emissive.frag"};
/// One T for each of kShaderFiles, without vertex colours and with them.
template <typename T>
using PerShader = std::array<std::array<T, 2>, kShaderFiles.size()>;

/// SPIR-V of the shaders.
using ShaderCode = PerShader<std::span<const std::uint32_t>>;
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
    PerShader<ShaderModule> modules_;
    std::map<PipelineKey, Pipeline> pipelines_;
    std::size_t built_ = 0;
};

}  // namespace cw2
