#include "cw2/render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "common/srgb.h"
#include "shaders/false_color.h"

namespace cw2 {

namespace {

/// A glyph of 3 x 5 dots: a number for each row from the top, whose highest bit is left.
struct Glyph {
    char character;
    std::array<std::uint8_t, 5> rows;
};
constexpr Glyph kGlyphs[] = {
    {'0', {7, 5, 5, 5, 7}}, {'1', {2, 6, 2, 2, 7}}, {'2', {7, 1, 7, 4, 7}}, {'3', {7, 1, 3, 1, 7}},
    {'4', {5, 5, 7, 1, 1}}, {'5', {7, 4, 7, 1, 7}}, {'6', {7, 4, 7, 5, 7}}, {'7', {7, 1, 2, 2, 2}},
    {'8', {7, 5, 7, 5, 7}}, {'9', {7, 5, 7, 1, 7}}, {'.', {0, 0, 0, 0, 2}}, {'-', {0, 0, 7, 0, 0}},
    {'+', {0, 2, 7, 2, 0}}, {'e', {0, 7, 7, 4, 7}},
};

// In dots, from the top.
constexpr std::int64_t kMargin = 3, kBar = 7, kMark = 2, kGlyphHeight = 5, kGlyphWidth = 3;
constexpr std::int64_t kHeight = kMargin + kBar + kMark + 1 + kGlyphHeight + kMargin;
constexpr std::int64_t kSide = 12;  ///< beside the bar, for half a label
constexpr std::int64_t kLongest = 200, kShortest = 48;

constexpr glm::u8vec3 kPaper{24}, kInk{255};

/// Three digits, and 1e5 rather than 1e+05.
std::string label_of(double value) {
    std::string label =
        std::abs(value) >= 1000.0 ? fmt::format("{:.2e}", value) : fmt::format("{:.3g}", value);
    const std::size_t exponent = label.find('e');
    if (exponent == std::string::npos) return label;
    std::string digits = label.substr(0, exponent);
    if (digits.find('.') != std::string::npos) {
        digits.erase(digits.find_last_not_of('0') + 1);
        if (digits.ends_with('.')) digits.pop_back();
    }
    const int power = std::stoi(label.substr(exponent + 1));
    return fmt::format("{}e{}", digits, power);
}

std::int64_t label_width(std::string_view label) {
    return static_cast<std::int64_t>(label.size()) * (kGlyphWidth + 1) - 1;
}

/// A picture's dots: squares of `scale` pixels, counted from a corner.
class Canvas {
 public:
    Canvas(std::span<std::byte> pixels, std::int64_t width, std::int64_t left, std::int64_t top,
           std::int64_t scale)
        : pixels_(pixels), width_(width), left_(left), top_(top), scale_(scale) {}

    void fill(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height,
              const glm::u8vec3& color) {
        for (std::int64_t py = y * scale_; py < (y + height) * scale_; ++py) {
            for (std::int64_t px = x * scale_; px < (x + width) * scale_; ++px) {
                set(px, py, color);
            }
        }
    }
    /// Every column of pixels has its own colour.
    void fill_with_scale(std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height) {
        const std::int64_t columns = width * scale_;
        for (std::int64_t column = 0; column < columns; ++column) {
            const glm::u8vec3 color = false_color_bytes((static_cast<float>(column) + 0.5f) /
                                                        static_cast<float>(columns));
            for (std::int64_t py = y * scale_; py < (y + height) * scale_; ++py) {
                set(x * scale_ + column, py, color);
            }
        }
    }
    void write(std::int64_t x, std::int64_t y, std::string_view text) {
        for (const char c : text) {
            const auto* const glyph =
                std::find_if(std::begin(kGlyphs), std::end(kGlyphs),
                             [c](const Glyph& g) { return g.character == c; });
            for (std::int64_t row = 0; glyph != std::end(kGlyphs) && row < kGlyphHeight; ++row) {
                for (std::int64_t column = 0; column < kGlyphWidth; ++column) {
                    const bool is_set = glyph->rows[static_cast<std::size_t>(row)] & 4 >> column;
                    if (is_set) fill(x + column, y + row, 1, 1, kInk);
                }
            }
            x += kGlyphWidth + 1;
        }
    }

