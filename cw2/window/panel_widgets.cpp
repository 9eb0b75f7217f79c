#include "cw2/window/panel_widgets.h"

#include <imgui.h>

#include <algorithm>

namespace cw2 {

namespace {

// Widths, in font sizes.
constexpr float kWindowWidth = 24.0f;
constexpr float kLabelWidth = 7.2f;  // of what is at the left of a row
constexpr float kColumnWidth = 5.0f;
constexpr float kNumberWidth = 4.2f;  // beside a slider

float width_of_window() {
    // On a small picture a window takes no more than its larger part.
    return std::min(kWindowWidth * ImGui::GetFontSize(), 0.6f * ImGui::GetIO().DisplaySize.x);
}

float margin(float scale) {
    return 8.0f * scale;
}

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
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(kLabelWidth * ImGui::GetFontSize());
    const bool is_cut = ImGui::CalcTextSize(value.c_str()).x > ImGui::GetContentRegionAvail().x;
    text(value);
    if (is_cut && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", value.c_str());
}

void readings(const char* name, const std::array<std::string, 3>& values) {
    ImGui::TextDisabled("%s", name);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float left = kLabelWidth + static_cast<float>(i) * kColumnWidth;
        ImGui::SameLine(left * ImGui::GetFontSize());
        text(values[i]);
    }
}

void slider(const char* id, float& value, const Range<float>& range, const char* format) {
    constexpr ImGuiSliderFlags kClamp = ImGuiSliderFlags_AlwaysClamp;
    ImGui::PushID(id);
    const float number = kNumberWidth * ImGui::GetFontSize();
    const float rest = ImGui::GetContentRegionAvail().x - number - ImGui::GetStyle().ItemSpacing.x;
    ImGui::SetNextItemWidth(std::max(rest, 1.0f));
    ImGui::SliderFloat("##slider", &value, range.low, range.high, "",
                       kClamp | ImGuiSliderFlags_NoInput);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    ImGui::DragFloat("##number", &value, 0.002f * (range.high - range.low), range.low, range.high,
                     format, kClamp);
    ImGui::PopID();
}

bool section(const char* name, bool open) {
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

bool readings_are_apart(float scale) {
    const float windows = 2.0f * (width_of_window() + margin(scale));
    return windows <= 0.6f * ImGui::GetIO().DisplaySize.x;
}

void begin_window(const char* name, Edge edge, float scale) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float width = width_of_window();
    const float height = std::max(screen.y - 2.0f * margin(scale), 4.0f * margin(scale));
    const float left = edge == Edge::left ? margin(scale) : screen.x - width - margin(scale);
    ImGui::SetNextWindowPos({left, margin(scale)}, ImGuiCond_Appearing);
    ImGui::SetNextWindowSizeConstraints({width, 0.0f}, {width, height});
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
}

}  // namespace cw2
