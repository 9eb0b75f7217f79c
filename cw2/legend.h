// The scale that tells what false colours mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "cw2/view.h"

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

/// Draws the scale onto a picture's pixels, 8-bit RGBA, at the bottom of the columns from `left` to
/// before `right`; where it does not fit, there is none.
void draw_legend(std::span<std::byte> pixels, std::uint32_t width, std::uint32_t height,
                 std::uint32_t left, std::uint32_t right, const ValueRange& range);

}  // namespace cw2