 private:
    void set(std::int64_t x, std::int64_t y, const glm::u8vec3& color) {
        const auto at = static_cast<std::size_t>(((top_ + y) * width_ + left_ + x) * 4);
        for (int i = 0; i < 3; ++i) {
            pixels_[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(color[i]);
        }
        pixels_[at + 3] = std::byte{255};
    }

    std::span<std::byte> pixels_;
    std::int64_t width_, left_, top_, scale_;
};

}  // namespace

std::vector<Tick> ticks_of(const ValueRange& range) {
    const auto tick = [&](double value) {
        return Tick{interop::false_color_position(static_cast<float>(value), range.low, range.high),
                    label_of(value)};
    };
    std::vector<Tick> ticks{tick(range.low), tick(range.high)};
    if (range.low <= 0.0f) {
        for (const double quarter : {0.25, 0.5, 0.75}) {
            ticks.push_back(tick(range.low + quarter * (double{range.high} - range.low)));
        }
        return ticks;
    }
    // A power that is an end but for its rounding is no tick of its own.
    const double first = std::floor(std::log10(range.low) + 1e-4) + 1.0;
    const double last = std::ceil(std::log10(range.high) - 1e-4) - 1.0;
    for (double power = first; power <= last; power += 1.0) {
        ticks.push_back(tick(std::pow(10.0, power)));
    }
    return ticks;
}

glm::u8vec3 false_color_bytes(float position) {
    const glm::vec3 linear = interop::false_color(position);
    glm::u8vec3 bytes;
    for (int i = 0; i < 3; ++i) {
        const float x = std::clamp(linear[i], 0.0f, 1.0f);
        bytes[i] = static_cast<std::uint8_t>(std::lround(255.0f * common::srgb_of_linear(x)));
    }
    return bytes;
}

std::optional<PixelArea> draw_legend(std::span<std::byte> pixels, std::uint32_t width,
                                     std::uint32_t height, std::uint32_t left, std::uint32_t right,
                                     const ValueRange& range) {
    const std::int64_t scale = std::max<std::int64_t>(1, height / 180);
    const std::int64_t bar = std::min(kLongest, (right - left) / scale - 2 * kSide);
    const std::int64_t top = std::int64_t{height} - kHeight * scale;
    if (bar < kShortest || top < 0) return std::nullopt;
    Canvas canvas(pixels, width, left, top, scale);
    canvas.fill(0, 0, bar + 2 * kSide, kHeight, kPaper);
    canvas.fill_with_scale(kSide, kMargin, bar, kBar);

    std::vector<std::pair<std::int64_t, std::int64_t>> taken;  // where labels are
    for (const Tick& tick : ticks_of(range)) {
        const auto at = kSide + std::min<std::int64_t>(
                                    std::lround(tick.position * static_cast<float>(bar)), bar - 1);
        canvas.fill(at, kMargin + kBar, 1, kMark, kInk);
        const std::int64_t length = label_width(tick.label);
        const std::int64_t begin =
            std::clamp<std::int64_t>(at - length / 2, 1, bar + 2 * kSide - length - 1);
        const bool fits = std::none_of(taken.begin(), taken.end(), [&](const auto& other) {
            return begin < other.second + kGlyphWidth && other.first < begin + length + kGlyphWidth;
        });
        if (!fits) continue;
        canvas.write(begin, kMargin + kBar + kMark + 1, tick.label);
        taken.emplace_back(begin, begin + length);
    }
    return PixelArea{left, static_cast<std::uint32_t>(top),
                     static_cast<std::uint32_t>((bar + 2 * kSide) * scale),
                     static_cast<std::uint32_t>(kHeight * scale)};
}

std::vector<PixelArea> draw_legends(std::span<std::byte> pixels, std::uint32_t width,
                                    std::uint32_t height, const FrameSettings& settings) {
    std::vector<PixelArea> areas;
    if (!settings.false_color) return areas;
    const std::uint32_t end = settings.split ? settings.split->column(width) : width;
    const auto draw = [&](View view, std::uint32_t left, std::uint32_t right) {
        const auto area =
            draw_legend(pixels, width, height, left, right, settings.false_color->range_of(view));
        if (area) areas.push_back(*area);
    };
    draw(settings.view, 0, end);
    if (settings.split) draw(settings.split->right.view, end, width);
    return areas;
}

}  // namespace cw2
