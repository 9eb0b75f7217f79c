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

void frame_section(const PanelFacts& facts) {
    if (!section("Frame")) return;
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

void pick_section(const PanelFacts& facts) {
    if (!section("Pixel")) return;
    if (!facts.pick) {
        dim_text("click the picture to read the numbers of a pixel");
        return;
    }
    const Pick& pick = *facts.pick;
    const auto number = [](float value) { return fmt::format("{:.4g}", value); };
    const auto vector = [](const glm::vec3& v) {
        return fmt::format("{:<8.3g} {:<8.3g} {:.3g}", v.x, v.y, v.z);
    };
    const auto direction = [](const glm::vec3& v) {
        return fmt::format("{:<8.4f} {:<8.4f} {:.4f}", v.x, v.y, v.z);
    };
    reading("pixel", fmt::format("{}, {}", pick.pixel.x, pick.pixel.y));
    reading("material", facts.picked_material);
    reading("position", vector(pick.position));
    reading("normal n", direction(pick.normal));
    reading("base colour", vector(pick.base_color));
    reading("vertex colour", vector(pick.vertex_color));
    reading("emission", vector(pick.emission));
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
    reading("F", vector(pick.fresnel));
    reading("diffuse", vector(pick.diffuse));
    reading("specular", vector(pick.specular));
    reading("shaded", vector(pick.shaded));
    // A cross-hair in the picture, black and white, so that it is seen on anything.
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    const ImVec2 at{(static_cast<float>(pick.pixel.x) + 0.5f) / scale.x,
                    (static_cast<float>(pick.pixel.y) + 0.5f) / scale.y};
    for (const auto& [thickness, ink] : {std::pair{3.0f, IM_COL32_BLACK}, {1.0f, IM_COL32_WHITE}}) {
        const float width = thickness * facts.scale;
        for (const float side : {-1.0f, 1.0f}) {
            const float near = 4.0f * side * facts.scale, far = 10.0f * side * facts.scale;
            ImDrawList* const list = ImGui::GetBackgroundDrawList();
            list->AddLine({at.x + near, at.y}, {at.x + far, at.y}, ink, width);
            list->AddLine({at.x, at.y + near}, {at.x, at.y + far}, ink, width);
        }
    }
}

}  // namespace

void draw_readings(const PanelFacts& facts) {
    const float width = 304.0f * facts.scale;
    const float margin = 8.0f * facts.scale;
    begin_window("Readings", ImGui::GetIO().DisplaySize.x - width - margin, width, facts.scale);
    frame_section(facts);
    pick_section(facts);
    ImGui::End();
}

}  // namespace cw2
