// The scale that tells what false colours mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cw2/render/frame_settings.h"
#include "cw2/render/view.h"

namespace cw2 {

/// A number on the scale.
struct Tick {
    float position;  ///< in [0, 1]
    std::string label;
};

/// The ends of the range first, then between them the powers of ten of a logarithmic range, or the
/// quarters of an even one.
std::vector<Tick> ticks_of(const ValueRange& range);

/// The colour of a position in [0, 1] as 8-bit sRGB.
glm::u8vec3 false_color_bytes(float position);

/// Part of a picture, in pixels from its upper left corner.
struct PixelArea {
    std::uint32_t left;
    std::uint32_t top;
    std::uint32_t width;
    std::uint32_t height;
};

/// Draws the scale onto a picture's pixels, 8-bit RGBA, at the bottom of the columns from `left` to
/// before `right`; where it does not fit, there is none. Gives the area that it covers.
std::optional<PixelArea> draw_legend(std::span<std::byte> pixels, std::uint32_t width,
                                     std::uint32_t height, std::uint32_t left, std::uint32_t right,
                                     const ValueRange& range);

/// Draws the scales of what `settings` show in false colours, one for each side.
std::vector<PixelArea> draw_legends(std::span<std::byte> pixels, std::uint32_t width,
                                    std::uint32_t height, const FrameSettings& settings);

}  // namespace cw2
