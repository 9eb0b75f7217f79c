// What keys and mouse do in the window, stated once: the window, its list of keys, --help and
// docs/cw2.md all take it from here.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace cw2 {

/// What a key, or a button of the panel, asks for.
enum class CommandKind {
    toggle_panel,
    toggle_help,
    show_view,
    next_view,
    previous_view,
    toggle_normal_map,
    toggle_alpha_mask,
    toggle_two_sided,
    toggle_light,
    frame_scene,
    frame_material,  ///< of the pixel that was read last
    reset,
    open,  ///< asks for a path
    next_file,
    previous_file,
    reload_shaders,
    save_picture,
    save_window,  ///< the panel included
    save_settings,
    save_settings_in_panel,  ///< the same where the panel has the focus; else the key is not for it
    copy_camera,
    end,
};

struct Control {
    /// Keys are apart by ", ", and a modifier's name and a '+' stand before one that needs it;
    /// "1 to 9" are nine, for nine views, and with Shift the next nine.
    std::string_view input;
    std::string_view does;
    std::optional<CommandKind> command;  ///< none: the mouse, or keys that are held
};

inline constexpr std::array kControls{
    Control{"Left drag", "orbits about the target; moves the divider of a split view", {}},
    Control{"Middle drag, Shift+left drag", "moves the picture under the cursor", {}},
    Control{"Wheel", "goes towards what is under the cursor, or away from it", {}},
    Control{"Right drag", "looks around", {}},
    Control{"W A S D, E Q", "flies; up and down (Shift: faster, Ctrl: slower)", {}},
    Control{"Click", "reads a pixel: its material, and every term of its shading", {}},
    Control{"Double click", "makes the point there the target", {}},
    Control{"F, Home", "brings everything into view", CommandKind::frame_scene},
    Control{"Shift+F", "brings the material that was clicked into view",
            CommandKind::frame_material},
    Control{"R", "resets camera and light", CommandKind::reset},
    Control{"L + left drag", "moves the light about the scene's centre", {}},
    Control{"Space", "starts and stops the light's orbit", CommandKind::toggle_light},
    Control{"1 to 9", "shows one of the first nine views", CommandKind::show_view},
    Control{"Shift+1 to 9", "shows one of the next nine", CommandKind::show_view},
    Control{"V", "shows the next view", CommandKind::next_view},
    Control{"Shift+V", "shows the view before", CommandKind::previous_view},
    Control{"N", "normal maps on and off", CommandKind::toggle_normal_map},
    Control{"M", "alpha masks on and off", CommandKind::toggle_alpha_mask},
    Control{"T", "two-sided: turns the normals of back faces to the camera, or not",
            CommandKind::toggle_two_sided},
    Control{"Tab", "shows and hides the panel", CommandKind::toggle_panel},
    Control{"H, ?, F1", "shows and hides this list", CommandKind::toggle_help},
    Control{"Drop", "opens the files that are dropped on the window", {}},
    Control{"Ctrl+O", "opens a file by its path", CommandKind::open},
    Control{"Page down", "opens the next file of those that were given", CommandKind::next_file},
    Control{"Page up", "opens the one before", CommandKind::previous_file},
    Control{"F12", "saves the picture as cw2-0001.png, cw2-0002.png ... in the current folder",
            CommandKind::save_picture},
    Control{"Shift+F12", "saves the whole window, in the same way", CommandKind::save_window},
    Control{"F2", "saves the settings as cw2-0001.toml ... for --config",
            CommandKind::save_settings},
    Control{"S in the panel", "does the same", CommandKind::save_settings_in_panel},
    Control{"Ctrl+C", "copies camera and light as options, to the clipboard and to standard output",
            CommandKind::copy_camera},
    Control{"F5, Ctrl+R", "compiles the shaders anew from their sources",
            CommandKind::reload_shaders},
    Control{"Escape", "closes what asks or explains, else ends", CommandKind::end},
};

/// All of them as the end of --help.
std::string controls_text();

/// The same as the rows of the table in docs/cw2.md.
std::string controls_markdown();

}  // namespace cw2
