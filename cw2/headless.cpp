#include "cw2/headless.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "common/io.h"
#include "common/quoted_text.h"
#include "cw2/options/frame_of.h"
#include "cw2/render/image_file.h"
#include "cw2/render/legend.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/renderer.h"
#include "cw2/render/scene.h"
#include "cw2/vulkan/resources.h"

namespace cw2 {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// An image to render into, a buffer to read it back, and the commands that do both.
class OffscreenTarget {
 public:
    OffscreenTarget(const Device& device, VkExtent2D extent, ImageKind kind)
        : device_(device),
          extent_(extent),
          image_(make_image(device, {.format = format_of(kind),
                                     .extent = extent,
                                     .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                              VK_IMAGE_USAGE_TRANSFER_SRC_BIT})),
          pixels_(make_buffer(device,
                              VkDeviceSize{extent.width} * extent.height * pixel_bytes(kind),
                              VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback)),
          pool_(make_command_pool(device)),
          commands_(allocate_commands(device, pool_.get())) {}

    static VkFormat format_of(ImageKind kind) {
        return kind == ImageKind::png ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R32G32B32A32_SFLOAT;
    }

    /// Renders one frame and waits for it.
    void render(Renderer& renderer, const Scene& scene, const FrameSettings& settings) {
        begin_commands(commands_);
        renderer.record(commands_, 0, scene,
                        {.image = image_.handle.get(),
                         .view = image_.view.get(),
                         .extent = extent_,
                         .available_at = VK_PIPELINE_STAGE_2_COPY_BIT,
                         .after = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                   VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT}},
                        settings);
        read_back(commands_, image_.handle.get(), extent_, pixels_);
        submit_and_wait(device_, commands_);
    }

    std::span<const std::byte> pixels() const { return pixels_.mapped; }

 private:
    const Device& device_;
    VkExtent2D extent_;
    Image image_;
    Buffer pixels_;
    CommandPool pool_;
    VkCommandBuffer commands_;
};

struct Timings {
    double load = 0.0;         ///< file to device, milliseconds
    double first_frame = 0.0;  ///< pipelines, frame, read-back
    double save = 0.0;
    std::vector<double> frames;      ///< of --bench, wall clock
    std::vector<double> gpu_frames;  ///< of --bench, device time
};

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::string stats_of(const Device& device, const Scene& scene, const Timings& timings) {
    return fmt::format(
        "{{\n  \"device\": {},\n  \"triangles\": {},\n  \"draws\": {},\n"
        "  \"load_ms\": {:.3f},\n  \"first_frame_ms\": {:.3f},\n  \"save_ms\": {:.3f},\n"
        "  \"bench_frames\": {},\n  \"median_frame_ms\": {:.3f},\n"
        "  \"median_gpu_ms\": {:.3f}\n}}\n",
        common::quoted_text(device.properties().deviceName), scene.triangle_count(),
        scene.draws().size(), timings.load, timings.first_frame, timings.save,
        timings.frames.size(), median(timings.frames), median(timings.gpu_frames));
}

/// Saves pictures on a thread of its own, while the next one is drawn.
class Saver {
 public:
    explicit Saver(const PictureSize& size) : size_(size) {}

    /// Throws what the saving of the picture before has thrown.
    void save(std::filesystem::path path, std::span<const std::byte> pixels,
              const FrameSettings& settings) {
        finish();
        pixels_.assign(pixels.begin(), pixels.end());
        pending_ = std::async(std::launch::async, [this, settings, path = std::move(path)] {
            draw_legends(pixels_, size_.width, size_.height, settings);
            write_image(path, size_.width, size_.height, pixels_);
        });
    }
    void finish() {
        if (pending_.valid()) pending_.get();
    }

 private:
    PictureSize size_;
    std::vector<std::byte> pixels_;
    std::future<void> pending_;  ///< destroyed first, which waits
};

/// How far a run of frames has come, as a line that a terminal shows and overwrites.
class Progress {
 public:
    explicit Progress(std::uint32_t count) : count_(count), is_shown_(::isatty(STDERR_FILENO)) {}
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::uint32_t done) const {
        if (!is_shown_) return;
        constexpr std::uint32_t kCells = 30;
        const auto cells = static_cast<int>(std::uint64_t{kCells} * done / count_);
        fmt::print(stderr, "\r[{:#>{}}{:.>{}}] {}/{}, {:.1f} a second\x1b[K", "", cells, "",
                   static_cast<int>(kCells) - cells, done, count_,
                   1000.0 * done / milliseconds_since(start_));
    }
    void clear() const {
        if (is_shown_) fmt::print(stderr, "\r\x1b[K");
    }
    double milliseconds() const { return milliseconds_since(start_); }

 private:
    std::uint32_t count_;
    bool is_shown_;
    Clock::time_point start_ = Clock::now();
};

