#include "cw2/window/ui_pass.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "common/program.h"
#include "common/srgb.h"
#include "cw2/vulkan/resources.h"

namespace cw2 {

namespace {

constexpr float kFontPixels = 14.0f;     // at scale 1
constexpr float kOwnFontPixels = 13.0f;  // that ImGui's own font is drawn for
constexpr int kMostVertices = 65536;     // more than the panel and the help have

/// DejaVu Sans where it comes with the program, else where Debian, Fedora and Arch have it.
std::optional<std::filesystem::path> font_file() {
    for (const std::filesystem::path& path :
         {common::beside_program("../share/cw2/DejaVuSans.ttf"),
          std::filesystem::path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"),
          std::filesystem::path("/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf"),
          std::filesystem::path("/usr/share/fonts/TTF/DejaVuSans.ttf")}) {
        if (std::ifstream(path).good()) return path;
    }
    return std::nullopt;
}

/// Letters of the size that the display asks for; ImGui's own where the font is not installed.
void add_font(float scale) {
    // Latin, Greek and Cyrillic, for the names of files and materials, and punctuation.
    static constexpr ImWchar kLetters[] = {0x20, 0x24f, 0x370, 0x52f, 0x2010, 0x2044, 0};
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    if (const auto file = font_file()) {
        fonts.AddFontFromFileTTF(file->c_str(), std::round(kFontPixels * scale), nullptr, kLetters);
        return;
    }
    ImFontConfig own;
    own.SizePixels = std::floor(kOwnFontPixels * scale);
    fonts.AddFontDefault(&own);
}

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
    style.WindowRounding = 6.0f;
    style.FrameRounding = 4.0f;
    style.PopupRounding = 4.0f;
    style.GrabRounding = 4.0f;
    style.ScrollbarRounding = 4.0f;
    style.WindowBorderSize = 0.0f;
    style.WindowPadding = {10.0f, 8.0f};
    style.FramePadding = {6.0f, 2.0f};
    style.ItemSpacing = {6.0f, 4.0f};
    style.ScrollbarSize = 11.0f;
    style.WindowTitleAlign = {0.02f, 0.5f};
    style.ScaleAllSizes(scale);
    const ImVec4 ground{0.13f, 0.13f, 0.14f, 1.0f}, field{0.27f, 0.28f, 0.31f, 1.0f},
        head{0.18f, 0.19f, 0.21f, 1.0f}, light{0.36f, 0.38f, 0.41f, 1.0f},
        accent{0.36f, 0.62f, 0.95f, 1.0f};
    const auto paint = [&](const ImVec4& color, std::initializer_list<ImGuiCol> parts) {
        for (const ImGuiCol part : parts) style.Colors[part] = color;
    };
    paint(ground, {ImGuiCol_WindowBg, ImGuiCol_PopupBg});
    paint(head, {ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed,
                 ImGuiCol_Header, ImGuiCol_ScrollbarBg});
    paint(field, {ImGuiCol_FrameBg, ImGuiCol_Button});
    paint(light, {ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive, ImGuiCol_HeaderHovered,
                  ImGuiCol_HeaderActive, ImGuiCol_ButtonHovered, ImGuiCol_ButtonActive,
                  ImGuiCol_ScrollbarGrab, ImGuiCol_Separator});
    paint(accent, {ImGuiCol_CheckMark, ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive,
                   ImGuiCol_TextSelectedBg, ImGuiCol_ScrollbarGrabActive});
    style.Colors[ImGuiCol_Text] = {0.92f, 0.92f, 0.93f, 1.0f};
    style.Colors[ImGuiCol_TextDisabled] = {0.62f, 0.64f, 0.67f, 1.0f};
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
      window_(window),
      pass_(make_pass(device, format)),
      descriptor_pool_(
          make_descriptor_pool(device, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, 1)),
      framebuffers_(slots) {
    ImGuiIO& io = ImGui::GetIO();
    // Nothing is written into the user's folder unasked.
    io.IniFilename = nullptr;
    add_font(scale);
    set_style(scale);
    ImGui_ImplGlfw_InitForVulkan(window, true);
    ImGui_ImplVulkan_InitInfo info{.Instance = instance.get(),
                                   .PhysicalDevice = device.physical(),
                                   .Device = device.get(),
                                   .QueueFamily = device.queue_family(),
                                   .Queue = device.queue().get(),
                                   .DescriptorPool = descriptor_pool_.get(),
                                   .MinImageCount = std::max(slots, 2u),
                                   .ImageCount = std::max(slots, 2u),
                                   .MSAASamples = VK_SAMPLE_COUNT_1_BIT,
                                   .CheckVkResultFn = check_result};
    ImGui_ImplVulkan_Init(&info, pass_.get());
    fill();
}

UiPass::Backends::~Backends() {
    if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplVulkan_Shutdown();
    if (ImGui::GetIO().BackendPlatformUserData != nullptr) ImGui_ImplGlfw_Shutdown();
}

/// Uploads the font, and makes the buffers of vertices as large as they will ever be: one that
/// could not grow ImGui would free twice.
void UiPass::fill() const {
    const CommandPool pool = make_command_pool(device_);
    const VkCommandBuffer commands = allocate_commands(device_, pool.get());
    begin_commands(commands);
    ImDrawData largest;
    largest.Valid = true;
    largest.DisplaySize = largest.FramebufferScale = {1.0f, 1.0f};
    largest.TotalVtxCount = kMostVertices;
    largest.TotalIdxCount = kMostVertices / 4 * 6;
    for (std::size_t i = 0; i < framebuffers_.size(); ++i)
        ImGui_ImplVulkan_RenderDrawData(&largest, commands);
#if IMGUI_VERSION_NUM >= 19000
    ImGui_ImplVulkan_CreateFontsTexture();
    submit_and_wait(device_, commands);
#else
    ImGui_ImplVulkan_CreateFontsTexture(commands);
    submit_and_wait(device_, commands);
    ImGui_ImplVulkan_DestroyFontUploadObjects();
#endif
}

void UiPass::begin_frame(const Input& input, bool has_mouse) {
    ImGuiIO& io = ImGui::GetIO();
    io.ConfigFlags = has_mouse ? ImGuiConfigFlags_None : ImGuiConfigFlags_NoMouse;
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    input_.before_frame(window_, input);
    ImGui::NewFrame();
    input_.after_frame(input);
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
