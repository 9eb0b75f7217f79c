#include "cw2/headless.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "common/io.h"
#include "common/progress.h"
#include "common/quoted_text.h"
#include "cw2/bench.h"
#include "cw2/options/frame_of.h"
#include "cw2/render/averager.h"
#include "cw2/render/image_file.h"
#include "cw2/render/legend.h"
#include "cw2/render/picker.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/scene.h"
#include "cw2/render/scene_file.h"
#include "cw2/render/touched_levels.h"
#include "cw2/source_bake.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/resources.h"

namespace cw2 {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::uint32_t samples_of(const Options& options) {
    return options.samples.value_or(kSamples);
}

/// What draws a picture, and a buffer to read it back.
class OffscreenTarget {
 public:
    OffscreenTarget(const Device& device, const Layouts& layouts, const Options& options,
                    ImageKind kind)
        : device_(device),
          extent_{options.size.width, options.size.height},
          kind_(kind),
          samples_(samples_of(options)),
          bytes_{.srgb = options.encoding == Encoding::srgb, .straight_alpha = !options.background},
          averager_(device, layouts, built_in_shaders(), 1),
          pixels_(make_buffer(device,
                              VkDeviceSize{extent_.width} * extent_.height * pixel_bytes(kind),
                              VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback)),
          pool_(make_command_pool(device)),
          commands_(allocate_commands(device, pool_.get())) {}

    /// See Averager::shown().
    std::vector<TriangleCulling::Shown> shown(const Scene& scene, const FrameSettings& settings) {
        return averager_.shown(scene, settings, extent_, samples_);
    }

    /// Has the device compile what pictures of the scene will need, and waits for it.
    void rehearse(const Scene& scene, const FrameSettings& settings) {
        begin_commands(commands_);
        averager_.rehearse(commands_, 0, scene, settings, extent_, samples_);
        submit_and_wait(device_, commands_);
    }

    /// Renders one picture and waits for it; `next`: the one after it, if there is one. Calls
    /// `sampled` with the number of its frames that are done.
    template <typename Sampled>
    void render(const Scene& scene, const FrameSettings& settings,
                const std::optional<FrameSettings>& next, Sampled sampled) {
        gpu_milliseconds_ = 0.0;
        for (std::uint32_t i = 0; i < samples_; ++i) {
            begin_commands(commands_);
            averager_.add(commands_, 0, scene, settings, extent_, i, samples_,
                          kind_ == ImageKind::png);
            if (i + 1 == samples_) {
                const VkImage image = kind_ == ImageKind::png ? averager_.encode(commands_, bytes_)
                                                              : averager_.mean(commands_);
                read_back(commands_, image, extent_, pixels_);
            }
            std::future<void> drawn =
                std::async(std::launch::async, [&] { submit_and_wait(device_, commands_); });
            if (i + 1 < samples_)
                averager_.expect(scene, settings, extent_, i + 1, samples_);
            else if (next)
                averager_.expect(scene, *next, extent_, 0, samples_);
            drawn.get();
            gpu_milliseconds_ += averager_.renderer().gpu_milliseconds(0).value_or(0.0);
            sampled(i + 1);
        }
    }

    /// What a frame is made of.
    void count(Bench& bench, const Scene& scene, const FrameSettings& settings) {
        begin_commands(commands_);
        averager_.count_fragments(commands_, scene, settings, extent_);
        submit_and_wait(device_, commands_);
        bench.counts = averager_.renderer().counts();
        bench.fragments = averager_.renderer().fragments();
        bench.pipelines = averager_.renderer().pipeline_count();
    }

    std::span<const std::byte> pixels() const { return pixels_.mapped; }
    std::uint32_t samples() const { return samples_; }
    /// Device time of the last picture's frames, 0 where the device has no timestamps.
    double gpu_milliseconds() const { return gpu_milliseconds_; }
    PngContents png() const { return {bytes_.srgb, bytes_.straight_alpha}; }

