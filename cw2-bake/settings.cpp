#include "cw2-bake/settings.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <sstream>
#include <string>

#include "common/file_kind.h"
#include "common/io.h"

namespace bake {

namespace {

/// Adds an option whose value is one of `names`.
template <typename T>
void add_choice(CLI::App& app, const std::string& name, T& target,
                const std::map<std::string, T>& names, const std::string& description) {
    std::string form;
    for (const auto& entry : names) form += (form.empty() ? "" : "|") + entry.first;
    app.add_option_function<std::string>(
           name,
           [&target, names, name, form](const std::string& text) {
               const auto found = names.find(text);
               if (found == names.end()) {
                   throw CLI::ValidationError(name + ": '" + text + "' is none of " + form);
               }
               target = found->second;
           },
           description)
        ->type_name(form);
}

constexpr const char* kDescription =
    "Turns a Wavefront OBJ or a glTF 2.0 with its materials and textures into one file for cw2; or "
    "that file, or any of these, into a glTF.";

void add_options(CLI::App& app, Settings& settings) {
    using mesh_format::FrameForm;
    using mesh_format::PositionForm;
    app.add_option("INPUT", settings.input,
                   "scene to bake (.obj, .gltf, .glb), or a baked file to export or inspect")
        ->required()
        ->type_name("FILE");
    app.add_option("-o,--output", settings.output,
                   "file to write; .glb or .gltf exports [INPUT as .cw2mesh]")
        ->type_name("FILE.cw2mesh|FILE.glb|FILE.gltf");
    add_choice<bool>(app, "--up", settings.z_up, {{"y", false}, {"z", true}},
                     "the input's up axis [y]");
    add_choice<FrameForm>(app, "--tangent-frame", settings.frame_form,
                          {{"quat48", FrameForm::quat48},
                           {"quat32", FrameForm::quat32},
                           {"half3", FrameForm::half3},
                           {"f32", FrameForm::f32}},
                          "how a vertex holds its tangent frame [quat48]");
    add_choice<PositionForm>(
        app, "--positions", settings.position_form,
        {{"quantised", PositionForm::quantised}, {"f32", PositionForm::f32}},
        "how a vertex holds its position; f32 keeps UVs as floats, too [quantised]");
    add_choice<TextureMode>(
        app, "--textures", settings.textures,
        {{"bc", TextureMode::bc}, {"lossless", TextureMode::lossless}, {"none", TextureMode::none}},
        "how textures are stored [bc]");
    app.add_flag("--compress", settings.compress,
                 "store the same geometry and nearly the same textures in fewer bytes");
    app.add_option("--threads", settings.threads, "threads to use [one a processor]")
        ->check(CLI::Range(1, 1024).description(""))
        ->type_name("N");
    app.add_option(
           "--depfile", settings.depfile,
           "write a rule for make or ninja: the output depends on the scene and all that it names")
        ->type_name("FILE");
    app.add_option("--stats", settings.stats, "write counts, errors, times and memory as JSON")
        ->type_name("FILE.json");
    app.add_flag("--strict", settings.strict, "a warning is an error");
    app.add_flag("--restrict", settings.restricted,
                 "read nothing outside the scene's folder, whatever the scene names");
    app.add_flag("--quiet", settings.quiet, "print errors only");
    app.add_flag("--inspect", settings.inspect, "print what is in a baked file");
    app.add_flag("--json", settings.json, "with --inspect: print JSON");
}

}  // namespace

std::optional<Settings> parse_settings(int argc, const char* const* argv,
                                       const std::string& version) {
    Settings settings;
    CLI::App app(kDescription, "cw2-bake");
    app.set_version_flag("--version", "cw2-bake " + version);
    add_options(app, settings);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        std::ostringstream text;
        app.exit(success, text, text);
        common::print(text.str());
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    if (settings.json && !settings.inspect) throw UsageError("--json needs --inspect");
    if (settings.output.empty()) {
        settings.output = std::filesystem::path(settings.input).replace_extension("cw2mesh");
    }
    settings.is_baked = common::file_kind(settings.input) == common::FileKind::baked;
    if (settings.inspect) return settings;
    for (const char* option : {"--up", "--tangent-frame", "--positions", "--textures", "--compress",
                               "--threads", "--stats", "--restrict"}) {
        if (settings.is_baked && app.count(option) > 0) {
            throw UsageError(fmt::format("{} is not for files that are baked already", option));
        }
    }
    if (common::file_kind(settings.output) == common::FileKind::gltf) {
        if (settings.compress) throw UsageError("--compress is for .cw2mesh files");
        // A glTF holds floats and PNGs: they should be as good as the source.
        if (app.count("--tangent-frame") == 0) settings.frame_form = mesh_format::FrameForm::f32;
        if (app.count("--positions") == 0) settings.position_form = mesh_format::PositionForm::f32;
        if (app.count("--textures") == 0) settings.textures = TextureMode::lossless;
    }
    return settings;
}

void show_command_line(const std::function<void(const CLI::App&)>& look) {
    Settings settings;
    CLI::App app(kDescription, "cw2-bake");
    app.set_version_flag("--version", "");
    add_options(app, settings);
    look(app);
}

}  // namespace bake
