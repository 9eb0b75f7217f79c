#include "cw2-bake/input_files.h"

#include <fnmatch.h>

#include <algorithm>
#include <climits>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/io.h"
#include "cw2-bake/base/diagnostics.h"

namespace bake {
namespace {

namespace fs = std::filesystem;

/// Where a file is, or would be; none where there is no such folder.
std::optional<fs::path> place_of(const fs::path& path) {
    if (path.native().size() >= PATH_MAX) return std::nullopt;
    const fs::path folder = path.parent_path();
    std::error_code error;
    const fs::path canonical = fs::canonical(folder.empty() ? "." : folder, error);
    return error ? std::nullopt : std::optional(canonical / path.filename());
}

bool is_same_file(const fs::path& a, const fs::path& b) {
    std::error_code error;
    const bool same = fs::equivalent(a, b, error);
    if (same || !error) return same;
    const std::optional<fs::path> place = place_of(a);
    return place && place == place_of(b);
}

/// What in `folder` the pattern `component` of a path matches.
std::vector<fs::path> matches(const fs::path& folder, const std::string& component) {
    std::vector<fs::path> found;
    std::error_code error;
    fs::directory_iterator at(folder.empty() ? "." : folder, error);
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        const fs::path entry = at->path().filename();
        if (::fnmatch(component.c_str(), entry.c_str(), FNM_PERIOD) == 0)
            found.push_back(folder / entry);
    }
    return found;
}

/// Whether make, which expands brackets, would take other files for `path`. glob() tells, too, but
/// its paths can be more and more with every component.
bool is_pattern(const fs::path& path) {
    constexpr std::size_t kMostPaths = 64;
    if (path.native().find('[') == std::string::npos) return false;
    std::vector<fs::path> paths{""};
    for (const fs::path& component : path) {
        const bool may_match = component.native().find_first_of("[\\") != std::string::npos;
        std::vector<fs::path> next;
        for (const fs::path& parent : paths) {
            if (may_match) {
                std::ranges::move(matches(parent, component.native()), std::back_inserter(next));
            } else {
                next.push_back(parent / component);
            }
        }
        if (next.size() > kMostPaths) return true;
        paths = std::move(next);
    }
    return std::ranges::any_of(paths, [&](const fs::path& other) {
        std::error_code error;
        return other != path && fs::exists(other, error);
    });
}

[[noreturn]] void refuse(const fs::path& name) {
    throw BakeError("--depfile: " + name.string() + ": make or ninja cannot take this name here");
}

/// As make and ninja both read names: blanks, # and : after a backslash, $ twice. Throws BakeError
/// for a name that one of them would split, expand or run.
std::string escaped(const fs::path& path) {
    const std::string& name = path.native();
    const bool is_control =
        std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7F; });
    const bool is_archive = name.ends_with(')') && name.find('(') != name.npos;
    if (is_control || is_archive || name.empty() || name.front() == '=' ||
        name.find_first_of("\"&';*?<>|^`") != name.npos ||
        std::string_view(" \\:").find(name.back()) != std::string_view::npos || is_pattern(path))
        refuse(path);
    // Behind ./ nothing is an operator, or somebody's home.
    std::string text = name.find_first_of("~+!-%") == 0 ? "./" : "";
    for (const char c : name) {
        if (std::string_view(" #:$=%").find(c) != std::string_view::npos && text.ends_with('\\'))
            refuse(path);
        if (c == ' ' || c == '#' || c == ':') text += '\\';
        if (c == '$') text += '$';
        text += c;
    }
    return text;
}

/// Names with these make a pattern or a variable of what stands before the colon of a rule.
bool can_be_target(const fs::path& path) {
    return path.native().find_first_of("%=") == path.native().npos;
}

}  // namespace

std::vector<fs::path> input_files(const SourceScene& scene, const Settings& settings) {
    std::vector<fs::path> files;
    std::set<fs::path> known;
    const auto add = [&](const fs::path& file) {
        if (known.insert(file).second) files.push_back(file);
    };
    const auto add_image = [&](const std::optional<TextureMap>& map) {
        if (!map || map->embedded) return;
        std::error_code error;
        const bool is_lacked = settings.textures != TextureMode::none;
        if (is_lacked || fs::exists(map->file, error)) add(map->file);
    };
    for (const fs::path& file : scene.files) add(file);
    for (const SourceMaterial& material : scene.materials) {
        for (const auto& map : material.maps.values) add_image(map);
        if (material.bump_map) add_image(material.bump_map->map);
    }
    return files;
}

void refuse_overwriting(const Settings& settings, const std::vector<fs::path>& inputs) {
    std::vector<fs::path> outputs;
    const auto take = [&](const fs::path& output) {
        const auto is_output = [&](const fs::path& path) { return is_same_file(output, path); };
        if (std::ranges::any_of(inputs, is_output))
            throw BakeError(output.string() + ": is an input; the output must be another file");
        if (std::ranges::any_of(outputs, is_output))
            throw BakeError(output.string() + ": is named for two outputs");
        outputs.push_back(output);
    };
    take(settings.output);
    if (settings.stats) take(*settings.stats);
    if (settings.depfile) take(*settings.depfile);
}

void require_writable(const Settings& settings) {
    std::error_code error;
    if (!fs::exists(settings.input, error)) return;
    const auto check = [](const fs::path& output) { const common::OutputFile file(output); };
    check(settings.output);
    if (settings.stats) check(*settings.stats);
    if (settings.depfile) check(*settings.depfile);
}

std::string depfile_text(const fs::path& output, const std::vector<fs::path>& inputs) {
    std::string text = escaped(output) + ':';
    std::string rest;
    for (const fs::path& input : inputs) {
        const std::string name = " \\\n  " + escaped(input);
        text += name;
        if (input != inputs.front() && can_be_target(input)) rest += name;
    }
    std::error_code error;
    if (!can_be_target(output)) refuse(output);
    if (inputs.front().native().find('=') != std::string::npos) refuse(inputs.front());
    for (const fs::path& input : inputs)
        if (!can_be_target(input) && !fs::exists(input, error)) refuse(input);
    if (!rest.empty()) text += '\n' + rest.substr(5) + ':';
    return text + '\n';
}

void write_depfile(const fs::path& depfile, const std::string& text) {
    common::write_file(depfile, std::as_bytes(std::span(text)));
}

}  // namespace bake
