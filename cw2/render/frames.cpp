#include "cw2/render/frames.h"

#include <fmt/format.h>

#include <charconv>
#include <numbers>

namespace cw2 {

namespace {

constexpr std::uint32_t kMostFrames = 1'000'000;

/// Takes a number off the front of `text`.
bool take_number(std::string_view& text, std::uint32_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{}) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

bool take(std::string_view& text, std::string_view what) {
    if (!text.starts_with(what)) return false;
    text.remove_prefix(what.size());
    return true;
}

}  // namespace

std::optional<FrameRange> frame_range_of(std::string_view text) {
    FrameRange range{};
    if (!take_number(text, range.first)) return std::nullopt;
    if (text.empty()) {
        range = {0, range.first - 1, range.first};
    } else if (!take(text, "..") || !take_number(text, range.last) || !take(text, "/") ||
               !take_number(text, range.count)) {
        return std::nullopt;
    }
    const bool is_sound = text.empty() && range.count >= 1 && range.count <= kMostFrames &&
                          range.first <= range.last && range.last < range.count;
    return is_sound ? std::optional(range) : std::nullopt;
}

std::optional<std::string> frame_name(std::string_view pattern, std::uint32_t frame) {
    std::string name;
    int numbers = 0;
    while (!pattern.empty()) {
        if (take(pattern, "%%")) {
            name += '%';
        } else if (take(pattern, "%")) {
            std::uint32_t width = 0;
            if (take(pattern, "0") && (!take_number(pattern, width) || width > 20)) {
                return std::nullopt;
            }
            if (!take(pattern, "d") || ++numbers > 1) return std::nullopt;
            name += fmt::format("{:0{}}", frame, width);
        } else {
            name += pattern.front();
            pattern.remove_prefix(1);
        }
    }
    return numbers == 1 ? std::optional(name) : std::nullopt;
}

FrameSettings at_frame(FrameSettings start, Orbit what, std::uint32_t frame, std::uint32_t count,
                       const Bounds& bounds, Axis light_axis) {
    const double angle = 2.0 * std::numbers::pi * frame / count;
    if (what == Orbit::light) {
        start.light.position = orbit(start.light.position, bounds.center, angle, light_axis);
    } else {
        start.camera = around_target(start.camera, angle);
    }
    return start;
}

}  // namespace cw2
