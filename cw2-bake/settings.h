// The command line of cw2-bake.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "cw2-bake/textures/texture.h"
#include "mesh-format/layout.h"

namespace CLI {
class App;
}

namespace bake {

struct Settings {
    std::filesystem::path input;
    std::filesystem::path output;  ///< [the input with the extension .cw2mesh]; may be a glTF
    bool z_up = false;             ///< the input's up axis is +Z
    mesh_format::FrameForm frame_form = mesh_format::FrameForm::quat48;
    mesh_format::PositionForm position_form = mesh_format::PositionForm::quantised;
    TextureMode textures = TextureMode::bc;
    bool compress = false;                         ///< store geometry and textures in fewer bytes
    int threads = 0;                               ///< 0: one a processor
    std::optional<std::filesystem::path> depfile;  ///< where to write what the output depends on
    std::optional<std::filesystem::path> stats;    ///< where to write what the bake did, as JSON
    bool strict = false;                           ///< a warning is an error
    bool restricted = false;                       ///< names lead to nowhere but the input's folder
    bool quiet = false;                            ///< print errors only
    bool is_baked = false;                         ///< the input is a .cw2mesh file
    bool inspect = false;                          ///< print what is in the input, a .cw2mesh file
    bool json = false;                             ///< with inspect: for machines
};

/// A command line that does not make sense; what() is one line.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Reads the command line. `--help` and `--version`, which prints "cw2-bake " and `version`, give
/// nothing. Throws UsageError.
std::optional<Settings> parse_settings(int argc, const char* const* argv,
                                       const std::string& version);

/// Shows `look` the whole command line as CLI11 has it.
void show_command_line(const std::function<void(const CLI::App&)>& look);

}  // namespace bake
