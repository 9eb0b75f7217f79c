#include "cw2/interactive.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <glm/common.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/io.h"
#include "cw2/options/frame_of.h"
#include "cw2/render/image_file.h"
#include "cw2/render/scene.h"
#include "cw2/render/shader_compiler.h"
#include "cw2/scene_opening.h"
#include "cw2/source_bake.h"
#include "cw2/window/file_list.h"
#include "cw2/window/file_watch.h"
#include "cw2/window/panel.h"
#include "cw2/window/pixel_reader.h"
#include "cw2/window/pointer.h"
#include "cw2/window/presenter.h"
#include "cw2/window/steering.h"
#include "cw2/window/title.h"
#include "cw2/window/ui.h"
#include "cw2/window/viewer_state.h"
#include "cw2/window/window.h"

namespace cw2 {

namespace {

using Clock = std::chrono::steady_clock;

/// How long one waits for an event where nothing happens.
constexpr double kIdleSeconds = 0.25;
/// How often one looks whether the scene's file has changed.
constexpr double kLookSeconds = 0.5;
/// How often one asks how far a bake is.
constexpr double kBakeSeconds = 0.05;

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
          device_(device),
          window_(window),
          layouts_(device),
          asked_(options),
          files_(options.files.empty() ? std::vector{options.scene} : options.files),
          watch_({options.scene}),
          scene_(first_scene()),
          presenter_(device, surface, layouts_, built_in_shaders(),
                     options.samples.value_or(kSamples)),
          ui_(window, instance, device, presenter_.format(), Presenter::kSlots),
          reader_(device, layouts_, built_in_shaders()),
          state_(completed(options, scene_->start(), scene_->bounds()), scene_->bounds(),
                 aspect_of(window.extent())),
          title_(window) {
        title_.set_scene(options.scene.filename().string(), files_.place());
    }

    void run() {
        while (!ended_ && !window_.closed()) step();
        window_.hide();  // what is being loaded may take a while to end
    }

 private:
    void step() {
        Input input = window_.poll(!idle_ ? 0.0 : opening_ ? kBakeSeconds : kIdleSeconds);
        follow_the_file();
        if (opening_) go_on_opening();
        const bool extent_changed = !same(extent_, window_.extent());
        extent_ = window_.extent();
        const bool showed = ui_.shows();
        const Ui::Panel panel = [this](Input& of_panel) { run_panel(of_panel); };
        if (showed) {
            const bool has_mouse = pointer_.grip() == Pointer::Grip::nothing;
            if (const auto path = ui_.run(input, has_mouse, panel)) open_files({*path});
        }
        follow_the_mouse(input);
        if (!input.dropped.empty()) open_files(input.dropped);
        for (const Command& command : input.commands) obey(command);
        if (!input.commands.empty()) ui_.end_hint();
        const Clock::time_point now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - last_step_).count();
        last_step_ = now;
        stale_ |= state_.apply(input, seconds, aspect_of(extent_)) || extent_changed;
        unshown_ |= input.exposed;
        // The panel shows what a frame takes without waiting for pipelines.
        stale_ |= ui_.shows_panel() && presenter_.times_are_cold();
        ui_.refresh(input, showed, panel);
        unshown_ |= showed && !ui_.shows();
        const bool drawn = (stale_ || unshown_ || ui_.shows() || presenter_.refines()) && draw();
        if (drawn) {
            if (stale_ && ui_.shows_panel()) reader_.read(*scene_, state_, extent_);
            if (!has_drawn_) ui_.begin_hint();
            has_drawn_ = true;
            stale_ = false;
            unshown_ = false;
        } else {
            presenter_.finish();
        }
        idle_ = !drawn || (ui_.shows() && !ui_.unsettled() && !state_.light_moves() &&
                           !presenter_.refines() && input.direction == glm::vec3(0.0f));
        title_.update(state_.settings(), presenter_.times().gpu);
    }

