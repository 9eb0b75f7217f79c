#include "cw2/window/ui.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace cw2 {

namespace {

using Clock = std::chrono::steady_clock;

/// For how long a message, or an error, lies over the picture.
constexpr std::chrono::seconds kMessageTime{6};
constexpr std::chrono::seconds kErrorTime{15};
constexpr std::string_view kHint = "Tab panel, H keys, drop a file";
/// Frames that Dear ImGui takes to show what an event does.
constexpr int kFramesToSettle = 3;

}  // namespace

Ui::Ui(const Window& window, const Instance& instance, const Device& device, VkFormat format,
       std::uint32_t slots)
    : window_(window), instance_(instance), device_(device), format_(format), slots_(slots) {}

Ui::~Ui() {
    device_.wait_idle();
}

void Ui::toggle_panel() {
    panel_shown_ = !panel_shown_;
    is_old_ = true;
}

void Ui::toggle_help() {
    help_shown_ = !help_shown_;
    is_old_ = true;
}

bool Ui::close_help() {
    is_old_ |= help_shown_;
    return std::exchange(help_shown_, false);
}

void Ui::ask_for_path() {
    path_field_.open();
    is_old_ = true;
}

void Ui::say(const std::string& words, bool is_error) {
    message_ = {words, is_error};
    message_until_ = Clock::now() + (is_error ? kErrorTime : kMessageTime);
    is_old_ = true;
}

void Ui::begin_hint() {
    hint_until_ = Clock::now() + kMessageTime;
}

void Ui::hide_line(bool hidden) {
    line_hidden_ = hidden;
    is_old_ = true;
}

std::string Ui::line() const {
    // In the panel a message has its place.
    if (panel_shown_ || line_hidden_) return {};
    if (Clock::now() < message_until_) return message_.words;
    return Clock::now() < hint_until_ ? std::string(kHint) : std::string();
}

bool Ui::shows() const {
    return panel_shown_ || help_shown_ || path_field_.is_open() || !line().empty();
}

void Ui::filter(Input& input) {
    if (pass_->wants_mouse()) {
        if (input.mouse_action && input.mouse_action->pressed) input.mouse_action.reset();
        input.wheel = 0.0f;
    }
    const bool has_focus = pass_->wants_keys();
    if (has_focus) input.direction = {};
    const bool types = pass_->wants_text() || path_field_.is_open();
    std::erase_if(input.commands, [&](Command& command) {
        if (types) {
            return command.kind != CommandKind::save_picture &&
                   command.kind != CommandKind::save_window;
        }
        if (command.kind != CommandKind::save_settings_in_panel) return false;
        command.kind = CommandKind::save_settings;
        return !has_focus;
    });
}

std::optional<std::filesystem::path> Ui::run(Input& input, bool has_mouse, const Panel& panel) {
    const float scale = window_.content_scale();
    if (!pass_) pass_.emplace(window_.handle(), instance_, device_, format_, slots_, scale);
    is_old_ = false;
    unsettled_ = input.anything ? kFramesToSettle : std::max(unsettled_ - 1, 0);
    pass_->begin_frame(input, has_mouse);
    filter(input);
    if (panel_shown_) panel(input);
    std::optional<std::filesystem::path> entered = path_field_.draw(scale);
    if (help_shown_) {
        draw_help(scale);
    } else if (const std::string words = line(); !words.empty()) {
        draw_line(words, words == message_.words && message_.is_error, scale);
    }
    pass_->end_frame();
    return entered;
}

void Ui::refresh(const Input& input, bool showed, const Panel& panel) {
    if (!shows() || (showed && !is_old_)) return;
    Input nothing{.buttons = input.buttons, .cursor = input.cursor};
    if (pass_ && !showed) {
        // What was clicked while it was hidden was not for it.
        pass_->begin_frame(nothing, false);
        pass_->end_frame();
    }
    nothing.anything = true;
    run(nothing, true, panel);
}

void Ui::drop_focus() {
    if (pass_) pass_->drop_focus();
}

}  // namespace cw2
