#include "cw2/window/panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "cw2/options/controls.h"
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

/// A colour that stays finite and not negative.
void color(const char* name, const char* id, glm::vec3& value) {
    label(name);
    glm::vec3 edited = value;
    if (!ImGui::ColorEdit3(id, glm::value_ptr(edited), kColor)) return;
    for (int i = 0; i < 3; ++i) {
        if (std::isfinite(edited[i])) value[i] = std::clamp(edited[i], 0.0f, kLargest);
    }
}

/// The key that shows a view; empty where only the next and the one before can be asked for.
std::string key_of(View view) {
    if (view < 9) return std::to_string(view + 1);
    return view < 18 ? "Shift+" + std::to_string(view - 8) : std::string();
}

void describe_if_hovered(View view) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", kViews[view].description.data());
}

void view_combo(const char* id, View& shown) {
    const bool open =
        ImGui::BeginCombo(id, kViews[shown].name.data(), ImGuiComboFlags_HeightLargest);
    describe_if_hovered(shown);
    if (!open) return;
    for (View view = 0; view < kViews.size(); ++view) {
        if (ImGui::Selectable(kViews[view].name.data(), view == shown)) shown = view;
        describe_if_hovered(view);
        ImGui::SameLine(11.0f * ImGui::GetFontSize());
        ImGui::TextDisabled("%s", key_of(view).c_str());
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
    slider("divider", options.divider, kDividerRange, "%.3f");
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
        ImGui::DragFloat("##exposure", &*options.exposure, 0.02f, kExposureRange.low,
                         kExposureRange.high, "%+.2f stops", kClamp);
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
    const auto after = [&](const glm::dvec3& start, double seconds) {
        return to_user(orbit(from_user(start, bounds), bounds.center, seconds, options.orbit_axis),
                       bounds);
    };
    glm::dvec3 position = after(*options.light_position, options.time);
    // Coordinates that can be entered, by the scene's.
    const double largest =
        1e6 * (glm::length(to_user(bounds.center, bounds)) + double{bounds.radius});
    const double smallest = -largest;
    if (ImGui::DragScalarN("##light", ImGuiDataType_Double, glm::value_ptr(position), 3,
                           0.005f * bounds.radius, &smallest, &largest, "%.5g", kClamp)) {
        options.light_position = after(position, -options.time);
    }
    label("orbit");
    ImGui::Checkbox("##moves", &state.light_moves);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0f);
    constexpr double kLongest = 1e6;
    constexpr double kBack = -kLongest;
    ImGui::DragScalar("##time", ImGuiDataType_Double, &options.time, 0.01f, &kBack, &kLongest,
                      "%.2f s of 6.28", kClamp);
    label("orbit about");
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
        const char name[] = {"xyz"[static_cast<int>(axis)], '\0'};
        if (ImGui::RadioButton(name, options.orbit_axis == axis) && options.orbit_axis != axis) {
            // It goes on from where it is.
            options.orbit_axis = axis;
            options.light_position = after(position, -options.time);
        }
        ImGui::SameLine();
    }
    ImGui::NewLine();
    color("colour", "##color", *options.light_color);
    color("ambient", "##ambient", options.ambient);
}

/// One of `columns` buttons in a row; what it does, and its keys, are in the table of controls.
void button(const char* name, CommandKind kind, int columns, std::vector<Command>& commands) {
    const float gaps = static_cast<float>(columns - 1) * ImGui::GetStyle().ItemSpacing.x;
    const float whole = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
    const ImVec2 size{std::floor((whole - gaps) / static_cast<float>(columns)), 0.0f};
    if (ImGui::Button(name, size)) commands.push_back({kind});
    if (!ImGui::IsItemHovered()) return;
    const auto control = std::ranges::find(kControls, kind, &Control::command);
    ImGui::SetTooltip("%s: %s", control->input.data(), control->does.data());
}

void camera_section(Options& options, std::vector<Command>& commands) {
    if (!section("Camera")) return;
    label("field of view");
    slider("fov", *options.vertical_fov, kFovRange, "%.1f\xc2\xb0");
    const auto vector = [](const glm::dvec3& v) {
        return fmt::format("{:.6g}, {:.6g}, {:.6g}", v.x, v.y, v.z);
    };
    reading("at", vector(*options.camera_position));
    reading("towards", vector(*options.camera_target));
    button("All in view", CommandKind::frame_scene, 3, commands);
    ImGui::SameLine();
    button("Reset", CommandKind::reset, 3, commands);
    ImGui::SameLine();
    button("Copy", CommandKind::copy_camera, 3, commands);
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
        slider("value", *value, kOverrideRange, "%.3f");
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
    slider("normal strength", options.normal_strength, kNormalStrengthRange, "x %.2f");
    label("alpha masks");
    ImGui::Checkbox("##alpha_mask", &options.alpha_mask);
    label("two-sided");
    ImGui::Checkbox("##two_sided", &options.two_sided);
}

void file_buttons(std::vector<Command>& commands) {
    button("Open...", CommandKind::open, 2, commands);
    ImGui::SameLine();
    button("Save picture", CommandKind::save_picture, 2, commands);
    button("Save settings", CommandKind::save_settings, 2, commands);
    ImGui::SameLine();
    button("Reload shaders", CommandKind::reload_shaders, 2, commands);
    button("All keys", CommandKind::toggle_help, 1, commands);
}

}  // namespace

std::vector<Command> draw_panel(const PanelFacts& facts, PanelState& state) {
    std::vector<Command> commands;
    const bool apart = readings_are_apart(facts.scale);
    if (apart) draw_readings(facts);
    begin_window("cw2", Edge::left, facts.scale);
    if (!apart && facts.pick) pixel_section(facts);
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
    if (!apart) frame_section(facts, false);
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
    if (options.orbit_axis != Axis::z) {
        flags += fmt::format(" --orbit-axis {}", "xyz"[static_cast<int>(options.orbit_axis)]);
    }
    return flags;
}

}  // namespace cw2
