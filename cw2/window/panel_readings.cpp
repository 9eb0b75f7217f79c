#include <fmt/format.h>
#include <imgui.h>

#include <glm/vec3.hpp>
#include <string>
#include <utility>

#include "cw2/window/panel.h"
#include "cw2/window/panel_widgets.h"

namespace cw2 {

namespace {

/// Thousands apart.
std::string count(std::uint64_t number) {
    const std::string digits = std::to_string(number);
    std::string result;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) result += ' ';
        result += digits[i];
    }
    return result;
}

std::string milliseconds(const std::optional<double>& time) {
    return time ? fmt::format("{:.2f} ms", *time) : std::string("-");
}

}  // namespace

void frame_section(const PanelFacts& facts, bool open) {
    if (!section("Frame", open)) return;
    dim_text(facts.device);
    reading("size", fmt::format("{} x {}", facts.extent.width, facts.extent.height));
    reading("CPU", milliseconds(facts.times.cpu));
    reading("GPU", milliseconds(facts.times.gpu));
    reading("triangles",
            fmt::format("{} of {}", count(facts.counts.triangles), count(facts.triangles)));
    reading("draws", count(facts.counts.draws));
    const auto mebibytes = [](std::uint64_t bytes) {
        return static_cast<double>(bytes) / (1024.0 * 1024.0);
    };
    reading("memory", fmt::format("{:.1f} MiB scene", mebibytes(facts.scene_bytes)));
    reading("", fmt::format("{:.1f} MiB images", mebibytes(facts.image_bytes)));
}

namespace {

/// A cross-hair in the picture, black and white, so that it is seen on anything.
void mark(const glm::uvec2& pixel, float size) {
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    const ImVec2 at{(static_cast<float>(pixel.x) + 0.5f) / scale.x,
                    (static_cast<float>(pixel.y) + 0.5f) / scale.y};
    for (const auto& [thickness, ink] : {std::pair{3.0f, IM_COL32_BLACK}, {1.0f, IM_COL32_WHITE}}) {
        const float width = thickness * size;
        for (const float side : {-1.0f, 1.0f}) {
            const float near = 4.0f * side * size, far = 10.0f * side * size;
            ImDrawList* const list = ImGui::GetBackgroundDrawList();
            list->AddLine({at.x + near, at.y}, {at.x + far, at.y}, ink, width);
            list->AddLine({at.x, at.y + near}, {at.x, at.y + far}, ink, width);
        }
    }
}

}  // namespace

void pixel_section(const PanelFacts& facts) {
    if (facts.pick) mark(facts.pick->pixel, facts.scale);
    if (!section("Pixel")) return;
    if (!facts.pick) {
        dim_text("click the picture to read the numbers of a pixel");
        return;
    }
    const Pick& pick = *facts.pick;
    const auto number = [](float value) { return fmt::format("{:.4g}", value); };
    const auto color = [](const char* name, const glm::vec3& v) {
        readings(name, {fmt::format("{:.3g}", v.x), fmt::format("{:.3g}", v.y),
                        fmt::format("{:.3g}", v.z)});
    };
    reading("pixel", fmt::format("{}, {}", pick.pixel.x, pick.pixel.y));
    reading("material", facts.picked_material);
    reading("position", fmt::format("{:.7g}, {:.7g}, {:.7g}", pick.position.x, pick.position.y,
                                    pick.position.z));
    readings("normal n",
             {fmt::format("{:.4f}", pick.normal.x), fmt::format("{:.4f}", pick.normal.y),
              fmt::format("{:.4f}", pick.normal.z)});
    color("base colour", pick.base_color);
    color("vertex colour", pick.vertex_color);
    color("emission", pick.emission);
    if (pick.unlit) reading("", "unlit");
    reading("roughness", number(pick.roughness));
    reading("metalness", number(pick.metalness));
    ImGui::Separator();
    reading("n.l", number(pick.n_dot_l()));
    reading("n.v", number(pick.n_dot_v()));
    reading("n.h", number(pick.n_dot_h()));
    reading("v.h", number(pick.v_dot_h()));
    ImGui::Separator();
    reading("D", number(pick.distribution));
    reading("G", number(pick.masking));
    color("F", pick.fresnel);
    color("diffuse", pick.diffuse);
    color("specular", pick.specular);
    color("shaded", pick.shaded);
}

void draw_readings(const PanelFacts& facts) {
    begin_window("Readings", Edge::right, facts.scale);
    frame_section(facts, true);
    pixel_section(facts);
    ImGui::End();
}

}  // namespace cw2
