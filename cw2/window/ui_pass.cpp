#include "cw2/window/ui_pass.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "common/srgb.h"
#include "cw2/vulkan/resources.h"

namespace cw2 {

namespace {

constexpr float kFontPixels = 13.0f;  // that ImGui's own font is drawn for

void check_result(VkResult result) {
    check(result, "Dear ImGui");
}

/// Keeps the image's contents and its layout.
RenderPass make_pass(const Device& device, VkFormat format) {
    constexpr VkImageLayout kLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkAttachmentDescription attachment{.format = format,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                             .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                             .initialLayout = kLayout,
                                             .finalLayout = kLayout};
    const VkAttachmentReference reference{0, kLayout};
    const VkSubpassDescription subpass{.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                       .colorAttachmentCount = 1,
                                       .pColorAttachments = &reference};
    const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                      .attachmentCount = 1,
                                      .pAttachments = &attachment,
                                      .subpassCount = 1,
                                      .pSubpasses = &subpass};
    VkRenderPass pass = VK_NULL_HANDLE;
    check(vkCreateRenderPass(device.get(), &info, nullptr, &pass), "vkCreateRenderPass");
    return {device.get(), pass};
}

Framebuffer make_framebuffer(const Device& device, VkRenderPass pass, VkImageView view,
                             VkExtent2D extent) {
    const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                       .renderPass = pass,
                                       .attachmentCount = 1,
                                       .pAttachments = &view,
                                       .width = extent.width,
                                       .height = extent.height,
                                       .layers = 1};
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    check(vkCreateFramebuffer(device.get(), &info, nullptr, &framebuffer), "vkCreateFramebuffer");
    return {device.get(), framebuffer};
}

/// Greys and one accent; the target encodes what it is given, so colours are linear.
void set_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 4.0f;
    style.FrameRounding = 3.0f;
    style.GrabRounding = 3.0f;
    style.WindowPadding = {8.0f, 6.0f};
    style.FramePadding = {6.0f, 2.0f};
    style.ItemSpacing = {6.0f, 4.0f};
    style.ScaleAllSizes(scale);
    style.Colors[ImGuiCol_WindowBg] = {0.14f, 0.15f, 0.16f, 1.0f};
    style.Colors[ImGuiCol_PopupBg] = {0.10f, 0.11f, 0.12f, 1.0f};
    style.Colors[ImGuiCol_TextDisabled] = {0.65f, 0.66f, 0.68f, 1.0f};
    for (const ImGuiCol title : {ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_Header}) {
        style.Colors[title] = {0.20f, 0.27f, 0.36f, 1.0f};
    }
    for (const ImGuiCol frame : {ImGuiCol_FrameBg, ImGuiCol_Button}) {
        style.Colors[frame] = {0.24f, 0.28f, 0.33f, 1.0f};
    }
    for (ImVec4& color : style.Colors) {
        color = {common::linear_of_srgb(color.x), common::linear_of_srgb(color.y),
                 common::linear_of_srgb(color.z), color.w};
    }
}

}  // namespace

UiPass::Context::Context() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
}

UiPass::Context::~Context() {
    ImGui::DestroyContext();
}

UiPass::UiPass(GLFWwindow* window, const Instance& instance, const Device& device, VkFormat format,
               std::uint32_t slots, float scale)
    : device_(device),
      pass_(make_pass(device, format)),
      descriptor_pool_(
          make_descriptor_pool(device, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, 1)),
      framebuffers_(slots) {
    ImGuiIO& io = ImGui::GetIO();
    // Nothing is written into the user's folder unasked.
    io.IniFilename = nullptr;
    ImFontConfig font;
    font.SizePixels = std::floor(kFontPixels * scale);
    io.Fonts->AddFontDefault(&font);
    set_style(scale);
    ImGui_ImplGlfw_InitForVulkan(window, true);
    ImGui_ImplVulkan_InitInfo info{.Instance = instance.get(),
                                   .PhysicalDevice = device.physical(),
                                   .Device = device.get(),
                                   .QueueFamily = device.queue_family(),
                                   .Queue = device.queue(),
                                   .DescriptorPool = descriptor_pool_.get(),
                                   .MinImageCount = std::max(slots, 2u),
                                   .ImageCount = std::max(slots, 2u),
                                   .MSAASamples = VK_SAMPLE_COUNT_1_BIT,
                                   .CheckVkResultFn = check_result};
    ImGui_ImplVulkan_Init(&info, pass_.get());
    upload_font();
}

UiPass::~UiPass() {
    ImGui_ImplVulkan_Shutdown();
    ImGui_ImplGlfw_Shutdown();
}

void UiPass::upload_font() const {
    const CommandPool pool = make_command_pool(device_);
    const VkCommandBuffer commands = allocate_commands(device_, pool.get());
    begin_commands(commands);
    ImGui_ImplVulkan_CreateFontsTexture(commands);
    submit_and_wait(device_, commands);
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void UiPass::begin_frame(const Input& input, bool has_mouse) {
    ImGuiIO& io = ImGui::GetIO();
    io.ConfigFlags = has_mouse ? ImGuiConfigFlags_None : ImGuiConfigFlags_NoMouse;
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    // The backend mixes presses since the last frame with where the cursor went afterwards.
    std::ranges::copy(input.buttons, io.MouseDown);
    if (ImGui::IsMousePosValid()) {
        io.MousePos = {input.cursor.x / io.DisplayFramebufferScale.x,
                       input.cursor.y / io.DisplayFramebufferScale.y};
    }
    ImGui::NewFrame();
}

void UiPass::end_frame() {
    ImGui::Render();
}

bool UiPass::wants_mouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool UiPass::wants_keys() const {
    return ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow);
}

bool UiPass::wants_text() const {
    return ImGui::GetIO().WantTextInput;
}

void UiPass::drop_focus() {
    ImGui::SetWindowFocus(nullptr);
}

void UiPass::record(VkCommandBuffer commands, std::uint32_t slot, VkImageView target,
                    VkExtent2D extent) {
    ImDrawData* const data = ImGui::GetDrawData();
    // In the middle of a change of size the panel may be laid out for another one.
    if (data == nullptr ||
        data->DisplaySize.x * data->FramebufferScale.x != static_cast<float>(extent.width) ||
        data->DisplaySize.y * data->FramebufferScale.y != static_cast<float>(extent.height)) {
        return;
    }
    framebuffers_[slot] = make_framebuffer(device_, pass_.get(), target, extent);
    const VkRenderPassBeginInfo begin{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                      .renderPass = pass_.get(),
                                      .framebuffer = framebuffers_[slot].get(),
                                      .renderArea = {{0, 0}, extent}};
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(data, commands);
    vkCmdEndRenderPass(commands);
}

}  // namespace cw2
