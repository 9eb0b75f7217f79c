// Turntables: several pictures in one run, in which the camera or the light goes once around.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cw2/render/frame_settings.h"

namespace cw2 {

/// What goes around from frame to frame.
enum class Orbit { camera, light };

/// Frames `first` to `last`, both included, of a turn of `count` frames numbered from 0.
struct FrameRange {
    std::uint32_t first;
    std::uint32_t last;
    std::uint32_t count;
    bool operator==(const FrameRange&) const = default;

    std::uint32_t size() const { return last - first + 1; }
};

/// Reads "N" (all frames of a turn of N) or "A..B/N". Nothing where that makes no sense, or is
/// more than a million frames.
std::optional<FrameRange> frame_range_of(std::string_view text);

/// The file of a frame: its number in place of the pattern's only %d, or, with leading zeros, %04d;
/// %% stands for %. Nothing where the pattern is none.
std::optional<std::string> frame_name(std::string_view pattern, std::uint32_t frame);

/// A frame of a turn that starts with `start`; it depends on no other frame. The camera goes
/// around the vertical through its target, the light on its orbit (see orbit()).
FrameSettings at_frame(FrameSettings start, Orbit orbit, std::uint32_t frame, std::uint32_t count,
                       const Bounds& bounds, Axis light_axis = Axis::z);

}  // namespace cw2
