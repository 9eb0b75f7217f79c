#include "cw2/interactive.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <glm/common.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/io.h"
#include "cw2/options/frame_of.h"
#include "cw2/render/image_file.h"
#include "cw2/render/picker.h"
#include "cw2/render/scene.h"
#include "cw2/render/shader_compiler.h"
#include "cw2/window/file_watch.h"
#include "cw2/window/panel.h"
#include "cw2/window/pointer.h"
#include "cw2/window/presenter.h"
#include "cw2/window/title.h"
#include "cw2/window/ui_pass.h"
#include "cw2/window/viewer_state.h"
#include "cw2/window/window.h"

namespace cw2 {

namespace {

using Clock = std::chrono::steady_clock;

/// How long one waits for an event where nothing happens.
constexpr double kIdleSeconds = 0.25;
/// How often one looks whether the scene's file has changed.
constexpr double kLookSeconds = 0.5;
/// Frames that Dear ImGui takes to show what an event does.
constexpr int kFramesToSettle = 3;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

float aspect_of(VkExtent2D extent) {
    if (extent.width == 0 || extent.height == 0) return 1.0f;
    return static_cast<float>(extent.width) / static_cast<float>(extent.height);
}

/// The first of cw2-0001.png, cw2-0002.png ... (for extension ".png") that does not exist in the
/// current folder.
std::string new_file_name(std::string_view extension) {
    for (int number = 1;; ++number) {
        std::string name = fmt::format("cw2-{:04}{}", number, extension);
        if (!std::filesystem::exists(std::filesystem::symlink_status(name))) return name;
    }
}

/// What happens while the window is open.
class Session {
 public:
    Session(const Options& options, const std::filesystem::path& sources, const Instance& instance,
            const Device& device, Window& window, VkSurfaceKHR surface)
        : sources_(sources),
          instance_(instance),
          device_(device),
          window_(window),
          layouts_(device),
          watch_(options.scene),
          scene_(std::make_unique<Scene>(
              load_scene(device, layouts_, options.scene, texture_settings(options, device)))),
          presenter_(device, surface, layouts_, built_in_shaders(),
                     options.samples.value_or(kSamples)),
          picker_(device, layouts_, built_in_shaders()),
          state_(completed(options, scene_->start(), scene_->bounds()), scene_->bounds(),
                 aspect_of(window.extent())),
          title_(window, options.scene.filename().string()) {}

    void run() {
        while (!ended_ && !window_.closed()) step();
    }

 private:
    void step() {
        Input input = window_.poll(idle_ ? kIdleSeconds : 0.0);
        follow_the_file();
        const bool extent_changed = !same(extent_, window_.extent());
        extent_ = window_.extent();
        if (panel_shown_) run_panel(input);
        follow_the_mouse(input);
        for (const Command& command : input.commands) obey(command, input);
        const Clock::time_point now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - last_step_).count();
        last_step_ = now;
        stale_ |= state_.apply(input, seconds, aspect_of(extent_)) || extent_changed;
        unshown_ |= input.exposed;
        // The panel shows what a frame takes without waiting for pipelines.
        stale_ |= panel_shown_ && presenter_.times_are_cold();
        const bool drawn = (stale_ || unshown_ || panel_shown_ || presenter_.refines()) && draw();
        if (drawn) {
            if (stale_ && panel_shown_) read_pick();
            stale_ = false;
            unshown_ = false;
        } else {
            presenter_.finish();
        }
        unsettled_ = input.anything ? kFramesToSettle : std::max(unsettled_ - 1, 0);
        idle_ = !drawn || (panel_shown_ && !state_.light_moves() && !presenter_.refines() &&
                           input.direction == glm::vec3(0.0f) && unsettled_ == 0);
        title_.update(state_.settings(), presenter_.times().gpu);
    }

    /// Shows the panel, lets it change the state, and takes out of `input` what was for it.
    void run_panel(Input& input) {
        ui_->begin_frame(input, !pointer_.turns() && !pointer_.drags());
        if (input.mouse_action && input.mouse_action->pressed && ui_->wants_mouse()) {
            input.mouse_action.reset();
        }
        const bool has_focus = ui_->wants_keys();
        if (has_focus) input.direction = {};
        if (ui_->wants_text()) input.commands.clear();
        std::erase_if(input.commands, [&](Command& command) {
            if (command.kind != CommandKind::save_settings_in_panel) return false;
            command.kind = CommandKind::save_settings;
            return !has_focus;
        });
        PanelState panel{state_.options(), state_.light_moves()};
        const std::vector<Command> wishes = draw_panel(
            {.device = device_.properties().deviceName,
             .bounds = scene_->bounds(),
             .extent = extent_,
             .times = presenter_.times(),
             .counts = presenter_.counts(),
             .triangles = scene_->triangle_count() * (state_.options().split ? 2 : 1),
             .scene_bytes = scene_->memory_bytes(),
             .image_bytes = presenter_.memory_bytes(),
             .pick = pick_,
             .picked_material = pick_ ? scene_->material_names()[pick_->material] : std::string(),
             .message = message_,
             .message_is_error = message_is_error_,
             .scale = window_.content_scale()},
            panel);
        ui_->end_frame();
        input.commands.insert(input.commands.end(), wishes.begin(), wishes.end());
        if (panel.options == state_.options() && panel.light_moves == state_.light_moves()) return;
        if (panel.options.samples != state_.options().samples) {
            presenter_.use_samples(*panel.options.samples);
        }
        state_.set(panel.options, panel.light_moves);
        stale_ = true;
    }

