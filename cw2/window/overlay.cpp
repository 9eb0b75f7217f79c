#include "cw2/window/overlay.h"

#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "cw2/options/controls.h"

namespace cw2 {

namespace {

/// Dark, so that what is written on it can be read over any picture.
void draw_ground(ImDrawList& list, const ImVec2& low, const ImVec2& high, float scale) {
    ImVec4 color = ImGui::GetStyleColorVec4(ImGuiCol_WindowBg);
    color.w = 0.97f;
    list.AddRectFilled(low, high, ImGui::GetColorU32(color), 6.0f * scale);
}

/// "~/" at the beginning is the user's folder.
std::string with_home(const std::string& text) {
    const char* const home = std::getenv("HOME");
    return text.starts_with("~/") && home != nullptr ? home + text.substr(1) : text;
}

int complete(ImGuiInputTextCallbackData* data) {
    const std::string whole =
        completed_path({data->Buf, static_cast<std::size_t>(data->BufTextLen)});
    if (whole.size() < static_cast<std::size_t>(data->BufSize)) {
        data->DeleteChars(0, data->BufTextLen);
        data->InsertChars(0, whole.c_str());
    }
    return 0;
}

}  // namespace

void draw_line(const std::string& words, bool is_error, float scale) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float margin = 10.0f * scale;
    const float pad = 7.0f * scale;
    const ImVec2 size = ImGui::CalcTextSize(words.c_str());
    const float width = std::min(size.x, screen.x - 2.0f * (margin + pad));
    const ImVec2 low{margin, screen.y - margin - 2.0f * pad - size.y};
    const ImVec2 high{low.x + width + 2.0f * pad, screen.y - margin};
    draw_ground(list, low, high, scale);
    const ImVec4 clip{low.x + pad, low.y, high.x - pad, high.y};
    const ImU32 ink = is_error ? ImGui::GetColorU32({1.0f, 0.25f, 0.15f, 1.0f})
                               : ImGui::GetColorU32(ImGuiCol_Text);
    list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {low.x + pad, low.y + pad}, ink,
                 words.c_str(), nullptr, 0.0f, &clip);
}

void draw_help(float scale) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float pad = 14.0f * scale;
    const float gap = 16.0f * scale;
    float input_width = 0.0f, does_width = 0.0f;
    for (const Control& control : kControls) {
        const auto width = [](std::string_view text) {
            return ImGui::CalcTextSize(text.data(), text.data() + text.size()).x;
        };
        input_width = std::max(input_width, width(control.input));
        does_width = std::max(does_width, width(control.does));
    }
    const float column = input_width + gap + does_width;
    const float row = 1.35f * ImGui::GetFontSize();
    // One column or two, whichever can be drawn larger.
    const auto fit = [&](int columns) {
        const auto rows = static_cast<float>((std::ssize(kControls) + columns - 1) / columns);
        return std::min({1.0f, screen.x / (2.0f * pad + column + (columns - 1) * (column + gap)),
                         screen.y / (2.0f * pad + rows * row)});
    };
    const int columns = fit(2) > fit(1) ? 2 : 1;
    const float factor = fit(columns);
    const int rows = (static_cast<int>(kControls.size()) + columns - 1) / columns;
    const ImVec2 size{factor * (2.0f * pad + column + (columns - 1) * (column + gap)),
                      factor * (2.0f * pad + static_cast<float>(rows) * row)};
    const ImVec2 low{0.5f * (screen.x - size.x), 0.5f * (screen.y - size.y)};
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    draw_ground(list, low, {low.x + size.x, low.y + size.y}, scale);
    for (int i = 0; i < static_cast<int>(kControls.size()); ++i) {
        const Control& control = kControls[static_cast<std::size_t>(i)];
        const float x = low.x + factor * (pad + static_cast<float>(i / rows) * (column + gap));
        const float y = low.y + factor * (pad + static_cast<float>(i % rows) * row);
        const auto write = [&](float left, ImGuiCol ink, std::string_view text) {
            list.AddText(ImGui::GetFont(), factor * ImGui::GetFontSize(), {left, y},
                         ImGui::GetColorU32(ink), text.data(), text.data() + text.size());
        };
        write(x, ImGuiCol_Text, control.input);
        write(x + factor * (input_width + gap), ImGuiCol_TextDisabled, control.does);
    }
}

void PathField::open() {
    open_ = just_opened_ = true;
}

std::optional<std::filesystem::path> PathField::draw(float scale) {
    if (!open_) return std::nullopt;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float width = std::min(560.0f * scale, 0.9f * screen.x);
    ImGui::SetNextWindowPos({0.5f * screen.x, 0.4f * screen.y}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({width, 0.0f});
    ImGui::Begin(
        "Open a file", &open_,
        ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings);
    if (just_opened_) ImGui::SetWindowFocus();
    if (std::exchange(just_opened_, false)) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-1.0f);
    bool entered = ImGui::InputText(
        "##path", text_.data(), text_.size(),
        ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion, complete);
    entered |= ImGui::Button("Open");
    ImGui::SameLine();
    if (ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) {
        open_ = false;
    }
    ImGui::SameLine();
    ImGui::TextDisabled("Tab completes; a file can be dropped on the window, too");
    ImGui::End();
    if (!entered || text_[0] == '\0') return std::nullopt;
    open_ = false;
    return with_home(text_.data());
}

std::string completed_path(const std::string& text) {
    const std::filesystem::path begun = with_home(text);
    const std::filesystem::path folder = begun.parent_path();
    const std::string start = begun.filename().string();
    std::optional<std::string> common;
    bool is_one_folder = false;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error), end;
         !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (!name.starts_with(start)) continue;
        is_one_folder = !common && entry->is_directory(error);
        if (common) {
            const auto [differs, ignored] = std::ranges::mismatch(*common, name);
            common->erase(differs, common->end());
        } else {
            common = name;
        }
    }
    if (!common) return text;
    return (folder / *common).string() + (is_one_folder ? "/" : "");
}

}  // namespace cw2
