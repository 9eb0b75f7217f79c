// The GLSL decoder of the packed tangent frames against the C++ one on lavapipe: the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "cw2/vulkan/resources.h"
#include "decode_frames.comp.h"
#include "mesh-format/tangent_frame.h"
#include "tests/frame_truth.h"

namespace {

using namespace frame_truth;
using cw2::check;
using mesh_format::FrameForm;

constexpr std::uint32_t kGroupSize = 64;  // local_size_x of decode_frames.comp

/// A frame as decode_frames.comp reads it: the 16-bit units of its bytes, or 32-bit ones for f32.
using Code = std::array<std::uint32_t, 4>;

/// As decode_frames.comp writes it.
struct Decoded {
    float tangent[3];
    float handedness;
    float normal[3];
    float padding;
};

cw2::DescriptorSetLayout make_set_layout(VkDevice device) {
    constexpr VkDescriptorSetLayoutBinding kBindings[] = {
        {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr}};
    const VkDescriptorSetLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 2,
        .pBindings = kBindings};
    VkDescriptorSetLayout layout{};
    check(vkCreateDescriptorSetLayout(device, &info, nullptr, &layout), "the set layout");
    return {device, layout};
}

cw2::PipelineLayout make_pipeline_layout(VkDevice device, VkDescriptorSetLayout set_layout) {
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = 1,
                                          .pSetLayouts = &set_layout};
    VkPipelineLayout layout{};
    check(vkCreatePipelineLayout(device, &info, nullptr, &layout), "the pipeline layout");
    return {device, layout};
}

cw2::Pipeline make_pipeline(VkDevice device, VkPipelineLayout layout, FrameForm form) {
    const VkShaderModuleCreateInfo module_info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                               .codeSize = sizeof decode_frames_comp,
                                               .pCode = decode_frames_comp};
    VkShaderModule module{};
    check(vkCreateShaderModule(device, &module_info, nullptr, &module), "the shader");
    const cw2::ShaderModule owner(device, module);

    const auto value = static_cast<std::uint32_t>(form);
    const VkSpecializationMapEntry entry{0, 0, sizeof value};
    const VkSpecializationInfo constants{1, &entry, sizeof value, &value};
    const VkComputePipelineCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &constants},
        .layout = layout};
    VkPipeline pipeline{};
    check(vkCreateComputePipelines(device, nullptr, 1, &info, nullptr, &pipeline), "the pipeline");
    return {device, pipeline};
}

cw2::DescriptorPool make_pool(VkDevice device) {
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2};
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = 1,
                                          .poolSizeCount = 1,
                                          .pPoolSizes = &size};
    VkDescriptorPool pool{};
    check(vkCreateDescriptorPool(device, &info, nullptr, &pool), "the descriptor pool");
    return {device, pool};
}

VkDescriptorSet make_set(VkDevice device, VkDescriptorPool pool, VkDescriptorSetLayout layout,
                         VkBuffer codes, VkBuffer frames) {
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &layout};
    VkDescriptorSet set{};
    check(vkAllocateDescriptorSets(device, &info, &set), "the descriptor set");
    const VkDescriptorBufferInfo buffers[] = {{codes, 0, VK_WHOLE_SIZE},
                                              {frames, 0, VK_WHOLE_SIZE}};
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set,
                                     .descriptorCount = 2,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                     .pBufferInfo = buffers};
    vkUpdateDescriptorSets(device, 1, &write, 0, nullptr);
    return set;
}

