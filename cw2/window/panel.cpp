#include "cw2/window/panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "cw2/render/legend.h"
#include "cw2/render/view.h"
#include "cw2/window/panel_widgets.h"
#include "shaders/false_color.h"

namespace cw2 {

namespace {

constexpr ImGuiSliderFlags kClamp = ImGuiSliderFlags_AlwaysClamp;
constexpr ImGuiColorEditFlags kColor =
    ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_NoLabel;
constexpr float kLargest = 1e6f;  // value that can be entered

struct KeyHelp {
    const char* keys;
    const char* what;
};
constexpr std::array kKeys{
    KeyHelp{"Tab", "shows and hides this panel"},
    KeyHelp{"W A S D, E Q", "move the camera, up and down"},
    KeyHelp{"Shift, Ctrl", "faster, slower"},
    KeyHelp{"left button", "reads a pixel; drags the divider"},
    KeyHelp{"right button", "turns the camera"},
    KeyHelp{"Space", "light's orbit on and off"},
    KeyHelp{"1 to 9, V, Shift+V", "views"},
    KeyHelp{"N, M", "normal maps, alpha masks"},
    KeyHelp{"R", "resets camera and light"},
    KeyHelp{"Ctrl+C", "copies camera and light as options"},
    KeyHelp{"F2, S in here", "saves the settings"},
    KeyHelp{"F12, Shift+F12", "saves the picture, the window"},
    KeyHelp{"F5, Ctrl+R", "reloads the shaders"},
    KeyHelp{"Escape", "ends"},
};

/// A colour that stays finite and not negative.
void color(const char* name, const char* id, glm::vec3& value) {
    label(name);
    glm::vec3 edited = value;
    if (!ImGui::ColorEdit3(id, glm::value_ptr(edited), kColor)) return;
    for (int i = 0; i < 3; ++i) {
        if (std::isfinite(edited[i])) value[i] = std::clamp(edited[i], 0.0f, kLargest);
    }
}

void view_combo(const char* id, View& shown) {
    if (!ImGui::BeginCombo(id, kViews[shown].name.data(), ImGuiComboFlags_HeightLargest)) return;
    for (View view = 0; view < kViews.size(); ++view) {
        if (ImGui::Selectable(kViews[view].name.data(), view == shown)) shown = view;
        ImGui::SameLine(9.0f * ImGui::GetFontSize());
        ImGui::TextDisabled("%s", kViews[view].description.data());
    }
    ImGui::EndCombo();
}

void side_row(const char* name, Side& side) {
    ImGui::PushID(name);
    label(name);
    view_combo("##view", side.view);
    label("");
    ImGui::Checkbox("normal maps", &side.normal_map);
    ImGui::SameLine();
    ImGui::Checkbox("masks", &side.alpha_mask);
    ImGui::PopID();
}

void split_rows(Options& options) {
    label("split");
    bool split = options.split.has_value();
    if (ImGui::Checkbox("##split", &split)) {
        if (split) {
            // Before and after normal mapping, until something else is chosen.
            options.split = {Side{options.view, false}, Side{options.view}};
        } else {
            options.view = options.split->front().view;
            options.split.reset();
        }
    }
    if (!options.split) return;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    ImGui::SliderFloat("##divider", &options.divider, 0.0f, 1.0f, "divider at %.3f", kClamp);
    side_row("left", options.split->front());
    side_row("right", options.split->back());
}

void background_row(std::optional<glm::vec3>& background) {
    if (background) color("background", "##background", *background);
    label(background ? "" : "background");
    bool none = !background;
    if (ImGui::Checkbox("transparent in files", &none)) {
        background = none ? std::nullopt : Options{}.background;
    }
}

void view_section(Options& options) {
    if (!section("View")) return;
    if (!options.split) {
        label("shows");
        view_combo("##view", options.view);
        dim_text(std::string(kViews[options.view].description));
    }
    split_rows(options);
    label("samples");
    for (const std::uint32_t samples : {1u, 4u, 16u, 64u, 256u}) {
        if (ImGui::RadioButton(fmt::format("{}", samples).c_str(), options.samples == samples)) {
            options.samples = samples;
        }
        ImGui::SameLine();
    }
    ImGui::NewLine();
    background_row(options.background);
}

/// The colours of a range, and what they mean.
void scale_bar(const ValueRange& range) {
    constexpr int kSteps = 64;
    ImDrawList* const list = ImGui::GetWindowDrawList();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    const float height = 0.7f * ImGui::GetFontSize();
    const auto edge = [&](int step) { return at.x + width * static_cast<float>(step) / kSteps; };
    for (int i = 0; i < kSteps; ++i) {
        const glm::vec3 rgb = interop::false_color((static_cast<float>(i) + 0.5f) / kSteps);
        const ImU32 ink = ImGui::ColorConvertFloat4ToU32({rgb.r, rgb.g, rgb.b, 1.0f});
        list->AddRectFilled({edge(i), at.y}, {edge(i + 1), at.y + height}, ink);
    }
    std::vector<Tick> ticks = ticks_of(range);
    std::sort(ticks.begin(), ticks.end(),
              [](const Tick& a, const Tick& b) { return a.position < b.position; });
    float end = at.x;
    for (const Tick& tick : ticks) {
        const float size = ImGui::CalcTextSize(tick.label.c_str()).x;
        const float left = at.x + std::clamp(width * tick.position - 0.5f * size, 0.0f,
                                             std::max(width - size, 0.0f));
        // What would touch the label before is left out.
        if (left < end) continue;
        list->AddText({left, at.y + height}, ImGui::GetColorU32(ImGuiCol_Text), tick.label.c_str());
        end = left + size + 0.5f * ImGui::GetFontSize();
    }
    ImGui::Dummy({width, height + ImGui::GetTextLineHeight()});
}

void false_color_rows(Options& options) {
    label("false colours");
    bool on = options.false_color.has_value();
    if (ImGui::Checkbox("##false_color", &on)) {
        options.false_color = on ? std::optional(FalseColor{}) : std::nullopt;
    }
    if (!options.false_color) return;
    const View view = options.split ? options.split->front().view : options.view;
    std::optional<ValueRange>& range = options.false_color->range;
    ImGui::SameLine();
    bool own = !range;
    if (ImGui::Checkbox("range of the view", &own)) {
        range = own ? std::nullopt : std::optional(kViews[view].range);
    }
    const ValueRange shown = options.false_color->range_of(view);
    if (range) {
        label("from, to");
        float ends[2] = {range->low, range->high};
        const bool edited = ImGui::DragFloat2("##range", ends, 0.01f * (shown.high - shown.low),
                                              -kLargest, kLargest, "%.4g", kClamp);
        if (edited && ends[0] < ends[1]) range = ValueRange{ends[0], ends[1]};
    }
    scale_bar(shown);
}

void exposure_row(Options& options) {
    label("exposure");
    if (options.false_color) {
        ImGui::TextDisabled("none with false colours");
        return;
    }
    const View view = options.split ? options.split->front().view : options.view;
    bool own = !options.exposure;
    if (ImGui::Checkbox("of the view##exposure", &own)) {
        options.exposure = own ? std::nullopt : std::optional(kViews[view].exposure);
    }
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    if (options.exposure) {
        ImGui::SliderFloat("##exposure", &*options.exposure, -10.0f, 10.0f, "%+.1f stops", kClamp);
    } else {
        std::string stops = fmt::format("{:+.2f}", kViews[view].exposure);
        if (options.split) {
            stops += fmt::format(" | {:+.2f}", kViews[options.split->back().view].exposure);
        }
        ImGui::TextDisabled("%s stops", stops.c_str());
    }
}

void value_section(Options& options) {
    if (!section("Values as colours")) return;
    exposure_row(options);
    false_color_rows(options);
}

void light_section(PanelState& state, const Bounds& bounds) {
    if (!section("Light")) return;
    Options& options = state.options;
    label("position");
    glm::dvec3 position = to_user(
        orbit(from_user(*options.light_position, bounds), bounds.center, options.time), bounds);
    // Coordinates that can be entered, by the scene's.
    const double largest =
        1e6 * (glm::length(to_user(bounds.center, bounds)) + double{bounds.radius});
    const double smallest = -largest;
    if (ImGui::DragScalarN("##light", ImGuiDataType_Double, glm::value_ptr(position), 3,
                           0.005f * bounds.radius, &smallest, &largest, "%.6g", kClamp)) {
        options.light_position =
            to_user(orbit(from_user(position, bounds), bounds.center, -options.time), bounds);
    }
    label("orbit");
    ImGui::Checkbox("##moves", &state.light_moves);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    constexpr double kLongest = 1e6;
    constexpr double kBack = -kLongest;
    ImGui::DragScalar("##time", ImGuiDataType_Double, &options.time, 0.01f, &kBack, &kLongest,
                      "%.2f s of 6.28", kClamp);
    color("colour", "##color", *options.light_color);
    color("ambient", "##ambient", options.ambient);
}

void camera_section(Options& options, std::vector<Command>& commands) {
    if (!section("Camera")) return;
    label("field of view");
    ImGui::SliderFloat("##fov", &*options.vertical_fov, 1.0f, 179.0f, "%.1f\xc2\xb0", kClamp);
    const auto vector = [](const glm::dvec3& v) {
        return fmt::format("{:.6g}, {:.6g}, {:.6g}", v.x, v.y, v.z);
    };
    reading("at", vector(*options.camera_position));
    reading("towards", vector(*options.camera_target));
    if (ImGui::Button("Copy as options")) commands.push_back({CommandKind::copy_camera});
    ImGui::SameLine();
    if (ImGui::Button("Reset with light")) commands.push_back({CommandKind::reset});
}

/// A number that is every material's where the box is ticked.
void override_row(const char* name, const char* id, std::optional<float>& value) {
    ImGui::PushID(id);
    label(name);
    bool overridden = value.has_value();
    if (ImGui::Checkbox("##on", &overridden)) {
        value = overridden ? std::optional(0.5f) : std::nullopt;
    }
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    if (value) {
        ImGui::SliderFloat("##value", &*value, 0.0f, 1.0f, "%.3f", kClamp);
    } else {
        ImGui::TextDisabled("each its own");
    }
    ImGui::PopID();
}

void material_section(Options& options) {
    if (!section("Materials")) return;
    override_row("roughness", "roughness", options.roughness);
    override_row("metalness", "metalness", options.metalness);
    label("normal maps");
    ImGui::Checkbox("##normal_map", &options.normal_map);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    ImGui::SliderFloat("##normal_strength", &options.normal_strength, 0.0f, 4.0f, "slopes x %.2f",
                       kClamp);
    label("alpha masks");
    ImGui::Checkbox("##alpha_mask", &options.alpha_mask);
}

void file_buttons(std::vector<Command>& commands) {
    const auto button = [&](const char* name, CommandKind kind, const char* tip) {
        if (ImGui::Button(name)) commands.push_back({kind});
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
    };
    button("Save settings", CommandKind::save_settings, "for --config; S or F2");
    ImGui::SameLine();
    button("Save picture", CommandKind::save_picture, "without the panel; F12");
    ImGui::SameLine();
    button("Reload shaders", CommandKind::reload_shaders, "from their sources; F5");
}

void key_section() {
    if (!section("Keys", false)) return;
    for (const KeyHelp& key : kKeys) {
        ImGui::TextUnformatted(key.keys);
        ImGui::SameLine(ImGui::GetFontSize() * 10.5f);
        ImGui::TextDisabled("%s", key.what);
    }
}

}  // namespace

std::vector<Command> draw_panel(const PanelFacts& facts, PanelState& state) {
    std::vector<Command> commands;
    draw_readings(facts);
    begin_window("cw2", 8.0f * facts.scale, 344.0f * facts.scale, facts.scale);
    view_section(state.options);
    value_section(state.options);
    light_section(state, facts.bounds);
    camera_section(state.options, commands);
    material_section(state.options);
    ImGui::Separator();
    file_buttons(commands);
    if (!facts.message.empty()) {
        if (facts.message_is_error) {
            ImGui::PushStyleColor(ImGuiCol_Text, {1.0f, 0.25f, 0.15f, 1.0f});
            ImGui::TextWrapped("%s", facts.message.c_str());
            ImGui::PopStyleColor();
        } else {
            dim_text(facts.message);
        }
    }
    key_section();
    ImGui::End();
    return commands;
}

std::string camera_flags(const Options& options) {
    const auto vector = [](const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    std::string flags =
        fmt::format("--camera-position {} --camera-target {} --fov {} --light-position {}",
                    vector(*options.camera_position), vector(*options.camera_target),
                    *options.vertical_fov, vector(*options.light_position));
    if (options.time != 0.0) flags += fmt::format(" --time {}", options.time);
    return flags;
}

}  // namespace cw2