 private:
    const Device& device_;
    VkExtent2D extent_;
    ImageKind kind_;
    std::uint32_t samples_;
    PictureBytes bytes_;
    Averager averager_;
    Buffer pixels_;
    CommandPool pool_;
    VkCommandBuffer commands_;
    double gpu_milliseconds_ = 0.0;
};

struct Timings {
    double load = 0.0;                    ///< file to device, milliseconds
    std::optional<double> first_frame{};  ///< pipelines, the picture's frames, read-back
    std::optional<double> save{};         ///< of one picture
};

std::string stats_of(const Device& device, const Scene& scene, const Timings& timings,
                     const std::optional<Bench>& bench, const PictureSize& size) {
    const auto time = [](const char* name, const std::optional<double>& milliseconds) {
        return milliseconds ? fmt::format("  \"{}_ms\": {:.3f},\n", name, *milliseconds)
                            : std::string();
    };
    return fmt::format(
        "{{\n  \"device\": {},\n  \"triangles\": {},\n  \"draws\": {},\n"
        "  \"load_ms\": {:.3f},\n{}{}  \"peak_memory_mib\": {:.1f}{}\n}}\n",
        common::quoted_text(device.properties().deviceName), scene.triangle_count(),
        scene.draws().size(), timings.load, time("first_frame", timings.first_frame),
        time("save", timings.save), peak_memory(), bench ? json_of(*bench, size) : std::string());
}

/// Saves pictures on a thread of its own, while the next one is drawn.
class Saver {
 public:
    Saver(const PictureSize& size, const PngContents& png) : size_(size), png_(png) {}

    /// Throws what the saving of the picture before has thrown.
    void save(std::filesystem::path path, std::span<const std::byte> pixels,
              const FrameSettings& settings) {
        finish();
        pixels_.assign(pixels.begin(), pixels.end());
        pending_ = std::async(std::launch::async, [this, settings, path = std::move(path)] {
            draw_legends(pixels_, size_.width, size_.height, settings);
            write_image(path, size_.width, size_.height, pixels_, png_);
        });
    }
    void finish() {
        if (pending_.valid()) pending_.get();
    }

 private:
    PictureSize size_;
    PngContents png_;
    std::vector<std::byte> pixels_;
    std::future<void> pending_;  ///< destroyed first, which waits
};

/// How far a run of frames has come.
class FrameProgress {
 public:
    explicit FrameProgress(std::uint32_t count) : count_(count) {}

    void show(std::uint32_t done) {
        bar_.update(static_cast<double>(done) / count_,
                    fmt::format("{}/{}, {:.1f} a second", done, count_,
                                1000.0 * done / milliseconds_since(start_)));
    }

 private:
    std::uint32_t count_;
    Clock::time_point start_ = Clock::now();
    common::ProgressBar bar_{true};
};

std::filesystem::path file_of(const Options& options, std::uint32_t frame) {
    if (!options.frames) return *options.output;
    return frame_name(options.output->string(), frame).value_or(options.output->string());
}

/// Frame `frame` of `count` of a turn.
FrameSettings turned(const Options& options, const FrameSettings& start, std::uint32_t frame,
                     std::uint32_t count, const Bounds& bounds) {
    return at_frame(start, options.orbit.value_or(Orbit::camera), frame, count, bounds,
                    options.orbit_axis);
}

/// Of --bench, the frame of a picture.
FrameSettings bench_frame(const Options& options, const FrameSettings& start, std::uint32_t picture,
                          const Bounds& bounds) {
    return options.orbit ? turned(options, start, picture, *options.bench_pictures, bounds) : start;
}

/// A scene on its device, and what draws it into files.
struct Studio {
    const Options& options;
    const Scene& scene;
    OffscreenTarget& target;
    Timings& timings;

    void draw_picture(const FrameSettings& settings) {
        Clock::time_point start = Clock::now();
        {
            FrameProgress progress(target.samples());
            target.render(scene, settings, std::nullopt,
                          [&](std::uint32_t frames) { progress.show(frames); });
        }
        timings.first_frame = milliseconds_since(start);
        start = Clock::now();
        Saver saver(options.size, target.png());
        saver.save(*options.output, target.pixels(), settings);
        saver.finish();
        timings.save = milliseconds_since(start);
    }