/// Runs decode_frames.comp over `codes`, a multiple of kGroupSize.
std::vector<Decoded> decode(const cw2::Device& device, FrameForm form,
                            std::span<const Code> codes) {
    const VkDevice vk = device.get();
    const cw2::Buffer input = cw2::make_buffer(
        device, codes.size_bytes(), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, cw2::MemoryUse::upload);
    const cw2::Buffer output =
        cw2::make_buffer(device, codes.size() * sizeof(Decoded), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                         cw2::MemoryUse::readback);
    std::memcpy(input.mapped.data(), codes.data(), codes.size_bytes());

    const cw2::DescriptorSetLayout set_layout = make_set_layout(vk);
    const cw2::PipelineLayout layout = make_pipeline_layout(vk, set_layout.get());
    const cw2::Pipeline pipeline = make_pipeline(vk, layout.get(), form);
    const cw2::DescriptorPool pool = make_pool(vk);
    const VkDescriptorSet set =
        make_set(vk, pool.get(), set_layout.get(), input.handle.get(), output.handle.get());

    const cw2::CommandPool command_pool = cw2::make_command_pool(device);
    const VkCommandBuffer commands = cw2::allocate_commands(device, command_pool.get());
    cw2::begin_commands(commands);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout.get(), 0, 1, &set, 0,
                            nullptr);
    vkCmdDispatch(commands, static_cast<std::uint32_t>(codes.size()) / kGroupSize, 1, 1);
    const VkMemoryBarrier to_host{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                         0, 1, &to_host, 0, nullptr, 0, nullptr);
    cw2::submit_and_wait(device, commands);

    std::vector<Decoded> frames(codes.size());
    std::memcpy(frames.data(), output.mapped.data(), frames.size() * sizeof(Decoded));
    return frames;
}

Code code_of(FrameForm form, const std::byte* bytes) {
    Code code{};
    if (form == FrameForm::f32) {
        std::memcpy(code.data(), bytes, sizeof code);
    } else {
        std::uint16_t words[3] = {};
        std::memcpy(words, bytes, mesh_format::frame_bytes(form));
        std::copy_n(words, 3, code.begin());
    }
    return code;
}

constexpr const char* kNames[] = {"quat48", "quat32", "half3", "f32"};

std::string name_of(const testing::TestParamInfo<FrameForm>& info) {
    return kNames[static_cast<std::size_t>(info.param)];
}

class FrameDecoder : public testing::TestWithParam<FrameForm> {};

/// Random and adversarial frames, packed, and random bytes: NaN, infinities and denormals too.
TEST_P(FrameDecoder, GlslGivesTheBitsOfCpp) {
    constexpr std::size_t kCount = 1 << 21;
    const FrameForm form = GetParam();
    Random random(1);
    std::vector<std::array<std::byte, 16>> bytes(kCount);
    std::vector<Code> codes(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        if (i % 2 == 0) {
            const Quaternion q = i % 4 ? adversarial_rotation(random) : random_rotation(random);
            mesh_format::pack_frame(form, frame_of(q, random() & 1), bytes[i].data());
        } else {
            const std::uint64_t words[2] = {random(), random()};
            std::memcpy(bytes[i].data(), words, sizeof words);
        }
        codes[i] = code_of(form, bytes[i].data());
    }

    const cw2::Instance instance(true, {});
    std::vector<Decoded> decoded;
    {
        const cw2::Device lavapipe(instance, "llvmpipe");
        decoded = decode(lavapipe, form, codes);
    }
    EXPECT_EQ(instance.validation_messages(), 0);

    std::size_t different = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
        const TangentFrame cpp = mesh_format::unpack_frame(form, bytes[i].data());
        const auto& [t, s, n, padding] = decoded[i];
        const TangentFrame glsl{{t[0], t[1], t[2]}, {n[0], n[1], n[2]}, s};
        if (std::memcmp(&cpp, &glsl, sizeof cpp) != 0 && ++different <= 3) {
            ADD_FAILURE() << "code " << testing::PrintToString(codes[i]) << ": tangents in C++ "
                          << testing::PrintToString(cpp.tangent) << ", in GLSL "
                          << testing::PrintToString(glsl.tangent) << "; the frames are "
                          << mesh_format::frame_angle(cpp, glsl) << " degrees apart";
        }
    }
    EXPECT_EQ(different, 0u);
}

INSTANTIATE_TEST_SUITE_P(Forms, FrameDecoder,
                         testing::Values(FrameForm::quat48, FrameForm::quat32, FrameForm::half3,
                                         FrameForm::f32),
                         name_of);

}  // namespace
