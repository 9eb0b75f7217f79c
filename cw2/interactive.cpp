#include "cw2/interactive.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "cw2/image_file.h"
#include "cw2/presenter.h"
#include "cw2/scene.h"
#include "cw2/shader_compiler.h"
#include "cw2/viewer_state.h"
#include "cw2/window.h"
#include "mesh-format/io.h"

namespace cw2 {

namespace {

using Clock = std::chrono::steady_clock;

/// How often the title is written anew, and how long one waits where nothing happens.
constexpr double kTitleSeconds = 0.25;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

float aspect_of(VkExtent2D extent) {
    if (extent.width == 0 || extent.height == 0) return 1.0f;
    return static_cast<float>(extent.width) / static_cast<float>(extent.height);
}

/// The first of cw2-0001.png, cw2-0002.png ... that does not exist in the current folder.
std::string new_screenshot_name() {
    for (int number = 1;; ++number) {
        std::string name = fmt::format("cw2-{:04}.png", number);
        if (!std::filesystem::exists(std::filesystem::symlink_status(name))) return name;
    }
}

/// Writes the window's title: the scene, the view and the time of a frame, after an error if there
/// is one.
class Title {
 public:
    Title(Window& window, std::string scene) : window_(window), scene_(std::move(scene)) {}

    void set_error(std::string error) { error_ = std::move(error); }

    /// What is new shows at once, but the time every now and then only.
    void update(View view, std::optional<double> milliseconds) {
        std::string words = fmt::format("{} - {}", scene_, kViewNames[view]);
        if (!error_.empty()) words = error_ + " - " + words;
        if (words == words_ && seconds_since(written_) < kTitleSeconds) return;
        window_.set_title(milliseconds ? fmt::format("{} - {:.1f} ms", words, *milliseconds)
                                       : words);
        words_ = std::move(words);
        written_ = Clock::now();
    }

 private:
    Window& window_;
    std::string scene_;
    std::string error_;
    std::string words_;  ///< shown, but for the time
    Clock::time_point written_;
};

/// What happens while the window is open.
class Session {
 public:
    Session(const Options& options, const std::filesystem::path& sources, const Device& device,
            Window& window, Presenter& presenter, const Scene& scene)
        : sources_(sources),
          draws_always_(!device.is_cpu()),
          window_(window),
          presenter_(presenter),
          scene_(scene),
          state_(completed(options, scene.start()), scene.bounds(), aspect_of(window.extent())),
          title_(window, options.scene.filename().string()) {}

    void run() {
        while (!ended_ && !window_.closed()) step();
    }

 private:
    void step() {
        const Input input = window_.poll(idle_ ? kTitleSeconds : 0.0);
        for (const Command& command : input.commands) obey(command);
        const VkExtent2D extent = window_.extent();
        const Clock::time_point now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - last_step_).count();
        last_step_ = now;
        stale_ |= state_.apply(input, seconds, aspect_of(extent)) || input.exposed ||
                  extent.width != extent_.width || extent.height != extent_.height;
        extent_ = extent;
        // A CPU has better things to do than to draw the same again.
        const bool drawn = (stale_ || draws_always_) && draw();
        if (drawn) {
            stale_ = false;
        } else {
            presenter_.finish();
        }
        idle_ = !drawn;
        title_.update(state_.settings().view, presenter_.gpu_milliseconds());
    }

    void obey(const Command& command) {
        switch (command.kind) {
            case CommandKind::reload_shaders:
                reload_shaders();
                break;
            case CommandKind::save_screenshot:
                if (!presenter_.can_read()) {
                    report("no screenshot: the device cannot read what a window shows");
                    break;
                }
                screenshot_wanted_ = true;
                stale_ = true;
                break;
            case CommandKind::end:
                ended_ = true;
                break;
            default:
                break;
        }
    }

    void reload_shaders() {
        try {
            presenter_.use_shaders(compile_shaders(sources_).code());
            title_.set_error({});
            stale_ = true;
        } catch (const std::runtime_error& error) {
            report(error.what());
            // The folders would leave no room in the title.
            std::string text = error.what();
            const std::string folder = (sources_ / "").string();
            if (text.starts_with(folder)) text.erase(0, folder.size());
            title_.set_error(std::move(text));
        }
    }

    /// False where nothing can be shown now.
    bool draw() {
        if (!screenshot_wanted_) return presenter_.show(scene_, state_.settings(), extent_);
        try {
            const auto picture = presenter_.show_and_read(scene_, state_.settings(), extent_);
            if (!picture) return false;
            const std::string name = new_screenshot_name();
            write_image(name, picture->extent.width, picture->extent.height, picture->pixels);
            fmt::print("{}\n", name);
            std::fflush(stdout);
        } catch (const mesh_format::FileError& error) {
            report(error.what());
        }
        screenshot_wanted_ = false;
        return true;
    }

    static void report(std::string_view error) { fmt::print(stderr, "cw2: {}\n", error); }

    const std::filesystem::path& sources_;
    bool draws_always_;
    Window& window_;
    Presenter& presenter_;
    const Scene& scene_;
    ViewerState state_;
    Title title_;
    VkExtent2D extent_{};  ///< of the window at the last step
    Clock::time_point last_step_ = Clock::now();
    bool stale_ = true;  ///< the picture is not the one that should be seen
    bool screenshot_wanted_ = false;
    bool idle_ = false;  ///< nothing was drawn in the last step
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
        const Layouts layouts(device);
        const Scene scene =
            load_scene(device, layouts, options.scene, texture_settings(options, device));
        const std::uint32_t samples = options.samples.value_or(device.is_cpu() ? 1 : 4);
        Presenter presenter(device, surface.get(), layouts, built_in_shaders(),
                            static_cast<VkSampleCountFlagBits>(samples));
        Session session(options, sources, device, window, presenter, scene);
        window.show();
        session.run();
    }
    return instance.validation_messages() == 0 ? 0 : 1;
}

}  // namespace cw2
