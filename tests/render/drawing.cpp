#include "tests/render/drawing.h"

#include <algorithm>
#include <stdexcept>

#include "tests/support/process.h"

namespace {

void run_silently(std::vector<std::string> command, const std::vector<std::string>& options) {
    command.insert(command.end(), options.begin(), options.end());
    const Outcome outcome = run(command);
    if (outcome.status == 0 && outcome.out.empty() && outcome.err.empty()) return;
    std::string line;
    for (const std::string& part : command) line += part + ' ';
    throw std::runtime_error(line + "ended with " + std::to_string(outcome.status) + "\n" +
                             outcome.out + outcome.err);
}

}  // namespace

void make_test_scenes(const std::filesystem::path& folder) {
    run_silently({MAKE_TEST_SCENES_PROGRAM, folder}, {});
}

std::filesystem::path bake_scene(const std::filesystem::path& obj,
                                 const std::vector<std::string>& options) {
    std::filesystem::path baked = obj;
    baked.replace_extension(".cw2mesh");
    std::vector<std::string> command{BAKE_PROGRAM, obj, "-o", baked, "--strict", "--quiet"};
    if (std::ranges::find(options, "--textures") == options.end()) {
        command.insert(command.end(), {"--textures", "lossless"});
    }
    run_silently(command, options);
    return baked;
}

Picture draw_scene(const std::filesystem::path& scene, const std::string& extension,
                   const std::vector<std::string>& options) {
    std::filesystem::path picture = scene;
    picture.replace_extension(extension);
    run_silently({CW2_PROGRAM, scene, "--output", picture, "--validation"}, options);
    return read_picture(picture);
}
