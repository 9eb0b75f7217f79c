#include "cw2/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <iostream>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "cw2/config.h"
#include "mesh-format/io.h"

namespace cw2 {

namespace {

/// One option: on the command line and, by the same name, in a config file.
struct Setting {
    std::string name;         ///< without dashes
    std::string form;         ///< of its value; empty: a flag, whose value is true or false
    std::string description;  ///< for --help
    /// Takes over a value. Returns what is wrong with it, or nothing.
    std::function<std::string(Options&, const std::string&)> read;
    /// The value in TOML; empty where nothing has set it.
    std::function<std::string(const Options&)> write;

    /// As CLI11 is told: SCENE has no dashes.
    std::string command_line_name() const {
        return name == "scene" ? "SCENE" : name == "output" ? "-o,--output" : "--" + name;
    }
};

/// Reads the whole of `text` as a number; floats are finite.
template <typename T>
requires std::is_arithmetic_v<T>
bool read_value(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() &&
           std::isfinite(static_cast<double>(value));
}

bool read_value(std::string_view text, glm::vec3& vector) {
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

template <typename T>
bool read_value(std::string_view text, std::optional<T>& value) {
    return read_value(text, value.emplace());
}

// Numbers are written with as many digits as it takes to read the same number again.
template <typename T>
requires std::is_arithmetic_v<T> std::string toml_of(T value) {
    return fmt::format("{}", value);
}
std::string toml_of(const glm::vec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}
std::string toml_of(const std::string& text) {
    return toml_string(text);
}
std::string toml_of(const std::filesystem::path& path) {
    return path.empty() ? std::string() : toml_string(path.string());
}
std::string toml_of(const PictureSize& size) {
    return fmt::format("\"{}x{}\"", size.width, size.height);
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
            [](const Options& options) { return toml_string(kViewNames[options.view]); }};
}

template <typename T>
std::function<bool(const std::optional<T>&)> between(T low, T high) {
    return [=](const std::optional<T>& value) { return *value >= low && *value <= high; };
}

/// All of them, in the order of --help.
std::vector<Setting> all_settings() {
    using O = Options;
    return {
        value("scene", "SCENE.cw2mesh", "file baked by cw2-bake", &O::scene),
        value("output", "FILE.png|FILE.exr", "write one picture and end", &O::output),
        value("size", "WIDTHxHEIGHT", "pixels [1280x720]", &O::size),
        view_setting(),
        value("camera-position", "X,Y,Z",
              "where the camera is [the file's, else the whole scene in view]",
              &O::camera_position),
        value("camera-target", "X,Y,Z", "where it looks [the file's, else the scene's centre]",
              &O::camera_target),
        value("fov", "DEGREES", "vertical field of view, 1 to 179 [the file's, else 60]",
              &O::vertical_fov, between(1.0f, 179.0f)),
        value("light-position", "X,Y,Z",
              "where the light's orbit starts [the file's, else above the scene]",
              &O::light_position),
        value("light-color", "R,G,B", "linear [the file's, else 1,1,1]", &O::light_color),
        value("ambient", "R,G,B", "ambient light, linear [0.02,0.02,0.02]", &O::ambient),
        value("background", "R,G,B", "linear [0.1,0.1,0.1]", &O::background),
        value("time", "SECONDS", "instant of the light's orbit, 1 rad/s about z [0]", &O::time),
        value("roughness", "0..1", "roughness of every material [its own]", &O::roughness,
              between(0.0f, 1.0f)),
        value("metalness", "0..1", "metalness of every material [its own]", &O::metalness,
              between(0.0f, 1.0f)),
        value<float>("normal-strength", "0..10", "factor on the slopes of all normal maps [1]",
                     &O::normal_strength,
                     [](const float& factor) { return factor >= 0.0f && factor <= 10.0f; }),
        flag("no-normal-map", "shade with the vertex normals", &O::normal_map, false),
        flag("no-alpha-mask", "draw what alpha masks cut away", &O::alpha_mask, false),
        value<std::optional<std::uint32_t>>(
            "samples", "1|4", "samples a pixel [4; 1 in a window on a CPU device]", &O::samples,
            [](const std::optional<std::uint32_t>& n) { return *n == 1 || *n == 4; }),
        value("anisotropy", "1..16",
              "largest anisotropy of texture filtering [16 on GPUs, 1 on CPUs]", &O::anisotropy,
              between<std::uint32_t>(1, 16)),
        value("device", "INDEX|NAME", "index or part of the name [the fastest kind]", &O::device),
        flag("list-devices", "print the Vulkan devices and end", &O::list_devices),
        flag("list-views", "print the views and end", &O::list_views),
        flag("validation", "run Vulkan's validation layers; any message is a failure",
             &O::validation),
        value("stats", "FILE.json", "write timings and counts as JSON (with --output)", &O::stats),
        value<std::uint32_t>(
            "bench", "FRAMES", "draw N more frames and print their times (with --output)",
            &O::bench_frames, [](const std::uint32_t& n) { return n <= 1'000'000; }),
    };
}

/// What a setting of the name, command line or config file, has told.
void take(const Setting& setting, const std::string& text, const std::string& origin,
          Options& options) {
    const std::string problem = setting.read(options, text);
    if (!problem.empty()) throw UsageError(fmt::format("{}: {}", origin, problem));
}

/// `setting` and `options` must outlive the parsing.
void add_to(CLI::App& app, const Setting& setting, Options& options) {
    const auto take_over = [&options, &setting](const std::string& text) {
        take(setting, text, "--" + setting.name, options);
    };
    const std::string name = setting.command_line_name();
    if (setting.form.empty()) {
        app.add_flag_callback(
            name, [take_over] { take_over("true"); }, setting.description);
    } else {
        app.add_option_function<std::string>(name, take_over, setting.description)
            ->type_name(setting.form);
    }
}

/// Takes over the file's settings that the command line does not have; it looks at all of them.
void apply_config(const std::filesystem::path& path, const std::vector<Setting>& settings,
                  const CLI::App& app, Options& options) {
    for (const ConfigEntry& entry : read_config(path)) {
        const auto setting =
            std::find_if(settings.begin(), settings.end(),
                         [&](const Setting& candidate) { return candidate.name == entry.key; });
        const std::string origin = fmt::format("{}:{}", path.string(), entry.line);
        if (setting == settings.end()) {
            throw UsageError(fmt::format("{}: no option is named '{}'", origin, entry.key));
        }
        const std::string name = setting->name == "scene" ? "SCENE" : "--" + setting->name;
        Options ignored = options;
        take(*setting, entry.value, origin + ": " + entry.key,
             app.get_option(name)->count() > 0 ? ignored : options);
    }
}

}  // namespace

std::optional<Options> parse_options(int argc, const char* const* argv) {
    const std::vector<Setting> settings = all_settings();
    Options options;
    CLI::App app(
        "Draws a .cw2mesh file: in a window, or with --output into a picture with no display.",
        "cw2");
    app.set_version_flag("--version", "cw2 " CW2_VERSION);
    for (const Setting& setting : settings) add_to(app, setting, options);
    std::optional<std::filesystem::path> config;
    app.add_option("--config", config,
                   "read options from a file of `name = value` lines; the command line wins")
        ->type_name("FILE.toml");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        app.exit(success, std::cout, std::cerr);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    if (config) apply_config(*config, settings, app, options);
    if (options.scene.empty() && !options.list_devices && !options.list_views) {
        throw UsageError("no scene is given; see --help");
    }
    if (!options.output && (options.stats || options.bench_frames > 0)) {
        throw UsageError("--stats and --bench need --output");
    }
    return options;
}

void write_config(const std::filesystem::path& path, const Options& options) {
    std::string text = "# Options for cw2 --config.\n";
    for (const Setting& setting : all_settings()) {
        const std::string value = setting.write(options);
        if (!value.empty()) text += setting.name + " = " + value + '\n';
    }
    mesh_format::OutputFile file(path);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
}

Options completed(Options options, const SceneStart& start) {
    constexpr float kDegreesPerRadian = 180.0f / 3.14159265f;
    if (start.camera && !options.camera_position && !options.camera_target) {
        options.camera_position = start.camera->position;
        options.camera_target = start.camera->target;
        if (!options.vertical_fov) {
            options.vertical_fov = start.camera->vertical_fov * kDegreesPerRadian;
        }
    }
    if (!options.light_position) options.light_position = start.light_position;
    if (!options.light_color) options.light_color = start.light_color;
    return options;
}

FrameSettings frame_settings(const Options& options, const Bounds& bounds, float aspect) {
    constexpr float kRadiansPerDegree = 3.14159265f / 180.0f;
    FrameSettings settings;
    settings.view = options.view;
    settings.normal_map = options.normal_map;
    settings.alpha_mask = options.alpha_mask;
    const float fov = options.vertical_fov.value_or(60.0f) * kRadiansPerDegree;
    settings.camera = default_camera(bounds, fov, aspect);
    settings.camera.position = options.camera_position.value_or(settings.camera.position);
    settings.camera.target = options.camera_target.value_or(settings.camera.target);
    if (settings.camera.position == settings.camera.target) {
        throw UsageError("the camera's position and target are the same point");
    }
    settings.light = {options.light_position.value_or(default_light_position(bounds)),
                      options.light_color.value_or(glm::vec3(1.0f)), options.ambient};
    settings.materials = {options.roughness, options.metalness, options.normal_strength};
    settings.background = options.background;
    return settings;
}

void require_size(const Options& options, const Device& device) {
    const std::uint32_t largest = device.properties().limits.maxImageDimension2D;
    if (options.size.width > largest || options.size.height > largest) {
        throw VulkanError(fmt::format("--size: device '{}' renders at most {} pixels a side",
                                      device.properties().deviceName, largest));
    }
}

namespace {

/// Whether a CPU device draws so much that blocks are better decoded first. Measured on lavapipe,
/// Sponza, launch to one picture, 4 samples a pixel, seconds of processor time: at 1280 x 720 3.0
/// from blocks and 2.5 decoded, at 320 x 180 0.8 and 1.0; in between lies the limit.
bool repays_decoding(const Options& options) {
    constexpr std::uint64_t kSamples = 1'200'000;
    const bool many = !options.output || options.bench_frames > 0;
    return many ||
           std::uint64_t{options.size.width} * options.size.height * options.samples.value_or(4) >=
               kSamples;
}

}  // namespace

TextureSettings texture_settings(const Options& options, const Device& device) {
    // Measured on lavapipe: any anisotropy makes a frame three times as long.
    const auto wanted = static_cast<float>(options.anisotropy.value_or(device.is_cpu() ? 1u : 16u));
    return {
        .anisotropy = std::min(wanted, device.properties().limits.maxSamplerAnisotropy),
        .decode_blocks = !device.samples_blocks() || (device.is_cpu() && repays_decoding(options))};
}

}  // namespace cw2
