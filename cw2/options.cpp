#include "cw2/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <string_view>

namespace cw2 {

namespace {

/// Reads the whole of `text` as a finite number.
bool parse_number(std::string_view text, double& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

bool parse_vector(std::string_view text, glm::vec3& vector) {
    for (int i = 0; i < 3; ++i) {
        const std::size_t comma = std::min(text.find(','), text.size());
        double value = 0.0;
        if ((comma == text.size()) != (i == 2) || !parse_number(text.substr(0, comma), value)) {
            return false;
        }
        vector[i] = static_cast<float>(value);
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return true;
}

bool parse_size(std::string_view text, Options& options) {
    const std::size_t cross = std::min(text.find('x'), text.size());
    const auto parse = [](std::string_view digits, std::uint32_t& extent) {
        const char* const end = digits.data() + digits.size();
        const auto [stop, error] = std::from_chars(digits.data(), end, extent);
        return error == std::errc{} && stop == end && extent > 0;
    };
    return cross < text.size() && parse(text.substr(0, cross), options.width) &&
           parse(text.substr(cross + 1), options.height);
}

/// Adds an option whose text `parse` turns into a value; `form` says what is expected.
template <typename Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, const std::string& form,
                        const std::string& description, Parse parse) {
    return app
        .add_option_function<std::string>(
            name,
            [=](const std::string& text) {
                if (!parse(text)) {
                    throw CLI::ValidationError(fmt::format("{}: '{}' is not {}", name, text, form));
                }
            },
            description)
        ->type_name(form);
}

void add_vector(CLI::App& app, const std::string& name, std::optional<glm::vec3>& target,
                const std::string& description) {
    add_parsed(app, name, "X,Y,Z", description,
               [&target](const std::string& text) { return parse_vector(text, target.emplace()); });
}

void add_vector(CLI::App& app, const std::string& name, glm::vec3& target,
                const std::string& description) {
    add_parsed(app, name, "R,G,B", description,
               [&target](const std::string& text) { return parse_vector(text, target); });
}

void add_view_options(CLI::App& app, Options& options) {
    add_parsed(app, "--view", "NAME", "what to show; --list-views names all [shaded]",
               [&options](const std::string& text) {
                   const std::optional<View> view = view_named(text);
                   if (!view) {
                       throw CLI::ValidationError(fmt::format(
                           "--view: no view is named '{}'; --list-views names all", text));
                   }
                   options.view = *view;
                   return true;
               });
    add_vector(app, "--camera-position", options.camera_position,
               "where the camera is [the whole scene in view]");
    add_vector(app, "--camera-target", options.camera_target,
               "where it looks [the scene's centre]");
    add_parsed(app, "--fov", "DEGREES", "vertical field of view [60]",
               [&options](const std::string& text) {
                   double degrees = 0.0;
                   if (!parse_number(text, degrees) || degrees < 1.0 || degrees > 179.0) {
                       return false;
                   }
                   options.vertical_fov = static_cast<float>(degrees);
                   return true;
               });
    add_vector(app, "--light-position", options.light_position,
               "where the light's orbit starts [above the scene]");
    add_vector(app, "--light-color", options.light_color, "linear [1,1,1]");
    add_vector(app, "--ambient", options.ambient, "ambient light, linear [0.02,0.02,0.02]");
    add_vector(app, "--background", options.background, "linear [0.1,0.1,0.1]");
    add_parsed(app, "--time", "SECONDS", "instant of the light's orbit, 1 rad/s about z [0]",
               [&options](const std::string& text) { return parse_number(text, options.time); });
    app.add_flag("!--no-normal-map", options.normal_map, "shade with the vertex normals");
    app.add_flag("!--no-alpha-mask", options.alpha_mask, "draw what alpha masks cut away");
}

void add_device_options(CLI::App& app, Options& options) {
    app.add_option("--samples", options.samples,
                   "samples a pixel, 1 or 4 [4; 1 in a window on a CPU device]")
        ->check(CLI::IsMember({1, 4}))
        ->type_name("N");
    app.add_option("--anisotropy", options.anisotropy,
                   "largest anisotropy of texture filtering, 1 to 16 [16 on GPUs, 1 on CPUs]")
        ->check(CLI::Range(1, 16))
        ->type_name("N");
    app.add_option("--device", options.device, "index or part of the name [the fastest kind]")
        ->type_name("INDEX|NAME");
    app.add_flag("--list-devices", options.list_devices, "print the Vulkan devices and end");
    app.add_flag("--list-views", options.list_views, "print the views and end");
    app.add_flag("--validation", options.validation,
                 "run Vulkan's validation layers; any message is a failure");
    app.add_option("--stats", options.stats, "write timings and counts as JSON (with --output)")
        ->type_name("FILE.json");
    app.add_option("--bench", options.bench_frames,
                   "draw N more frames and print their times (with --output)")
        ->check(CLI::Range(1, 1'000'000))
        ->type_name("N");
}

}  // namespace

std::optional<Options> parse_options(int argc, const char* const* argv) {
    Options options;
    CLI::App app(
        "Draws a .cw2mesh file: in a window, or with --output into a picture with no display.",
        "cw2");
    app.set_version_flag("--version", "cw2 " CW2_VERSION);
    app.add_option("SCENE", options.scene, "file baked by cw2-bake")->type_name("SCENE.cw2mesh");
    app.add_option("-o,--output", options.output, "write one picture and end")
        ->type_name("FILE.png|FILE.exr");
    add_parsed(app, "--size", "WIDTHxHEIGHT", "pixels [1280x720]",
               [&options](const std::string& text) { return parse_size(text, options); });
    add_view_options(app, options);
    add_device_options(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        app.exit(success, std::cout, std::cerr);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    if (options.scene.empty() && !options.list_devices && !options.list_views) {
        throw UsageError("no scene is given; see --help");
    }
    if (!options.output && (options.stats || options.bench_frames > 0)) {
        throw UsageError("--stats and --bench need --output");
    }
    return options;
}

FrameSettings frame_settings(const Options& options, const Bounds& bounds, float aspect) {
    constexpr float kRadiansPerDegree = 3.14159265f / 180.0f;
    FrameSettings settings;
    settings.view = options.view;
    settings.normal_map = options.normal_map;
    settings.alpha_mask = options.alpha_mask;
    settings.camera = default_camera(bounds, options.vertical_fov * kRadiansPerDegree, aspect);
    settings.camera.position = options.camera_position.value_or(settings.camera.position);
    settings.camera.target = options.camera_target.value_or(settings.camera.target);
    if (settings.camera.position == settings.camera.target) {
        throw UsageError("the camera's position and target are the same point");
    }
    settings.light = {options.light_position.value_or(default_light_position(bounds)),
                      options.light_color, options.ambient};
    settings.background = options.background;
    return settings;
}

void require_size(const Options& options, const Device& device) {
    const std::uint32_t largest = device.properties().limits.maxImageDimension2D;
    if (options.width > largest || options.height > largest) {
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
           std::uint64_t{options.width} * options.height * options.samples.value_or(4) >= kSamples;
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
