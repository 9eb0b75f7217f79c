#include "cw2/render/pipelines.h"

#include <array>
#include <vector>

#include "alpha_mask.frag.h"
#include "mesh.vert.h"
#include "opaque.frag.h"
#include "shaders/interop.h"

namespace cw2 {

namespace {

DescriptorSetLayout make_set_layout(const Device& device,
                                    std::span<const VkDescriptorSetLayoutBinding> bindings) {
    const VkDescriptorSetLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = static_cast<std::uint32_t>(bindings.size()),
        .pBindings = bindings.data()};
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    check(vkCreateDescriptorSetLayout(device.get(), &info, nullptr, &layout),
          "vkCreateDescriptorSetLayout");
    return {device.get(), layout};
}

DescriptorSetLayout make_scene_set_layout(const Device& device) {
    const VkDescriptorSetLayoutBinding binding{
        .binding = interop::kSceneBinding,
        .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
        .descriptorCount = 1,
        .stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT};
    return make_set_layout(device, {&binding, 1});
}

DescriptorSetLayout make_material_set_layout(const Device& device, Shading shading) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const std::uint32_t binding :
         {interop::kBaseColorBinding, interop::kRoughnessBinding, interop::kMetalnessBinding,
          interop::kNormalMapBinding, interop::kAlphaMaskBinding}) {
        if (binding == interop::kAlphaMaskBinding && shading == Shading::opaque) continue;
        bindings.push_back({.binding = binding,
                            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                            .descriptorCount = 1,
                            .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT});
    }
    return make_set_layout(device, bindings);
}

PipelineLayout make_pipeline_layout(const Device& device, VkDescriptorSetLayout scene_set,
                                    VkDescriptorSetLayout material_set) {
    const std::array sets{scene_set, material_set};
    const VkPushConstantRange constants{
        .stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
        .size = interop::kDisplayOffset + sizeof(interop::DisplayConstants)};
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = sets.size(),
                                          .pSetLayouts = sets.data(),
                                          .pushConstantRangeCount = 1,
                                          .pPushConstantRanges = &constants};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(vkCreatePipelineLayout(device.get(), &info, nullptr, &layout), "vkCreatePipelineLayout");
    return {device.get(), layout};
}

ShaderModule make_module(const Device& device, std::span<const std::uint32_t> code) {
    const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = code.size_bytes(),
                                        .pCode = code.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device.get(), &info, nullptr, &module), "vkCreateShaderModule");
    return {device.get(), module};
}

struct VertexInput {
    VkVertexInputBindingDescription binding;
    std::array<VkVertexInputAttributeDescription, 3> attributes;
};

/// Three 16-bit words are read as four, the fourth belonging to what follows in the vertex:
/// three-component 16-bit formats are optional in Vulkan.
VertexInput vertex_input(const mesh_format::VertexForms& forms) {
    using namespace mesh_format;
    const VertexLayout layout = vertex_layout(forms);
    const VkFormat position = forms.position == PositionForm::quantised
                                  ? VK_FORMAT_R16G16B16A16_UINT
                                  : VK_FORMAT_R32G32B32_UINT;
    const VkFormat frame = forms.frame == FrameForm::f32      ? VK_FORMAT_R32G32B32A32_UINT
                           : forms.frame == FrameForm::quat32 ? VK_FORMAT_R16G16_UINT
                                                              : VK_FORMAT_R16G16B16A16_UINT;
    const VkFormat uv =
        forms.uv == UvForm::quantised ? VK_FORMAT_R16G16_UINT : VK_FORMAT_R32G32_UINT;
    return {{.binding = 0, .stride = layout.stride, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX},
            {{{.location = interop::kPositionLocation, .format = position, .offset = 0},
              {.location = interop::kFrameLocation, .format = frame, .offset = layout.frame_offset},
              {.location = interop::kUvLocation, .format = uv, .offset = layout.uv_offset}}}};
}

