#include "cw2-bake/input_files.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <system_error>

#include "common/io.h"
#include "cw2-bake/base/diagnostics.h"

namespace bake {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (fs::equivalent(a, b, error)) return true;
    const fs::path canonical = fs::weakly_canonical(a, error);
    return !error && canonical == fs::weakly_canonical(b, error) && !error;
}

/// As make reads names: blanks, backslashes before them, # and : after a backslash, $ twice.
std::string escaped(const fs::path& path) {
    std::string text;
    std::size_t backslashes = 0;
    for (const char c : path.string()) {
        if (c == '\n' || c == '\r')
            throw BakeError("--depfile: a file's name has a line break: " + path.string());
        if (c == ' ' || c == '\t') text.append(backslashes + 1, '\\');
        if (c == '#' || c == ':') text += '\\';
        if (c == '$') text += '$';
        text += c;
        backslashes = c == '\\' ? backslashes + 1 : 0;
    }
    return text;
}

}  // namespace

std::vector<fs::path> input_files(const SourceScene& scene) {
    std::vector<fs::path> files;
    std::set<fs::path> known;
    const auto add = [&](const fs::path& file) {
        if (known.insert(file).second) files.push_back(file);
    };
    const auto add_image = [&](const std::optional<TextureMap>& map) {
        std::error_code error;
        if (map && !map->embedded && fs::exists(map->file, error)) add(map->file);
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
        // The inputs exist, so no output that does not can be one of them.
        const auto is_output = [&](const fs::path& path) {
            std::error_code error;
            return fs::equivalent(output, path, error);
        };
        std::error_code error;
        if (fs::exists(output, error) && std::ranges::any_of(inputs, is_output))
            throw BakeError(output.string() + ": is an input; the output must be another file");
        if (std::ranges::any_of(outputs,
                                [&](const fs::path& o) { return is_same_file(output, o); }))
            throw BakeError(output.string() + ": is named for two outputs");
        outputs.push_back(output);
    };
    take(settings.output);
    if (settings.stats) take(*settings.stats);
    if (settings.depfile) take(*settings.depfile);
}

void write_depfile(const fs::path& depfile, const fs::path& output,
                   const std::vector<fs::path>& inputs) {
    std::string text = escaped(output) + ':';
    for (const fs::path& input : inputs) text += " \\\n  " + escaped(input);
    text += '\n';
    common::OutputFile file(depfile);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
}

}  // namespace bake