    void draw_turn(const FrameSettings& settings) {
        const FrameRange& range = *options.frames;
        const Clock::time_point turn_start = Clock::now();
        Saver saver(options.size, target.png());
        std::optional<FrameProgress> progress(range.size());
        const auto at = [&](std::uint32_t frame) {
            return turned(options, settings, frame, range.count, scene.bounds());
        };
        for (std::uint32_t frame = range.first; frame <= range.last; ++frame) {
            const FrameSettings now = at(frame);
            const Clock::time_point start = Clock::now();
            target.render(scene, now,
                          frame < range.last ? std::optional(at(frame + 1)) : std::nullopt,
                          [](std::uint32_t) {});
            if (frame == range.first) timings.first_frame = milliseconds_since(start);
            saver.save(file_of(options, frame), target.pixels(), now);
            progress->show(frame - range.first + 1);
        }
        saver.finish();
        progress.reset();
        const double milliseconds = milliseconds_since(turn_start);
        common::print(fmt::format("{} frames in {:.1f} s, {:.2f} a second\n", range.size(),
                                  1e-3 * milliseconds, 1e3 * range.size() / milliseconds));
    }

    Bench measure(const FrameSettings& settings) {
        constexpr double kMilliseconds = 1e3 / CLOCKS_PER_SEC;
        const std::uint32_t count = *options.bench_pictures;
        const auto at = [&](std::uint32_t picture) {
            return bench_frame(options, settings, picture, scene.bounds());
        };
        // What is built or compiled when it first draws.
        target.render(scene, settings, at(0), [](std::uint32_t) {});
        Bench bench;
        for (std::uint32_t i = 0; i < count; ++i) {
            const FrameSettings now = at(i);
            const std::optional<FrameSettings> next =
                i + 1 < count ? std::optional(at(i + 1)) : std::nullopt;
            const Clock::time_point start = Clock::now();
            const std::clock_t cpu_start = std::clock();
            target.render(scene, now, next, [](std::uint32_t) {});
            bench.wall.push_back(milliseconds_since(start));
            bench.cpu.push_back(kMilliseconds * static_cast<double>(std::clock() - cpu_start));
            bench.device.push_back(target.gpu_milliseconds());
        }
        target.count(bench, scene, at(count - 1));
        return bench;
    }
};

/// What a picture shows at the options' instant, as a file of this kind, if it is for one.
FrameSettings settings_for(std::optional<ImageKind> kind, const Options& options,
                           const SceneStart& start, const Bounds& bounds) {
    const float aspect =
        static_cast<float>(options.size.width) / static_cast<float>(options.size.height);
    FrameSettings settings = frame_settings(completed(options, start, bounds), bounds, aspect);
    if (kind == ImageKind::exr) {
        // It holds the values themselves.
        settings.exposure = 0.0f;
        settings.false_color.reset();
    }
    settings.light.position =
        orbit(settings.light.position, bounds.center, options.time, options.orbit_axis);
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

void print_pixel(const Device& device, const Layouts& layouts, const Scene& scene,
                 const Options& options) {
    Picker picker(device, layouts, built_in_shaders());
    const glm::uvec2 pixel(options.pixel->x, options.pixel->y);
    const std::optional<Pick> pick =
        picker.pick(scene, settings_for(std::nullopt, options, scene.start(), scene.bounds()),
                    {options.size.width, options.size.height}, pixel);
    common::print(
        json_of(pixel, pick, pick ? scene.material_names()[pick->material] : std::string()));
}

/// What all pictures of a run show, but for the light, if the camera does not move.
std::optional<FrameSettings> only_view(const Options& options, const FrameSettings& settings,
                                       const Bounds& bounds) {
    const bool turns = options.frames ? options.frames->size() > 1 && options.orbit != Orbit::light
                                      : options.bench_pictures && options.orbit == Orbit::camera;
    if (turns) return std::nullopt;
    if (!options.frames) return settings;
    return turned(options, settings, options.frames->first, options.frames->count, bounds);
}

/// From which levels on the pictures of a run need the textures; empty for all.
std::vector<std::uint32_t> needed_levels(const Options& options, const FrameSettings& settings,
                                         const TextureSettings& textures, const SceneFile& file,
                                         const Scene& scene, OffscreenTarget* target) {
    const std::optional<FrameSettings> view = only_view(options, settings, file.bounds);
    if (!view) return {};
    std::vector<TriangleCulling::Shown> shown;
    // A pixel that is read is sampled where no frame may be.
    if (target && !options.pixel) shown = target->shown(scene, *view);
    return first_touched_levels(file.document, file.bounds, view->camera,
                                {.extent = {options.size.width, options.size.height},
                                 .lod_bias = pixel_sample(0, samples_of(options)).lod_bias,
                                 .anisotropy = textures.anisotropy},
                                shown);
}

/// Returns the statistics of what was drawn, empty for nothing.
std::string render(const Device& device, const Options& options, SceneFile file, Timings timings) {
    const Clock::time_point start = Clock::now();
    const std::optional<ImageKind> kind =
        options.output ? image_kind(*options.output) : std::nullopt;
    const FrameSettings settings = settings_for(kind, options, file.start, file.bounds);
    const TextureSettings textures = texture_settings(options, device);
    const Layouts layouts(device);
    Scene scene(device, file);
    std::optional<OffscreenTarget> target;
    const bool draws = kind || options.bench_pictures;
    if (draws) target.emplace(device, layouts, options, kind.value_or(ImageKind::png));
    scene.make_textures(
        device, layouts, file, textures,
        needed_levels(options, settings, textures, file, scene, target ? &*target : nullptr));
    std::future<void> rehearsal;
    // On CPUs shaders are compiled when they first draw: beside the decoding of textures.
    if (draws && device.is_cpu())
        rehearsal = std::async(std::launch::async, [&] { target->rehearse(scene, settings); });
    scene.write_textures(device, file);
    file = {};
    if (rehearsal.valid()) rehearsal.get();
    timings.load += milliseconds_since(start);

    if (options.pixel) print_pixel(device, layouts, scene, options);
    if (!draws) return {};
    Studio studio{options, scene, *target, timings};
    if (kind) options.frames ? studio.draw_turn(settings) : studio.draw_picture(settings);
    std::optional<Bench> bench;
    if (options.bench_pictures) {
        bench = studio.measure(settings);
        common::print(text_of(*bench, options.size, target->samples()));
    }
    return stats_of(device, scene, timings, bench, options.size);
}

}  // namespace

int render_headless(const Options& options) {
    // The file is read while the driver is.
    std::future<SceneFile> loading;
    const auto load = [](const std::filesystem::path& path) {
        return std::async(std::launch::async, [path] { return load_scene_file(path); });
    };
    if (!is_source(options.scene)) loading = load(options.scene);
    const Instance instance(options.validation, {});
    {
        const Device device(instance, options.device);
        require_size(options, device);
        if (options.output) require_writable(options);
        // Made now, so that no picture is there without the statistics that were asked for.
        std::optional<common::OutputFile> stats;
        if (options.stats) stats.emplace(*options.stats);

        const std::unique_ptr<SourceBake> bake = bake_of(options, device, tell_user);
        if (bake) wait_for(*bake);
        const Clock::time_point start = Clock::now();
        SceneFile file = bake ? load_scene_file(bake->baked()) : loading.get();
        Timings timings{.load = milliseconds_since(start)};
        const std::string text = render(device, options, std::move(file), timings);
        if (stats && !text.empty()) {
            stats->write(std::as_bytes(std::span(text)));
            stats->commit();
        }
    }
    return instance.validation_messages() == 0 ? 0 : 1;
}

}  // namespace cw2