    void run_panel(Input& input) {
        PanelState panel{state_.options(), state_.light_moves()};
        const std::vector<Command> wishes =
            draw_panel({.device = device_.properties().deviceName,
                        .bounds = scene_->bounds(),
                        .extent = extent_,
                        .times = presenter_.times(),
                        .counts = presenter_.counts(),
                        .triangles = scene_->triangle_count() * (state_.options().split ? 2 : 1),
                        .scene_bytes = scene_->memory_bytes(),
                        .image_bytes = presenter_.memory_bytes(),
                        .pick = reader_.pick(),
                        .picked_material = material_name(),
                        .message = ui_.message().words,
                        .message_is_error = ui_.message().is_error,
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
        if (pointer_.grip() != before) ui_.drop_focus();
        window_.hide_cursor(pointer_.grip() == Pointer::Grip::look);
        const glm::vec2 extent(extent_.width, extent_.height);
        const auto surface_at = [this](const glm::vec2& where) {
            return reader_.surface(*scene_, state_, extent_, where);
        };
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
        const auto point =
            wishes.double_clicked ? surface_at(*wishes.double_clicked) : std::nullopt;
        if (point) {
            Camera camera = state_.camera();
            camera.target = *point;
            state_.set_camera(camera);
            stale_ = true;
        }
    }

    std::string material_name() const {
        return reader_.pick() ? scene_->material_names()[reader_.pick()->material] : std::string();
    }

    /// Reads a pixel, from now on whenever the picture changes.
    void pick(const glm::vec2& where) {
        reader_.choose(*scene_, state_, extent_, where);
        if (!reader_.pick()) return;
        const std::string some =
            fmt::format("{}: roughness {:.3g}, metalness {:.3g}; Tab shows all of it",
                        material_name(), reader_.pick()->roughness, reader_.pick()->metalness);
        tell(describe(*reader_.pick(), material_name()), ui_.shows_panel() ? std::string() : some);
    }

    void frame_material() {
        if (!reader_.material()) return ui_.say("click what shall be framed first", false);
        const std::vector<glm::vec3> positions = scene_->positions_of(*reader_.material());
        glm::vec3 low = positions.front(), high = low;
        for (const glm::vec3& position : positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        state_.frame(positions, 0.5f * (low + high), aspect_of(extent_));
        stale_ = true;
    }

    void obey(const Command& command) {
        switch (command.kind) {
            case CommandKind::toggle_panel:
                ui_.toggle_panel();
                unshown_ = true;
                // The picture may have changed while nobody read its numbers.
                if (ui_.shows_panel()) reader_.read(*scene_, state_, extent_);
                break;
            case CommandKind::toggle_help:
                ui_.toggle_help();
                unshown_ = true;
                break;
            case CommandKind::frame_material:
                frame_material();
                break;
            case CommandKind::open:
                ui_.ask_for_path();
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
                ui_.hide_line(true);
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
                ended_ = !ui_.close_help();
                unshown_ = true;
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
            reader_.use_shaders(shaders.code());
            title_.set_error({});
            ui_.say({}, false);
            stale_ = true;
        } catch (const DeviceLost&) {
            throw;
        } catch (const std::runtime_error& error) {
            // The folders would leave no room in the title.
            report(error.what(), (sources_ / "").string());
        }
    }

    /// Opens the first of these, which come behind the one that is shown.
    void open_files(const std::vector<std::filesystem::path>& paths) {
        files_.insert(paths);
        open_file();
    }

    /// What shall take the place of what is shown.
    struct Wish {
        std::filesystem::path scene;
        bool is_reload;  ///< of what is shown; camera and light stay
    };

    std::unique_ptr<Scene> first_scene() {
        const auto bake = bake_of(asked_, device_, tell_user);
        if (bake) {
            wait_for(*bake);
            watch_ = FileWatch(bake->sources(), bake->read_at());
        }
        return std::make_unique<Scene>(
            make_scene(device_, layouts_, load_scene_file(bake ? bake->baked() : asked_.scene),
                       texture_settings(asked_, device_)));
    }

    /// Opens the current file of the list.
    void open_file() { begin_opening({files_.current(), false}); }

    /// The options with which a scene is shown: what is set stays, but for camera and light, which
    /// begin as at the start.
    Options options_for(const Wish& wish) const {
        Options options = state_.options();
        options.scene = wish.scene;
        if (wish.is_reload) return options;
        options.camera_position = asked_.camera_position;
        options.camera_target = asked_.camera_target;
        options.vertical_fov = asked_.vertical_fov;
        options.light_position = asked_.light_position;
        options.light_color = asked_.light_color;
        return options;
    }

    /// Shows the scene anew when its file, or one that it was made of, has changed.
    void follow_the_file() {
        if (seconds_since(last_look_) < kLookSeconds) return;
        last_look_ = Clock::now();
        if (!opening_ && watch_.changed()) begin_opening({state_.options().scene, true});
    }

    /// Where something cannot be opened the old scene stays, but a lost device is the end.
    void begin_opening(Wish wish) {
        if (opening_ && opening_->loads()) {
            next_ = std::move(wish);  // nobody waits here for what a thread is loading
            return;
        }
        wish_ = std::move(wish);
        try {
            opening_.emplace(device_, layouts_, options_for(wish_));
        } catch (const std::runtime_error& error) {
            return refuse(error.what());
        }
        go_on_opening();
    }

    void go_on_opening() {
        try {
            std::unique_ptr<Scene> scene = opening_->take();
            if (!scene) {
                const std::string progress = opening_->progress();
                if (progress.empty()) return;
                ui_.say(progress, false);
                unshown_ = true;
                return;
            }
            show_opened(std::move(scene));
            opening_.reset();
            title_.set_error({});
            stale_ = true;
        } catch (const DeviceLost&) {
            throw;
        } catch (const std::runtime_error& error) {
            refuse(error.what());
        }
        if (next_) begin_opening(*std::exchange(next_, std::nullopt));
    }

    void show_opened(std::unique_ptr<Scene> scene) {
        presenter_.finish();
        scene_ = std::move(scene);
        watch_ = opening_->watch();
        reader_.forget(wish_.is_reload);
        if (wish_.is_reload) {
            state_.set_bounds(scene_->bounds());
            say_opened(wish_.scene.filename().string() + " has changed: reloaded");
            return;
        }
        ViewerState state(completed(options_for(wish_), scene_->start(), scene_->bounds()),
                          scene_->bounds(), aspect_of(extent_));
        state.set(state.options(), state_.light_moves());
        state_ = std::move(state);
        title_.set_scene(wish_.scene.filename().string(), files_.place());
        say_opened("opened " + wish_.scene.string());
    }

    void say_opened(const std::string& what) {
        const std::string& warning = opening_->warning();
        ui_.say(warning.empty() ? what : what + "; " + warning, false);
    }

    void refuse(const std::string& error) {
        opening_.reset();
        if (!wish_.is_reload) return report(error);
        report(error, (wish_.scene.parent_path() / "").string());
    }

    /// False where nothing can be shown now.
    bool draw() {
        const FrameSettings settings = state_.settings();
        const WindowContents contents{*scene_, settings, stale_, ui_.pass()};
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
        ui_.hide_line(false);
        return true;
    }

    /// `line` on standard output, `message` in the panel or over the picture.
    void tell(std::string_view line, const std::string& message) {
        try {
            common::print(fmt::format("{}\n", line));
            ui_.say(message, false);
        } catch (const common::FileError& error) {
            report(error.what());
        }
    }

    /// An error on standard error and, without the folder, in the window; with a folder in the
    /// title, too: it lasts until what is read from there is right again.
    void report(const std::string& error, const std::optional<std::string>& folder = {}) {
        fmt::print(stderr, "cw2: {}\n", error);
        const bool begins_with_it = folder && error.starts_with(*folder);
        ui_.say(begins_with_it ? error.substr(folder->size()) : error, true);
        if (folder) title_.set_error(ui_.message().words);
    }

    static bool same(VkExtent2D a, VkExtent2D b) {
        return a.width == b.width && a.height == b.height;
    }

    enum class Shot { none, picture, window };

    const std::filesystem::path& sources_;
    const Device& device_;
    Window& window_;
    Layouts layouts_;
    Options asked_;  ///< at the start
    FileList files_;
    FileWatch watch_;
    std::unique_ptr<Scene> scene_;
    Presenter presenter_;
    Ui ui_;
    PixelReader reader_;
    ViewerState state_;
    Pointer pointer_;
    Wheel wheel_;
    Title title_;
    VkExtent2D extent_{};  ///< of the window at the last step
    Clock::time_point last_step_ = Clock::now();
    Clock::time_point last_look_ = Clock::now();
    bool has_drawn_ = false;  ///< there was a picture
    bool stale_ = true;       ///< the picture is not the one that should be seen
    bool unshown_ = true;     ///< the window does not show what it should
    Shot wanted_ = Shot::none;
    bool idle_ = false;  ///< nothing happens until something is done
    Wish wish_{};        ///< what is opened
    std::optional<SceneOpening> opening_;
    std::optional<Wish> next_;  ///< opened after it
    bool ended_ = false;
};

}  // namespace

int run_window(const Options& options, const std::filesystem::path& sources) {
#ifdef __GLIBC__
    // What a CPU device's images of the window's size leave behind goes back to the system: by
    // itself glibc soon takes such blocks from its heap, where those of other sizes leave gaps.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
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
