#include "cw2/window/panel_widgets.h"

#include <imgui.h>

#include <algorithm>

namespace cw2 {

namespace {

constexpr float kLabelWidth = 8.0f;  // of what is at the left of a row, in font sizes

}  // namespace

void text(const std::string& words) {
    ImGui::TextUnformatted(words.data(), words.data() + words.size());
}

void dim_text(const std::string& words) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::PushTextWrapPos(0.0f);
    text(words);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void label(const char* name) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name);
    ImGui::SameLine(kLabelWidth * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(-1.0f);
}

void reading(const char* name, const std::string& value) {
    ImGui::TextUnformatted(name);
    ImGui::SameLine(kLabelWidth * ImGui::GetFontSize());
    text(value);
}

bool section(const char* name, bool open) {
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

void begin_window(const char* name, float left, float width, float scale) {
    const float margin = 8.0f * scale;
    const float height = std::max(ImGui::GetIO().DisplaySize.y - 2.0f * margin, 4.0f * margin);
    ImGui::SetNextWindowPos({left, margin}, ImGuiCond_Appearing);
    ImGui::SetNextWindowSizeConstraints({width, 0.0f}, {width, height});
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
}

}  // namespace cw2