    /// The mouse in the picture. `input` has nothing of what it did in the panel.
    void follow_the_mouse(const Input& input) {
        const Options& options = state_.options();
        const Pointer::Picture picture{
            .width = static_cast<float>(extent_.width),
            .divider = options.split ? std::optional(options.divider) : std::nullopt,
            .scale = window_.content_scale()};
        const bool turned = pointer_.turns();
        const Pointer::Wishes wishes = pointer_.follow(input.mouse_action, input.cursor, picture);
        if (pointer_.turns() && !turned && panel_shown_) ui_->drop_focus();
        window_.hide_cursor(pointer_.turns());
        if (wishes.divider && *wishes.divider != options.divider) {
            Options moved = options;
            moved.divider = *wishes.divider;
            state_.set(moved, state_.light_moves());
            stale_ = true;
        }
        if (wishes.clicked && panel_shown_) pick(*wishes.clicked);
    }

    /// Reads a pixel, from now on whenever the picture changes.
    void pick(const glm::vec2& where) {
        const glm::uvec2 pixel(glm::max(where, glm::vec2(0.0f)));
        if (pixel.x >= extent_.width || pixel.y >= extent_.height) return;
        picked_ = pixel;
        read_pick();
        if (pick_) {
            fmt::print("{}\n", describe(*pick_, scene_->material_names()[pick_->material]));
            std::fflush(stdout);
        }
    }

    void read_pick() {
        pick_.reset();
        if (!picked_ || picked_->x >= extent_.width || picked_->y >= extent_.height) return;
        pick_ = picker_.pick(*scene_, state_.settings(), extent_, *picked_);
    }

    /// `input` is what the command came with.
    void obey(const Command& command, const Input& input) {
        switch (command.kind) {
            case CommandKind::toggle_panel:
                toggle_panel(input);
                break;
            case CommandKind::reload_shaders:
                reload_shaders();
                break;
            case CommandKind::save_picture:
                wanted_ = Shot::picture;
                unshown_ = true;
                break;
            case CommandKind::save_window:
                if (!presenter_.can_read_window()) {
                    report("no picture: the device cannot read what a window shows");
                    break;
                }
                wanted_ = Shot::window;
                unshown_ = true;
                break;
            case CommandKind::save_settings:
                save_settings();
                break;
            case CommandKind::copy_camera:
                window_.copy(camera_flags(state_.options()));
                tell(camera_flags(state_.options()), "copied camera and light");
                break;
            case CommandKind::end:
                ended_ = true;
                break;
            default:
                break;
        }
    }

    void toggle_panel(const Input& input) {
        if (!ui_) {
            ui_.emplace(window_.handle(), instance_, device_, presenter_.format(),
                        Presenter::kSlots, window_.content_scale());
        }
        panel_shown_ = !panel_shown_;
        unshown_ = true;
        unsettled_ = kFramesToSettle;
        if (!panel_shown_) return;
        // The picture may have changed while nobody read its numbers.
        read_pick();
        // What was clicked while it was hidden was not for it.
        ui_->begin_frame(input, false);
        ui_->end_frame();
        // So that the next frame to be drawn has something to draw.
        Input nothing{.buttons = input.buttons, .cursor = input.cursor};
        run_panel(nothing);
    }

    void save_settings() {
        Options options = state_.options();
        options.size = {extent_.width, extent_.height};
        try {
            const std::string name = new_file_name(".toml");
            write_config(name, options);
            tell(name, "saved " + name);
        } catch (const common::FileError& error) {
            report(error.what());
        }
    }

    void reload_shaders() {
        try {
            const CompiledShaders shaders = compile_shaders(sources_);
            presenter_.use_shaders(shaders.code());
            picker_.use_shaders(shaders.code());
            title_.set_error({});
            message_.clear();
            stale_ = true;
        } catch (const std::runtime_error& error) {
            // The folders would leave no room in the title.
            report(error.what(), (sources_ / "").string());
        }
    }

