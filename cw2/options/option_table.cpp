#include "cw2/options/option_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "common/quoted_text.h"

namespace cw2 {

namespace {

/// Reads the whole of `text` as a number; floats are finite.
template <typename T>
requires std::is_arithmetic_v<T>
bool read_value(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() &&
           std::isfinite(static_cast<double>(value));
}

template <typename T>
bool read_value(std::string_view text, glm::vec<3, T>& vector) {
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = std::min(text.find(','), text.size());
        if ((comma == text.size()) != (i == 2) || !read_value(text.substr(0, comma), vector[i])) {
            return false;
        }
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return true;
}

bool read_value(std::string_view text, std::string& value) {
    value = text;
    return true;
}

bool read_value(std::string_view text, std::filesystem::path& value) {
    value = text;
    return true;
}

bool read_value(std::string_view text, PictureSize& size) {
    const std::size_t cross = text.find('x');
    return cross != std::string_view::npos && read_value(text.substr(0, cross), size.width) &&
           read_value(text.substr(cross + 1), size.height) && size.width > 0 && size.height > 0;
}

bool read_value(std::string_view text, FalseColor& value) {
    if (text == "auto") return true;
    const std::size_t comma = text.find(',');
    ValueRange& range = value.range.emplace();
    if (comma == std::string_view::npos || !read_value(text.substr(0, comma), range.low) ||
        !read_value(text.substr(comma + 1), range.high) || range.low >= range.high) {
        return false;
    }
    // What positions are computed with, see false_color.h.
    return std::isfinite(range.low > 0.0f ? range.high / range.low : range.high - range.low);
}

constexpr std::string_view kNoNormalMap = ":no-normal-map";
constexpr std::string_view kNoAlphaMask = ":no-alpha-mask";

bool read_value(std::string_view text, Side& side) {
    const std::size_t end = std::min(text.find(':'), text.size());
    const std::optional<View> view = view_named(text.substr(0, end));
    side.view = view.value_or(side.view);
    for (text.remove_prefix(end); !text.empty();) {
        if (text.starts_with(kNoNormalMap)) {
            side.normal_map = false;
            text.remove_prefix(kNoNormalMap.size());
        } else if (text.starts_with(kNoAlphaMask)) {
            side.alpha_mask = false;
            text.remove_prefix(kNoAlphaMask.size());
        } else {
            return false;
        }
    }
    return view.has_value();
}

bool read_value(std::string_view text, std::array<Side, 2>& sides) {
    const std::size_t comma = text.find(',');
    return comma != std::string_view::npos && read_value(text.substr(0, comma), sides[0]) &&
           read_value(text.substr(comma + 1), sides[1]);
}

bool read_value(std::string_view text, FrameRange& range) {
    const std::optional<FrameRange> read = frame_range_of(text);
    range = read.value_or(range);
    return read.has_value();
}

bool read_value(std::string_view text, PixelPlace& pixel) {
    const std::size_t comma = text.find(',');
    return comma != std::string_view::npos && read_value(text.substr(0, comma), pixel.x) &&
           read_value(text.substr(comma + 1), pixel.y);
}

bool read_value(std::string_view text, Encoding& encoding) {
    encoding = text == "linear" ? Encoding::linear : Encoding::srgb;
    return text == "linear" || text == "srgb";
}

bool read_value(std::string_view text, Axis& axis) {
    const std::size_t index = std::string_view("xyz").find(text);
    axis = static_cast<Axis>(index % 3);
    return text.size() == 1 && index != std::string_view::npos;
}

bool read_value(std::string_view text, Orbit& orbit) {
    orbit = text == "light" ? Orbit::light : Orbit::camera;
    return text == "light" || text == "camera";
}

template <typename T>
bool read_value(std::string_view text, std::optional<T>& value) {
    return read_value(text, value.emplace());
}

// Numbers are written with as many digits as it takes to read the same number again.
template <typename T>
requires std::is_arithmetic_v<T> std::string toml_of(T value) {
    std::string text = fmt::format("{}", value);
    // With a point, since the integer -0 is 0; fmt's own ways to ask for one differ by version.
    if (std::is_floating_point_v<T> && text.find_first_of(".e") == text.npos) text += ".0";
    return text;
}
template <typename T>
std::string toml_of(const glm::vec<3, T>& v) {
    return fmt::format("[{}, {}, {}]", toml_of(v.x), toml_of(v.y), toml_of(v.z));
}
std::string toml_of(const std::string& text) {
    return common::quoted_text(text);
}
std::string toml_of(const std::filesystem::path& path) {
    return path.empty() ? std::string() : common::quoted_text(path.string());
}
std::string toml_of(const PictureSize& size) {
    return fmt::format("\"{}x{}\"", size.width, size.height);
}
std::string toml_of(const FalseColor& value) {
    if (!value.range) return "\"auto\"";
    return fmt::format("[{}, {}]", toml_of(value.range->low), toml_of(value.range->high));
}
std::string toml_of(const Side& side) {
    return fmt::format("\"{}{}{}\"", kViews[side.view].name, side.normal_map ? "" : kNoNormalMap,
                       side.alpha_mask ? "" : kNoAlphaMask);
}
std::string toml_of(const std::array<Side, 2>& sides) {
    return fmt::format("[{}, {}]", toml_of(sides[0]), toml_of(sides[1]));
}
std::string toml_of(const FrameRange& range) {
    return fmt::format("\"{}..{}/{}\"", range.first, range.last, range.count);
}
std::string toml_of(const PixelPlace& pixel) {
    return fmt::format("[{}, {}]", pixel.x, pixel.y);
}
std::string toml_of(Encoding encoding) {
    return encoding == Encoding::linear ? "\"linear\"" : "\"srgb\"";
}
std::string toml_of(Axis axis) {
    return fmt::format("\"{}\"", "xyz"[static_cast<int>(axis)]);
}
std::string toml_of(Orbit orbit) {
    return orbit == Orbit::light ? "\"light\"" : "\"camera\"";
}
template <typename T>
std::string toml_of(const std::optional<T>& value) {
    return value ? toml_of(*value) : std::string();
}

/// A setting of the `member`, whose values in range are those that are `valid`.
template <typename T>
Setting value(const std::string& name, const std::string& form, const std::string& description,
              T Options::*member, const std::function<bool(const T&)>& valid = {}) {
    return {name, form, description,
            [=](Options& options, const std::string& text) {
                T read{};
                if (!read_value(text, read) || (valid && !valid(read))) {
                    return fmt::format("'{}' is not {}", text, form);
                }
                options.*member = std::move(read);
                return std::string();
            },
            [=](const Options& options) { return toml_of(options.*member); }};
}

/// A setting that makes the `member` what `meaning` says.
Setting flag(const std::string& name, const std::string& description, bool Options::*member,
             bool meaning = true) {
    return {name, "", description,
            [=](Options& options, const std::string& text) {
                if (text != "true" && text != "false") {
                    return fmt::format("'{}' is neither true nor false", text);
                }
                options.*member = (text == "true") == meaning;
                return std::string();
            },
            [=](const Options& options) {
                return options.*member == meaning ? std::string("true") : std::string();
            }};
}

Setting up_setting() {
    return {"up", "y|z", "up axis of a scene that is not baked yet [y]",
            [](Options& options, const std::string& text) {
                options.z_up = text == "z";
                return text == "y" || text == "z" ? std::string()
                                                  : fmt::format("'{}' is neither y nor z", text);
            },
            [](const Options& options) { return options.z_up ? "\"z\"" : std::string(); }};
}

Setting view_setting() {
    return {"view", "NAME", "what to show; --list-views names all [shaded]",
            [](Options& options, const std::string& text) {
                const std::optional<View> view = view_named(text);
                if (!view) {
                    return fmt::format("no view is named '{}'; --list-views names all", text);
                }
                options.view = *view;
                return std::string();
            },
            [](const Options& options) { return common::quoted_text(kViews[options.view].name); }};
}

Setting background_setting() {
    return {"background", "R,G,B|none",
            "linear; none: transparent, alpha is the coverage [0.1,0.1,0.1]",
            [](Options& options, const std::string& text) {
                glm::vec3 color;
                if (text != "none" && !read_value(text, color)) {
                    return fmt::format("'{}' is neither R,G,B nor none", text);
                }
                options.background = text == "none" ? std::nullopt : std::optional(color);
                return std::string();
            },
            [](const Options& options) {
                return options.background ? toml_of(*options.background) : "\"none\"";
            }};
}

template <typename T>
std::function<bool(const T&)> in(const Range<T>& range) {
    return [=](const T& value) { return range.has(value); };
}

template <typename T>
std::function<bool(const std::optional<T>&)> in_optional(const Range<T>& range) {
    return [=](const std::optional<T>& value) { return range.has(*value); };
}

template <typename T>
std::string form_of(const Range<T>& range) {
    return fmt::format("{}..{}", range.low, range.high);
}

}  // namespace

std::vector<Setting> all_settings() {
    using O = Options;
    return {
        value("scene", "SCENE",
              "a .cw2mesh file; .obj, .gltf and .glb are baked first; the window goes through "
              "several",
              &O::scene),
        up_setting(),
        flag("strict", "a warning of the bake is an error", &O::strict),
        flag("restrict", "the bake reads nothing outside the scene's folder", &O::restricted),
        value("output", "FILE.png|FILE.exr", "write a picture and end", &O::output),
        value("size", "WIDTHxHEIGHT", "pixels [1280x720]", &O::size),
        view_setting(),
        value("split", "LEFT,RIGHT",
              "two views side by side; VIEW:no-normal-map and VIEW:no-alpha-mask are sides, too",
              &O::split),
        value("divider", form_of(kDividerRange),
              "where the right side begins, in parts of the width [0.5]", &O::divider,
              in(kDividerRange)),
        value("exposure", "STOPS",
              "multiplies what a PNG or the window shows by 2^STOPS, -64 to 64 [1.65 for shaded, "
              "which makes white paper white; else 0]",
              &O::exposure, in_optional(kExposureRange)),
        value("false-color", "auto|LOW,HIGH",
              "shows luminance as colours, by its logarithm if LOW > 0; auto: the view's range",
              &O::false_color),
        value("camera-position", "X,Y,Z",
              "where the camera is [the file's, else the whole scene in view]",
              &O::camera_position),
        value("camera-target", "X,Y,Z", "where it looks [the file's, else the scene's centre]",
              &O::camera_target),
        value("fov", "DEGREES",
              fmt::format("vertical field of view, {} to {} [the file's, else 60]", kFovRange.low,
                          kFovRange.high),
              &O::vertical_fov, in_optional(kFovRange)),
        value("light-position", "X,Y,Z",
              "where the light's orbit starts [the file's, else over the camera's left shoulder]",
              &O::light_position),
        value("light-color", "R,G,B", "linear [the file's, else 1,1,1]", &O::light_color),
        value("ambient", "R,G,B", "ambient light, linear [0.02,0.02,0.02]", &O::ambient),
        background_setting(),
        value("encoding", "srgb|linear",
              "of a PNG's values; linear: a value of 128 / 255 is the byte 128 [srgb]",
              &O::encoding),
        value("time", "SECONDS", "instant of the light's orbit, 1 rad/s [0]", &O::time),
        value("orbit-axis", "x|y|z", "axis that the light's orbit is about [z]", &O::orbit_axis),
        value("roughness", form_of(kOverrideRange), "roughness of every material [its own]",
              &O::roughness, in_optional(kOverrideRange)),
        value("metalness", form_of(kOverrideRange), "metalness of every material [its own]",
              &O::metalness, in_optional(kOverrideRange)),
        value("normal-strength", form_of(kNormalStrengthRange),
              "factor on the slopes of all normal maps [1]", &O::normal_strength,
              in(kNormalStrengthRange)),
        flag("no-normal-map", "shade with the vertex normals", &O::normal_map, false),
        flag("no-alpha-mask", "draw what alpha masks cut away", &O::alpha_mask, false),
        flag("two-sided",
             "turn the normals of back faces to the camera (without it an OBJ's stay as they are)",
             &O::two_sided),
        value<std::optional<std::uint32_t>>(
            "samples", "1|4|16|64|256", "frames that a picture is the average of [4]", &O::samples,
            [](const std::optional<std::uint32_t>& n) {
                return *n <= 256 && std::has_single_bit(*n) && std::countr_zero(*n) % 2 == 0;
            }),
        value("anisotropy", form_of(kAnisotropyRange),
              "largest anisotropy of texture filtering [16 on GPUs, 1 on CPUs]", &O::anisotropy,
              in_optional(kAnisotropyRange)),
        value("device", "INDEX|NAME", "index or part of the name [the fastest kind]", &O::device),
        flag("list-devices", "print the Vulkan devices and end", &O::list_devices),
        flag("list-views", "print the views and end", &O::list_views),
        flag("validation", "run Vulkan's validation layers; any message is a failure",
             &O::validation),
        value("frames", "N|A..B/N",
              "N pictures of one turn, or those from A to B of 0 to N - 1; %04d in --output is the "
              "frame's number",
              &O::frames),
        value("orbit", "camera|light",
              "what goes around in --frames [camera] and in --bench [nothing]", &O::orbit),
        value("pixel", "X,Y",
              "print what shades that pixel as JSON, with no window [0,0 is the upper left]",
              &O::pixel),
        value("stats", "FILE.json", "write timings and counts as JSON", &O::stats),
        value("bench", form_of(kBenchRange),
              "draw so many pictures, with no window, and print what they take", &O::bench_pictures,
              in_optional(kBenchRange)),
    };
}

}  // namespace cw2
