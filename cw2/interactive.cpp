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
#include "cw2/window/file_list.h"
#include "cw2/window/file_watch.h"
#include "cw2/window/message.h"
#include "cw2/window/overlay.h"
#include "cw2/window/panel.h"
#include "cw2/window/pointer.h"
#include "cw2/window/presenter.h"
#include "cw2/window/steering.h"
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
/// For how long a message, or an error, lies over the picture.
constexpr std::chrono::seconds kMessageTime{6};
constexpr std::chrono::seconds kErrorTime{15};
constexpr std::string_view kHint = "Tab panel, H keys, drop a file";
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
          asked_(options),
          files_(options.files.empty() ? std::vector{options.scene} : options.files),
          watch_(options.scene),
          scene_(std::make_unique<Scene>(
              load_scene(device, layouts_, options.scene, texture_settings(options, device)))),
          presenter_(device, surface, layouts_, built_in_shaders(),
                     options.samples.value_or(kSamples)),
          picker_(device, layouts_, built_in_shaders()),
          state_(completed(options, scene_->start(), scene_->bounds()), scene_->bounds(),
                 aspect_of(window.extent())),
          title_(window) {
        title_.set_scene(options.scene.filename().string(), files_.place());
    }

    void run() {
        while (!ended_ && !window_.closed()) step();
    }

 private:
    void step() {
        Input input = window_.poll(idle_ ? kIdleSeconds : 0.0);
        follow_the_file();
        const bool extent_changed = !same(extent_, window_.extent());
        extent_ = window_.extent();
        const bool showed = shows_ui();
        if (showed) run_ui(input);
        follow_the_mouse(input);
        if (!input.dropped.empty()) {
            files_.insert(input.dropped);
            open_file();
        }
        for (const Command& command : input.commands) obey(command);
        if (!input.commands.empty()) hint_until_ = {};
        const Clock::time_point now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - last_step_).count();
        last_step_ = now;
        stale_ |= state_.apply(input, seconds, aspect_of(extent_)) || extent_changed;
        unshown_ |= input.exposed;
        // The panel shows what a frame takes without waiting for pipelines.
        stale_ |= panel_shown_ && presenter_.times_are_cold();
        if (shows_ui() && (!showed || ui_is_old_)) run_ui_anew(input, showed);
        unshown_ |= showed && !shows_ui();
        const bool drawn = (stale_ || unshown_ || shows_ui() || presenter_.refines()) && draw();
        if (drawn) {
            if (stale_ && panel_shown_) read_pick();
            if (!has_drawn_) hint_until_ = now + kMessageTime;
            has_drawn_ = true;
            stale_ = false;
            unshown_ = false;
        } else {
            presenter_.finish();
        }
        unsettled_ = input.anything ? kFramesToSettle : std::max(unsettled_ - 1, 0);
        idle_ = !drawn || (shows_ui() && !state_.light_moves() && !presenter_.refines() &&
                           input.direction == glm::vec3(0.0f) && unsettled_ == 0);
        title_.update(state_.settings(), presenter_.times().gpu);
    }

    /// What lies over the picture where there is no panel.
    std::string line() const {
        if (panel_shown_ || wanted_ == Shot::window) return {};
        if (message_.passes()) return message_.words;
        return Clock::now() < hint_until_ ? std::string(kHint) : std::string();
    }

    bool shows_ui() const {
        return panel_shown_ || help_shown_ || path_field_.is_open() || !line().empty();
    }

    /// Shows what lies over the picture, lets it change the state, and takes out of `input` what
    /// was for it.
    void run_ui(Input& input) {
        if (!ui_) {
            ui_.emplace(window_.handle(), instance_, device_, presenter_.format(),
                        Presenter::kSlots, window_.content_scale());
        }
        ui_is_old_ = false;
        ui_->begin_frame(input, pointer_.grip() == Pointer::Grip::nothing);
        if (ui_->wants_mouse()) {
            if (input.mouse_action && input.mouse_action->pressed) input.mouse_action.reset();
            input.wheel = 0.0f;
        }
        const bool has_focus = ui_->wants_keys();
        if (has_focus) input.direction = {};
        const bool types = ui_->wants_text() || path_field_.is_open();
        std::erase_if(input.commands, [&](Command& command) {
            if (types) {
                return command.kind != CommandKind::save_picture &&
                       command.kind != CommandKind::save_window;
            }
            if (command.kind != CommandKind::save_settings_in_panel) return false;
            command.kind = CommandKind::save_settings;
            return !has_focus;
        });
        if (panel_shown_) run_panel(input);
        const float scale = window_.content_scale();
        if (const auto path = path_field_.draw(scale)) {
            files_.insert({*path});
            open_file();
        }
        if (help_shown_) {
            draw_help(scale);
        } else if (const std::string words = line(); !words.empty()) {
            draw_line(words, message_.passes() && message_.is_error, scale);
        }
        ui_->end_frame();
    }

    /// So that the next frame to be drawn has something to draw.
    void run_ui_anew(const Input& input, bool showed) {
        Input nothing{.buttons = input.buttons, .cursor = input.cursor};
        if (ui_ && !showed) {
            // What was clicked while it was hidden was not for it.
            ui_->begin_frame(nothing, false);
            ui_->end_frame();
        }
        unsettled_ = kFramesToSettle;
        run_ui(nothing);
    }

    void run_panel(Input& input) {
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
             .message = message_.words,
             .message_is_error = message_.is_error,
             .scale = window_.content_scale()},
            panel);
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
        const Pointer::Grip before = pointer_.grip();
        const Pointer::Wishes wishes = pointer_.follow(input.mouse_action, input.cursor, picture);
        if (pointer_.grip() != before && ui_) ui_->drop_focus();
        window_.hide_cursor(pointer_.grip() == Pointer::Grip::look);
        const glm::vec2 extent(extent_.width, extent_.height);
        const auto surface_at = [this](const glm::vec2& where) { return surface(where); };
        if (wishes.divider && *wishes.divider != options.divider) {
            Options moved = options;
            moved.divider = *wishes.divider;
            state_.set(moved, state_.light_moves());
            stale_ = true;
        }
        if (wishes.grip != Pointer::Grip::nothing) {
            drag(state_, wishes.grip, wishes.drag, extent);
            stale_ = true;
        }
        if (input.wheel != 0.0f) {
            wheel_.turn(state_, input.wheel, input.wheel_at, extent, surface_at);
            stale_ = true;
        }
        if (wishes.clicked) pick(*wishes.clicked);
        if (wishes.double_clicked) look_at(*wishes.double_clicked);
    }

    std::optional<Pick> pick_at(const glm::vec2& where) {
        const glm::uvec2 pixel(glm::max(where, glm::vec2(0.0f)));
        if (pixel.x >= extent_.width || pixel.y >= extent_.height) return std::nullopt;
        return picker_.pick(*scene_, state_.settings(), extent_, pixel);
    }

    std::optional<glm::vec3> surface(const glm::vec2& where) {
        const std::optional<Pick> there = pick_at(where);
        if (!there) return std::nullopt;
        return from_user(there->position, state_.bounds());
    }

    void look_at(const glm::vec2& where) {
        const std::optional<glm::vec3> point = surface(where);
        if (!point) return;
        Camera camera = state_.camera();
        camera.target = *point;
        state_.set_camera(camera);
        stale_ = true;
    }

    /// Reads a pixel, from now on whenever the picture changes.
    void pick(const glm::vec2& where) {
        pick_ = pick_at(where);
        picked_ = glm::uvec2(glm::max(where, glm::vec2(0.0f)));
        if (!pick_) return;
        picked_material_ = pick_->material;
        const std::string& material = scene_->material_names()[pick_->material];
        const std::string some =
            fmt::format("{}: roughness {:.3g}, metalness {:.3g}; Tab shows all of it", material,
                        pick_->roughness, pick_->metalness);
        tell(describe(*pick_, material), panel_shown_ ? std::string() : some);
    }

    void frame_material() {
        if (!picked_material_) return say("click what shall be framed first", false);
        const std::vector<glm::vec3> positions = scene_->positions_of(*picked_material_);
        glm::vec3 low = positions.front(), high = low;
        for (const glm::vec3& position : positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        state_.frame(positions, 0.5f * (low + high), aspect_of(extent_));
        stale_ = true;
    }

    void read_pick() {
        pick_.reset();
        if (!picked_ || picked_->x >= extent_.width || picked_->y >= extent_.height) return;
        pick_ = picker_.pick(*scene_, state_.settings(), extent_, *picked_);
    }

    void obey(const Command& command) {
        switch (command.kind) {
            case CommandKind::toggle_panel:
                panel_shown_ = !panel_shown_;
                unshown_ = ui_is_old_ = true;
                // The picture may have changed while nobody read its numbers.
                if (panel_shown_) read_pick();
                break;
            case CommandKind::toggle_help:
                help_shown_ = !help_shown_;
                unshown_ = ui_is_old_ = true;
                break;
            case CommandKind::frame_material:
                frame_material();
                break;
            case CommandKind::open:
                path_field_.open();
                ui_is_old_ = true;
                break;
            case CommandKind::next_file:
            case CommandKind::previous_file:
                files_.go(command.kind == CommandKind::next_file ? 1 : -1);
                open_file();
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
                unshown_ = ui_is_old_ = true;
                break;
            case CommandKind::save_settings:
                save_settings();
                break;
            case CommandKind::copy_camera:
                window_.copy(camera_flags(state_.options()));
                tell(camera_flags(state_.options()), "copied camera and light");
                break;
            case CommandKind::end:
                ended_ = !help_shown_;
                help_shown_ = false;
                unshown_ = ui_is_old_ = true;
                break;
            default:
                break;
        }
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
            message_ = {};
            stale_ = true;
        } catch (const std::runtime_error& error) {
            // The folders would leave no room in the title.
            report(error.what(), (sources_ / "").string());
        }
    }

    /// Opens the current file of the list; where that cannot be done the old picture stays.
    void open_file() {
        const std::filesystem::path& path = files_.current();
        // What is set stays, but for camera and light, which begin as at the start.
        Options options = state_.options();
        options.scene = path;
        options.camera_position = asked_.camera_position;
        options.camera_target = asked_.camera_target;
        options.vertical_fov = asked_.vertical_fov;
        options.light_position = asked_.light_position;
        options.light_color = asked_.light_color;
        try {
            FileWatch watch(path);
            auto scene = std::make_unique<Scene>(
                load_scene(device_, layouts_, path, texture_settings(options, device_)));
            ViewerState state(completed(options, scene->start(), scene->bounds()), scene->bounds(),
                              aspect_of(extent_));
            state.set(state.options(), state_.light_moves());
            presenter_.finish();
            scene_ = std::move(scene);
            state_ = std::move(state);
            watch_ = std::move(watch);
            picked_.reset();
            pick_.reset();
            picked_material_.reset();
            title_.set_scene(path.filename().string(), files_.place());
            title_.set_error({});
            say("opened " + path.string(), false);
            stale_ = true;
        } catch (const std::runtime_error& error) {
            report(error.what());
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
            picked_material_.reset();
            state_.set_bounds(scene_->bounds());
            title_.set_error({});
            say(fmt::format("{} has changed: reloaded", path.filename().string()), false);
            stale_ = true;
        } catch (const std::runtime_error& error) {
            report(error.what(), (path.parent_path() / "").string());
        }
    }

    /// False where nothing can be shown now.
    bool draw() {
        const FrameSettings settings = state_.settings();
        const WindowContents contents{*scene_, settings, stale_, shows_ui() ? &*ui_ : nullptr};
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

    /// `line` on standard output, `message` in the panel or over the picture.
    void tell(std::string_view line, const std::string& message) {
        fmt::print("{}\n", line);
        std::fflush(stdout);
        say(message, false);
    }

    /// An error on standard error and, without the folder, in the window; with a folder in the
    /// title, too: it lasts until what is read from there is right again.
    void report(const std::string& error, const std::string& folder = {}) {
        fmt::print(stderr, "cw2: {}\n", error);
        say(error.starts_with(folder) ? error.substr(folder.size()) : error, true);
        if (!folder.empty()) title_.set_error(message_.words);
    }

    void say(const std::string& words, bool is_error) {
        message_ = {words, is_error, Clock::now() + (is_error ? kErrorTime : kMessageTime)};
        ui_is_old_ = true;
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
    Options asked_;  ///< at the start
    FileList files_;
    FileWatch watch_;
    std::unique_ptr<Scene> scene_;
    std::optional<UiPass> ui_;  ///< from when something of it is first shown
    Presenter presenter_;       ///< destroyed before what its frames draw, for which it waits
    Picker picker_;
    ViewerState state_;
    Pointer pointer_;
    Wheel wheel_;
    PathField path_field_;
    std::optional<glm::uvec2> picked_;              ///< the pixel whose numbers are read
    std::optional<Pick> pick_;                      ///< none: it shows the background
    std::optional<std::uint32_t> picked_material_;  ///< of the latest click on a surface
    Title title_;
    Message message_;
    Clock::time_point hint_until_{};
    VkExtent2D extent_{};  ///< of the window at the last step
    Clock::time_point last_step_ = Clock::now();
    Clock::time_point last_look_ = Clock::now();
    bool panel_shown_ = false;
    bool help_shown_ = false;
    bool ui_is_old_ = false;  ///< what lies over the picture is not what should
    bool has_drawn_ = false;  ///< there was a picture
    bool stale_ = true;       ///< the picture is not the one that should be seen
    bool unshown_ = true;     ///< the window does not show what it should
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
