// All that lies over the picture: the panel, the list of keys, the field that asks for a path, and
// a line for what is to be told.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "cw2/window/input.h"
#include "cw2/window/overlay.h"
#include "cw2/window/ui_pass.h"
#include "cw2/window/window.h"

namespace cw2 {

/// The latest thing that the window has to tell.
struct Message {
    std::string words;  ///< empty for none
    bool is_error = false;
};

class Ui {
 public:
    /// Draws the panel between ImGui's NewFrame and Render, and adds the commands of its buttons.
    using Panel = std::function<void(Input&)>;

    /// For images of `format`, `slots` of them in flight at once. All arguments must outlive this.
    Ui(const Window& window, const Instance& instance, const Device& device, VkFormat format,
       std::uint32_t slots);
    /// Waits for the frames in flight.
    ~Ui();
    Ui(const Ui&) = delete;
    Ui& operator=(const Ui&) = delete;

    bool shows_panel() const { return panel_shown_; }
    void toggle_panel();
    void toggle_help();
    /// False where the list of keys is not shown.
    bool close_help();
    void ask_for_path();

    const Message& message() const { return message_; }
    void say(const std::string& words, bool is_error);
    /// From now on, for a while, a line says how to go on; it goes with the first command.
    void begin_hint();
    void end_hint() { hint_until_ = {}; }
    /// The line is left out, for a picture of the window.
    void hide_line(bool hidden);

    /// Whether there is anything of it now.
    bool shows() const;
    /// Whether it must be drawn again before it shows what the latest events did.
    bool unsettled() const { return unsettled_ > 0; }

    /// Lays it out, and takes out of `input` what was for it. Gives the path that was entered.
    std::optional<std::filesystem::path> run(Input& input, bool has_mouse, const Panel& panel);
    /// After run(), or where nothing of it was shown before: again, if something has changed since.
    void refresh(const Input& input, bool showed, const Panel& panel);

    /// What draws it; null where nothing is shown.
    UiPass* pass() { return shows() ? &*pass_ : nullptr; }
    /// Takes the focus away from the panel.
    void drop_focus();

 private:
    std::string line() const;
    void filter(Input& input);

    const Window& window_;
    const Instance& instance_;
    const Device& device_;
    VkFormat format_;
    std::uint32_t slots_;
    std::optional<UiPass> pass_;  ///< from when something is first shown
    PathField path_field_;
    Message message_;
    std::chrono::steady_clock::time_point message_until_{};
    std::chrono::steady_clock::time_point hint_until_{};
    bool line_hidden_ = false;
    bool panel_shown_ = false;
    bool help_shown_ = false;
    bool is_old_ = false;  ///< what was laid out is not what should be seen
    int unsettled_ = 0;    ///< frames
};

}  // namespace cw2
