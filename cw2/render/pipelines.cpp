#include "cw2/render/pipelines.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "alpha_mask.frag.h"
#include "alpha_mask_colors.frag.h"
#include "emissive.frag.h"
#include "emissive_colors.frag.h"
#include "mesh.vert.h"
#include "mesh_colors.vert.h"
#include "opaque.frag.h"
#include "opaque_colors.frag.h"
#include "shaders/interop.h"

namespace cw2 {

namespace {

// A map's binding is its use.
template <mesh_format::MapUse use, std::uint32_t binding>
constexpr bool kIsBoundAtUse = static_cast<std::uint32_t>(use) == binding;
static_assert(kIsBoundAtUse<mesh_format::MapUse::base_color, interop::kBaseColorBinding> &&
              kIsBoundAtUse<mesh_format::MapUse::roughness, interop::kRoughnessBinding> &&
              kIsBoundAtUse<mesh_format::MapUse::metalness, interop::kMetalnessBinding> &&
              kIsBoundAtUse<mesh_format::MapUse::normal, interop::kNormalMapBinding> &&
              kIsBoundAtUse<mesh_format::MapUse::alpha_mask, interop::kAlphaMaskBinding> &&
              kIsBoundAtUse<mesh_format::MapUse::emission, interop::kEmissionBinding>);
static_assert(map_count(Shading::emissive) == mesh_format::kMapUseCount);

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
    for (std::uint32_t binding = 0; binding < map_count(shading); ++binding) {
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

bool has_colors(const mesh_format::VertexForms& forms) {
    return forms.color != mesh_format::ColorForm::none;
}

struct VertexInput {
    VkVertexInputBindingDescription binding;
    std::vector<VkVertexInputAttributeDescription> attributes;
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
    VertexInput input{
        {.binding = 0, .stride = layout.stride, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX},
        {{.location = interop::kPositionLocation, .format = position, .offset = 0},
         {.location = interop::kFrameLocation, .format = frame, .offset = layout.frame_offset},
         {.location = interop::kUvLocation, .format = uv, .offset = layout.uv_offset}}};
    if (has_colors(forms)) {
        input.attributes.push_back({.location = interop::kColorLocation,
                                    .format = VK_FORMAT_R8G8B8A8_UNORM,
                                    .offset = layout.color_offset});
    }
    return input;
}

/// What messages of the validation layers call a pipeline.
std::string name_of(const PipelineKey& key) {
    const char* const file = kShaderFiles[1 + static_cast<std::size_t>(key.shading)];
    return fmt::format("{}{}, {}", file, has_colors(key.forms) ? " with vertex colours" : "",
                       key.side.view < kViews.size() ? kViews[key.side.view].name : "any view");
}

/// The values of all specialisation constants, indexed by their id.
std::array<std::uint32_t, interop::kSpecializationCount> constants_of(const PipelineKey& key) {
    std::array<std::uint32_t, interop::kSpecializationCount> values{};
    values[interop::kPositionFormConstant] = static_cast<std::uint32_t>(key.forms.position);
    values[interop::kFrameFormConstant] = static_cast<std::uint32_t>(key.forms.frame);
    values[interop::kUvFormConstant] = static_cast<std::uint32_t>(key.forms.uv);
    values[interop::kViewConstant] = key.side.view;
    values[interop::kNormalMapConstant] = key.side.normal_map ? 1 : 0;
    values[interop::kAlphaMaskConstant] = !key.alpha_mask       ? interop::kAlphaMaskAbsent
                                          : key.side.alpha_mask ? 1
                                                                : 0;
    values[interop::kMergedMapsConstant] = key.merged_maps ? 1 : 0;
    values[interop::kRoughnessMapConstant] = key.roughness_map ? 1 : 0;
    values[interop::kMetalnessMapConstant] = key.metalness_map ? 1 : 0;
    values[interop::kFalseColorConstant] = key.false_color ? 1 : 0;
    values[interop::kUnlitConstant] = key.unlit ? 1 : 0;
    values[interop::kChangingUvsConstant] = key.changing_uvs ? 1 : 0;
    return values;
}

}  // namespace

Layouts::Layouts(const Device& device) : scene_set(make_scene_set_layout(device)) {
    for (std::size_t i = 0; i < kShadingCount; ++i) {
        material_sets[i] = make_material_set_layout(device, static_cast<Shading>(i));
        pipelines[i] = make_pipeline_layout(device, scene_set.get(), material_sets[i].get());
    }
}

ShaderCode built_in_shaders() {
    return {{{mesh_vert, mesh_colors_vert},
             {opaque_frag, opaque_colors_frag},
             {alpha_mask_frag, alpha_mask_colors_frag},
             {emissive_frag, emissive_colors_frag}}};
}

Pipelines::Pipelines(const Device& device, const Layouts& layouts, const ShaderCode& code,
                     const AttachmentFormats& formats)
    : device_(&device), layouts_(&layouts), formats_(formats) {
    for (std::size_t i = 0; i < code.size(); ++i) {
        for (const bool colors : {false, true}) {
            modules_[i][colors] = make_module(device, code[i][colors]);
        }
    }
}

VkPipeline Pipelines::get(const PipelineKey& key) {
    const auto [entry, is_new] = pipelines_.try_emplace(key);
    if (is_new) {
        entry->second = build(key);
        device_->name(entry->second.get(), name_of(key));
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
    const bool colors = has_colors(key.forms);
    const std::array stages{stage(VK_SHADER_STAGE_VERTEX_BIT, modules_[0][colors]),
                            stage(VK_SHADER_STAGE_FRAGMENT_BIT,
                                  modules_[1 + static_cast<std::size_t>(key.shading)][colors])};

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