    /// Shows the scene anew when its file has changed; where that is broken the old scene stays.
    void follow_the_file() {
        if (seconds_since(last_look_) < kLookSeconds) return;
        last_look_ = Clock::now();
        if (!watch_.changed()) return;
        const std::filesystem::path& path = state_.options().scene;
        try {
            auto scene = std::make_unique<Scene>(
                reload_scene(device_, layouts_, path, texture_settings(state_.options(), device_)));
            presenter_.finish();
            scene_ = std::move(scene);
            pick_.reset();  // it names a material of the old scene
            state_.set_bounds(scene_->bounds());
            title_.set_error({});
            message_ = fmt::format("{} has changed: reloaded", path.filename().string());
            message_is_error_ = false;
            stale_ = true;
        } catch (const std::runtime_error& error) {
            report(error.what(), (path.parent_path() / "").string());
        }
    }

    /// False where nothing can be shown now.
    bool draw() {
        const FrameSettings settings = state_.settings();
        const WindowContents contents{*scene_, settings, stale_, panel_shown_ ? &*ui_ : nullptr};
        if (wanted_ == Shot::none) return presenter_.show(contents, extent_);
        const PictureBytes form{.srgb = state_.options().encoding == Encoding::srgb,
                                .straight_alpha = !settings.background};
        try {
            const auto picture = wanted_ == Shot::picture
                                     ? presenter_.show_and_read(contents, extent_, form)
                                     : presenter_.show_and_read_window(contents, extent_);
            if (!picture) return false;
            const std::string name = new_file_name(".png");
            write_image(name, picture->extent.width, picture->extent.height, picture->pixels,
                        wanted_ == Shot::picture ? PngContents{form.srgb, form.straight_alpha}
                                                 : PngContents{});
            tell(name, "saved " + name);
        } catch (const common::FileError& error) {
            report(error.what());
        }
        wanted_ = Shot::none;
        return true;
    }

    /// `line` on standard output, `message` in the panel.
    void tell(std::string_view line, std::string message) {
        fmt::print("{}\n", line);
        std::fflush(stdout);
        message_ = std::move(message);
        message_is_error_ = false;
    }

    /// An error on standard error and, without the folder, in the panel; with a folder in the
    /// title, too: it lasts until what is read from there is right again.
    void report(const std::string& error, const std::string& folder = {}) {
        fmt::print(stderr, "cw2: {}\n", error);
        message_ = error.starts_with(folder) ? error.substr(folder.size()) : error;
        message_is_error_ = true;
        if (!folder.empty()) title_.set_error(message_);
    }

    static bool same(VkExtent2D a, VkExtent2D b) {
        return a.width == b.width && a.height == b.height;
    }

    enum class Shot { none, picture, window };

    const std::filesystem::path& sources_;
    const Instance& instance_;
    const Device& device_;
    Window& window_;
    Layouts layouts_;
    FileWatch watch_;
    std::unique_ptr<Scene> scene_;
    std::optional<UiPass> ui_;  ///< from when the panel is first shown
    Presenter presenter_;       ///< destroyed before what its frames draw, for which it waits
    Picker picker_;
    ViewerState state_;
    Pointer pointer_;
    std::optional<glm::uvec2> picked_;  ///< the pixel whose numbers are read
    std::optional<Pick> pick_;          ///< none: it shows the background
    Title title_;
    std::string message_;
    bool message_is_error_ = false;
    VkExtent2D extent_{};  ///< of the window at the last step
    Clock::time_point last_step_ = Clock::now();
    Clock::time_point last_look_ = Clock::now();
    bool panel_shown_ = false;
    bool stale_ = true;    ///< the picture is not the one that should be seen
    bool unshown_ = true;  ///< the window does not show what it should
    Shot wanted_ = Shot::none;
    int unsettled_ = 0;  ///< frames of the panel until it shows what the last events did
    bool idle_ = false;  ///< nothing happens until something is done
    bool ended_ = false;
};

}  // namespace

int run_window(const Options& options, const std::filesystem::path& sources) {
    Window window(fmt::format("{} - cw2", options.scene.filename().string()), options.size.width,
                  options.size.height);
    const Instance instance(options.validation, window.instance_extensions());
    {
        const SurfaceHandle surface = window.make_surface(instance);
        const Device device(instance, options.device, surface.get());
        require_size(options, device);
        Session session(options, sources, instance, device, window, surface.get());
        window.show();
        session.run();
    }
    return instance.validation_messages() == 0 ? 0 : 1;
}

}  // namespace cw2