std::filesystem::path file_of(const Options& options, std::uint32_t frame) {
    if (!options.frames) return *options.output;
    return frame_name(options.output->string(), frame).value_or(options.output->string());
}

/// A scene on its device, and what draws it into files.
struct Studio {
    const Options& options;
    const Scene& scene;
    Renderer& renderer;
    OffscreenTarget& target;
    Timings& timings;

    void draw_picture(const FrameSettings& settings) {
        Clock::time_point start = Clock::now();
        target.render(renderer, scene, settings);
        timings.first_frame = milliseconds_since(start);
        start = Clock::now();
        Saver saver(options.size);
        saver.save(*options.output, target.pixels(), settings);
        saver.finish();
        timings.save = milliseconds_since(start);
    }

    void draw_turn(const FrameSettings& settings) {
        const FrameRange& range = *options.frames;
        Saver saver(options.size);
        const Progress progress(range.size());
        for (std::uint32_t frame = range.first; frame <= range.last; ++frame) {
            const FrameSettings now = at_frame(settings, options.orbit.value_or(Orbit::camera),
                                               frame, range.count, scene.bounds());
            const Clock::time_point start = Clock::now();
            target.render(renderer, scene, now);
            if (frame == range.first) timings.first_frame = milliseconds_since(start);
            saver.save(file_of(options, frame), target.pixels(), now);
            progress.show(frame - range.first + 1);
        }
        saver.finish();
        progress.clear();
        fmt::print("{} frames in {:.1f} s, {:.2f} a second\n", range.size(),
                   1e-3 * progress.milliseconds(), 1e3 * range.size() / progress.milliseconds());
    }

    void measure(const FrameSettings& settings) {
        for (std::uint32_t i = 0; i < options.bench_frames; ++i) {
            const Clock::time_point start = Clock::now();
            target.render(renderer, scene, settings);
            timings.frames.push_back(milliseconds_since(start));
            timings.gpu_frames.push_back(renderer.gpu_milliseconds(0).value_or(0.0));
        }
        fmt::print("{} frames of {}x{}: median {:.2f} ms, device {:.2f} ms\n", options.bench_frames,
                   options.size.width, options.size.height, median(timings.frames),
                   median(timings.gpu_frames));
    }
};

/// What a file of this kind shows at the options' instant.
FrameSettings settings_for(ImageKind kind, const Options& options, const Scene& scene) {
    const float aspect =
        static_cast<float>(options.size.width) / static_cast<float>(options.size.height);
    FrameSettings settings =
        frame_settings(completed(options, scene.start(), scene.bounds()), scene.bounds(), aspect);
    if (kind == ImageKind::exr) {
        // It holds the values themselves.
        settings.exposure = 0.0f;
        settings.false_color.reset();
    }
    settings.light.position = orbit(settings.light.position, scene.bounds().center, options.time);
    return settings;
}

/// Throws common::FileError where a picture could not be written, before any is drawn.
void require_writable(const Options& options) {
    const FrameRange range = options.frames.value_or(FrameRange{0, 0, 1});
    std::optional<std::filesystem::path> folder;
    for (std::uint32_t frame = range.first; frame <= range.last; ++frame) {
        const std::filesystem::path path = file_of(options, frame);
        if (path.parent_path() == folder) continue;
        folder = path.parent_path();
        const common::OutputFile leaves_no_trace(path);
    }
}

}  // namespace

void render_to_file(const Device& device, const Options& options) {
    const ImageKind kind = image_kind(*options.output).value();
    require_size(options, device);
    require_writable(options);
    // Made now, so that no picture is there without the statistics that were asked for.
    std::optional<common::OutputFile> stats;
    if (options.stats) stats.emplace(*options.stats);

    Timings timings;
    Clock::time_point start = Clock::now();
    const Layouts layouts(device);
    const Scene scene =
        load_scene(device, layouts, options.scene, texture_settings(options, device));
    timings.load = milliseconds_since(start);

    const FrameSettings settings = settings_for(kind, options, scene);
    Renderer renderer(device, layouts, built_in_shaders(), OffscreenTarget::format_of(kind),
                      static_cast<VkSampleCountFlagBits>(options.samples.value_or(4)), 1);
    OffscreenTarget target(device, {options.size.width, options.size.height}, kind);
    Studio studio{options, scene, renderer, target, timings};
    options.frames ? studio.draw_turn(settings) : studio.draw_picture(settings);
    if (options.bench_frames > 0) studio.measure(settings);
    if (stats) {
        const std::string text = stats_of(device, scene, timings);
        stats->write(std::as_bytes(std::span(text)));
        stats->commit();
    }
}

}  // namespace cw2
