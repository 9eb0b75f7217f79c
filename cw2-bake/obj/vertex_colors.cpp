#include "cw2-bake/obj/vertex_colors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace bake {
namespace {

constexpr std::uint32_t kOpaque = 0xFF00'0000;
constexpr std::uint32_t kWhite = 0xFFFF'FFFF;
/// 0.8, the base colour where none is stated, sRGB-encoded.
constexpr std::uint32_t kGrey = kOpaque | 231 << 16 | 231 << 8 | 231;

constexpr glm::vec3 kNoColor{std::numeric_limits<float>::quiet_NaN()};
constexpr float kFullByte = 255.0f;

/// No colour of a picture goes that far beyond 1, and no picture in bytes stays below it.
constexpr float kLeastByte = 10.0f;

}  // namespace

void VertexColors::set(std::size_t position, const glm::vec3& color) {
    if (colors_.size() <= position) colors_.resize(position + 1, kNoColor);
    colors_[position] = color;
}

void VertexColors::paint(std::size_t positions, std::uint32_t color) {
    if (positions != painted_positions_) apply_paint();
    painted_positions_ = positions;
    paint_.push_back(color);
}

void VertexColors::apply_paint() {
    const std::size_t count = std::min(paint_.size(), painted_positions_);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t color = paint_[i];
        set(painted_positions_ - count + i,
            glm::vec3(color >> 16 & 0xFF, color >> 8 & 0xFF, color & 0xFF) / kFullByte);
    }
    paint_.clear();
}

std::vector<std::uint32_t> VertexColors::finish(std::size_t position_count,
                                                std::vector<ObjNote>& notes) && {
    apply_paint();
    std::vector<std::uint32_t> result;
    if (colors_.empty()) return result;
    float largest = 0;
    for (const glm::vec3& color : colors_) {
        for (int i = 0; i < 3; ++i) largest = std::max(largest, color[i]);  // NaN is not larger
    }
    const bool bytes = largest >= kLeastByte;
    if (bytes) {
        const auto note =
            std::ranges::find(notes, std::string_view(kObjColorOutside), &ObjNote::kind);
        note->kind = "vertex colours are taken as 0 to 255, for some are above 1";
    }
    const float scale = bytes ? 1.0f : kFullByte;
    result.resize(position_count, 0);
    for (std::size_t i = 0; i < colors_.size(); ++i) {
        if (std::isnan(colors_[i].x)) continue;
        result[i] = kOpaque;
        for (int channel = 0; channel < 3; ++channel) {
            const float value = std::clamp(colors_[i][channel] * scale, 0.0f, kFullByte);
            result[i] |= static_cast<std::uint32_t>(std::lround(value)) << 8 * channel;
        }
    }
    return result;
}

void color_corners(const std::vector<std::uint32_t>& colors, std::vector<MtlMaterial>& materials,
                   SourceScene& scene) {
    if (colors.empty()) return;
    std::vector<char> gives_way(materials.size(), 0);
    const auto for_each_corner = [&](auto&& visit) {
        std::size_t i = 0;
        for (const RunVector::Run& run : scene.triangle_material.runs())
            for (; i < 3 * run.end; ++i) visit(colors[scene.corners[i].position], run.number);
    };
    for_each_corner([&](std::uint32_t color, std::uint32_t material) {
        gives_way[material] |= !materials[material].states_color && color;
    });
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (gives_way[i]) materials[i].source.base_color = glm::vec3{1.0f};
    }
    scene.colors.reserve(scene.corners.size());
    for_each_corner([&](std::uint32_t color, std::uint32_t material) {
        scene.colors.push_back(color ? color : gives_way[material] ? kGrey : kWhite);
    });
}

}  // namespace bake
