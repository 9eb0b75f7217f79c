#include "cw2/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <span>
#include <vector>

#include "cw2/config.h"
#include "cw2/image_file.h"
#include "cw2/option_table.h"
#include "mesh-format/io.h"

namespace cw2 {

namespace {

/// What a setting of the name, command line or config file, has told.
void take(const Setting& setting, const std::string& text, const std::string& origin,
          Options& options) {
    // Nothing has set it before; what a config file says of it will not count.
    if (text == "default" && setting.name != "scene") return;
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
        app.add_flag_function(
            name, [take_over](std::int64_t count) { take_over(count > 0 ? "true" : "false"); },
            setting.description);
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

void require_sense(const Options& options) {
    if (options.list_devices || options.list_views) return;
    if (options.scene.empty()) throw UsageError("no scene is given; see --help");
    if (options.output && !image_kind(*options.output)) {
        throw UsageError(
            fmt::format("--output: '{}' ends in neither .png nor .exr", options.output->string()));
    }
    if (!options.output && (options.stats || options.bench_frames > 0 || options.frames)) {
        throw UsageError("--stats, --bench and --frames need --output");
    }
    if (options.stats) {
        for (const std::filesystem::path& other : {options.scene, *options.output}) {
            std::error_code ignored;
            if (*options.stats == other ||
                std::filesystem::equivalent(*options.stats, other, ignored)) {
                throw UsageError(fmt::format("--stats would replace {}", other.string()));
            }
        }
    }
    if (!options.frames && options.orbit) throw UsageError("--orbit needs --frames");
    if (!options.frames) return;
    if (options.bench_frames > 0) throw UsageError("--bench and --frames exclude each other");
    if (options.frames->size() > 1 && !frame_name(options.output->string(), 0)) {
        throw UsageError(
            fmt::format("--output: '{}' is no pattern for several frames, such as name_%04d.png",
                        options.output->string()));
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
                   "read options from a file of `name = value` lines; the command line wins, and "
                   "--NAME default or --FLAG=false undoes")
        ->type_name("FILE.toml");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        app.exit(success, std::cout, std::cerr);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    } catch (const std::logic_error&) {
        // CLI11 leaves it to std::stoll.
        throw UsageError("a switch with '=' is followed by true or false");
    }
    if (config) {
        apply_config(*config, settings, app, options);
        // A split of the file would hide the view that the command line asks for.
        if (app.count("--view") > 0 && app.count("--split") == 0) options.split.reset();
    }
    require_sense(options);
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
    const auto side_of = [&](Side side) {
        side.normal_map &= options.normal_map;
        side.alpha_mask &= options.alpha_mask;
        return side;
    };
    static_cast<Side&>(settings) =
        side_of(options.split ? options.split->front() : Side{options.view});
    if (options.split) settings.split = {side_of(options.split->back()), options.divider};
    settings.exposure = options.exposure;
    settings.false_color = options.false_color;
    const float fov = options.vertical_fov.value_or(kVerticalFov) * kRadiansPerDegree;
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
    // Of the whole turn, so that a part of it has the same frames.
    const bool many = !options.output || options.bench_frames > 0 ||
                      (options.frames && options.frames->count > 1);
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