/// The values of all specialisation constants, indexed by their id.
std::array<std::uint32_t, interop::kSpecializationCount> constants_of(const PipelineKey& key) {
    std::array<std::uint32_t, interop::kSpecializationCount> values{};
    values[interop::kPositionFormConstant] = static_cast<std::uint32_t>(key.forms.position);
    values[interop::kFrameFormConstant] = static_cast<std::uint32_t>(key.forms.frame);
    values[interop::kUvFormConstant] = static_cast<std::uint32_t>(key.forms.uv);
    values[interop::kViewConstant] = key.side.view;
    values[interop::kNormalMapConstant] = key.side.normal_map ? 1 : 0;
    values[interop::kAlphaMaskConstant] = key.side.alpha_mask ? 1 : 0;
    values[interop::kRoughnessMapConstant] = key.roughness_map ? 1 : 0;
    values[interop::kMetalnessMapConstant] = key.metalness_map ? 1 : 0;
    values[interop::kFalseColorConstant] = key.false_color ? 1 : 0;
    return values;
}

}  // namespace

Layouts::Layouts(const Device& device)
    : scene_set(make_scene_set_layout(device)),
      opaque_set(make_material_set_layout(device, Shading::opaque)),
      alpha_mask_set(make_material_set_layout(device, Shading::alpha_mask)),
      opaque_pipeline(make_pipeline_layout(device, scene_set.get(), opaque_set.get())),
      alpha_mask_pipeline(make_pipeline_layout(device, scene_set.get(), alpha_mask_set.get())) {}

ShaderCode built_in_shaders() {
    return {mesh_vert, opaque_frag, alpha_mask_frag};
}

Pipelines::Pipelines(const Device& device, const Layouts& layouts, const ShaderCode& code,
                     const AttachmentFormats& formats)
    : device_(&device),
      layouts_(&layouts),
      formats_(formats),
      vertex_(make_module(device, code.vertex)),
      opaque_fragment_(make_module(device, code.opaque_fragment)),
      alpha_mask_fragment_(make_module(device, code.alpha_mask_fragment)) {}

VkPipeline Pipelines::get(const PipelineKey& key) {
    const auto [entry, is_new] = pipelines_.try_emplace(key);
    if (is_new) {
        entry->second = build(key);
        ++built_;
    }
    return entry->second.get();
}

Pipeline Pipelines::build(const PipelineKey& key) const {
    const auto values = constants_of(key);
    std::array<VkSpecializationMapEntry, values.size()> entries;
    for (std::uint32_t id = 0; id < entries.size(); ++id) {
        entries[id] = {id, id * 4, sizeof(std::uint32_t)};
    }
    const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()),
                                              entries.data(), sizeof values, values.data()};
    const auto stage = [&](VkShaderStageFlagBits bit, const ShaderModule& module) {
        return VkPipelineShaderStageCreateInfo{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = bit,
            .module = module.get(),
            .pName = "main",
            .pSpecializationInfo = &specialization};
    };
    const std::array stages{
        stage(VK_SHADER_STAGE_VERTEX_BIT, vertex_),
        stage(VK_SHADER_STAGE_FRAGMENT_BIT,
              key.shading == Shading::opaque ? opaque_fragment_ : alpha_mask_fragment_)};

    const VertexInput input = vertex_input(key.forms);
    const VkPipelineVertexInputStateCreateInfo vertex_state{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 1,
        .pVertexBindingDescriptions = &input.binding,
        .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(input.attributes.size()),
        .pVertexAttributeDescriptions = input.attributes.data()};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
        .lineWidth = 1.0f};
    const VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = formats_.samples};
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = VK_COMPARE_OP_GREATER};
    const VkPipelineColorBlendAttachmentState attachment{
        .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                          VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT};
    const VkPipelineColorBlendStateCreateInfo blend{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &attachment};
    const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                    VK_DYNAMIC_STATE_CULL_MODE};
    const VkPipelineDynamicStateCreateInfo dynamic{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = dynamic_states.size(),
        .pDynamicStates = dynamic_states.data()};
    const VkPipelineRenderingCreateInfo rendering{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = 1,
        .pColorAttachmentFormats = &formats_.color,
        .depthAttachmentFormat = formats_.depth};
    const VkGraphicsPipelineCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .stageCount = stages.size(),
        .pStages = stages.data(),
        .pVertexInputState = &vertex_state,
        .pInputAssemblyState = &assembly,
        .pViewportState = &viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &multisample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic,
        .layout = layouts_->pipeline(key.shading)};
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(vkCreateGraphicsPipelines(device_->get(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
          "vkCreateGraphicsPipelines");
    return {device_->get(), pipeline};
}

}  // namespace cw2
