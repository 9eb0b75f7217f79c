#include "cw2/options/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <span>
#include <sstream>
#include <vector>

#include "common/file_kind.h"
#include "common/io.h"
#include "cw2/options/config.h"
#include "cw2/options/controls.h"
#include "cw2/options/option_table.h"
#include "cw2/render/image_file.h"

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
    if (setting.name == "scene") {
        const auto take_files = [&options, take_over](const std::vector<std::string>& paths) {
            take_over(paths.front());
            if (paths.size() > 1) options.files.assign(paths.begin(), paths.end());
        };
        app.add_option_function<std::vector<std::string>>(name, take_files, setting.description)
            ->type_name(setting.form);
    } else if (setting.form.empty()) {
        // What CLI11 takes for true and false, and whether it says so, differs by version.
        const CLI::Validator is_switch(
            [](const std::string& text) {
                return text == "true" || text == "false"
                           ? std::string()
                           : "a switch with '=' is followed by true or false";
            },
            "");
        app.add_flag_function(
               name, [take_over](std::int64_t count) { take_over(count > 0 ? "true" : "false"); },
               setting.description)
            ->check(is_switch);
    } else {
        app.add_option_function<std::string>(name, take_over, setting.description)
            ->type_name(setting.form);
    }
}

struct CommandLine {
    explicit CommandLine(const std::string& version)
        : app("Draws a .cw2mesh file, an OBJ or a glTF: in a window, or with --output into a "
              "picture with no display.",
              "cw2") {
        app.footer(controls_text());
        app.set_version_flag("--version", "cw2 " + version);
        for (const Setting& setting : settings) add_to(app, setting, options);
        app.add_option(
               "--config", config,
               "read options from a file of `name = value` lines; the command line wins, and "
               "--NAME default or --FLAG=false undoes")
            ->type_name("FILE.toml");
    }

    const std::vector<Setting> settings = all_settings();
    Options options;
    std::optional<std::filesystem::path> config;
    CLI::App app;
};

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
    if ((options.z_up || options.strict || options.restricted) && !is_source(options.scene))
        throw UsageError("--up, --strict and --restrict are for scenes that are not baked yet");
    if ((options.output || options.pixel) && options.files.size() > 1) {
        throw UsageError(fmt::format("--output and --pixel take one scene: '{}' is another",
                                     options.files[1].string()));
    }
    if (options.output && !image_kind(*options.output)) {
        throw UsageError(
            fmt::format("--output: '{}' ends in neither .png nor .exr", options.output->string()));
    }
    if (!options.output && options.frames) throw UsageError("--frames needs --output");
    if (!options.output && !options.bench_pictures && options.stats)
        throw UsageError("--stats needs --output or --bench");
    if (options.encoding == Encoding::linear && options.false_color) {
        throw UsageError("--encoding linear and --false-color exclude each other");
    }
    if (options.pixel) {
        if (options.frames) throw UsageError("--pixel and --frames exclude each other");
        if (options.pixel->x >= options.size.width || options.pixel->y >= options.size.height) {
            throw UsageError(fmt::format("--pixel: {},{} is outside a picture of {}x{}",
                                         options.pixel->x, options.pixel->y, options.size.width,
                                         options.size.height));
        }
    }
    if (options.stats) {
        for (const std::filesystem::path& other :
             {options.scene, options.output.value_or(options.scene)}) {
            std::error_code ignored;
            if (*options.stats == other ||
                std::filesystem::equivalent(*options.stats, other, ignored)) {
                throw UsageError(fmt::format("--stats would replace {}", other.string()));
            }
        }
    }
    if (!options.frames && !options.bench_pictures && options.orbit)
        throw UsageError("--orbit needs --frames or --bench");
    if (!options.frames) return;
    if (options.bench_pictures) throw UsageError("--bench and --frames exclude each other");
    if (options.frames->size() > 1 && !frame_name(options.output->string(), 0)) {
        throw UsageError(
            fmt::format("--output: '{}' is no pattern for several frames, such as name_%04d.png",
                        options.output->string()));
    }
}

}  // namespace

bool is_source(const std::filesystem::path& scene) {
    const std::optional<common::FileKind> kind = common::file_kind(scene);
    return kind == common::FileKind::obj || kind == common::FileKind::gltf;
}

std::optional<Options> parse_options(int argc, const char* const* argv,
                                     const std::string& version) {
    CommandLine line(version);
    try {
        line.app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        std::ostringstream text;
        line.app.exit(success, text, text);
        common::print(text.str());
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    if (line.config) {
        apply_config(*line.config, line.settings, line.app, line.options);
        // A split of the file would hide the view that the command line asks for.
        if (line.app.count("--view") > 0 && line.app.count("--split") == 0)
            line.options.split.reset();
    }
    require_sense(line.options);
    return line.options;
}

void show_command_line(const std::function<void(const CLI::App&)>& look) {
    look(CommandLine("").app);
}

void write_config(const std::filesystem::path& path, const Options& options) {
    std::string text = "# Options for cw2 --config.\n";
    for (const Setting& setting : all_settings()) {
        const std::string value = setting.write(options);
        if (!value.empty()) text += setting.name + " = " + value + '\n';
    }
    common::write_file(path, std::as_bytes(std::span(text)));
}

}  // namespace cw2
