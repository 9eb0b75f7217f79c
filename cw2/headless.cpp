#include "cw2/headless.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "cw2/image_file.h"
#include "cw2/legend.h"
#include "cw2/pipelines.h"
#include "cw2/renderer.h"
#include "cw2/resources.h"
#include "cw2/scene.h"
#include "mesh-format/io.h"

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

    std::span<std::byte> pixels() const { return pixels_.mapped; }

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

void write_stats(const std::filesystem::path& path, const Device& device, const Scene& scene,
                 const Timings& timings) {
    std::string name;
    for (const char c : std::string_view(device.properties().deviceName)) {
        if (c == '"' || c == '\\') name += '\\';
        name += c;
    }
    const std::string json = fmt::format(
        "{{\n  \"device\": \"{}\",\n  \"triangles\": {},\n  \"draws\": {},\n"
        "  \"load_ms\": {:.3f},\n  \"first_frame_ms\": {:.3f},\n  \"save_ms\": {:.3f},\n"
        "  \"bench_frames\": {},\n  \"median_frame_ms\": {:.3f},\n"
        "  \"median_gpu_ms\": {:.3f}\n}}\n",
        name, scene.triangle_count(), scene.draws().size(), timings.load, timings.first_frame,
        timings.save, timings.frames.size(), median(timings.frames), median(timings.gpu_frames));
    mesh_format::OutputFile file(path);
    file.write(std::as_bytes(std::span(json)));
    file.commit();
}

/// Puts the legend of its false colours onto a PNG's pixels.
void draw_legends(std::span<std::byte> pixels, const PictureSize& size,
                  const FrameSettings& settings) {
    if (!settings.false_color) return;
    const std::uint32_t end = settings.split ? settings.split->column(size.width) : size.width;
    const auto draw = [&](View view, std::uint32_t left, std::uint32_t right) {
        draw_legend(pixels, size.width, size.height, left, right,
                    settings.false_color->range_of(view));
    };
    draw(settings.view, 0, end);
    if (settings.split) draw(settings.split->right.view, end, size.width);
}

}  // namespace

void render_to_file(const Device& device, const Options& options) {
    const ImageKind kind = image_kind(*options.output);
    require_size(options, device);
    Timings timings;
    Clock::time_point start = Clock::now();
    const Layouts layouts(device);
    const Scene scene =
        load_scene(device, layouts, options.scene, texture_settings(options, device));
    timings.load = milliseconds_since(start);

    const float aspect =
        static_cast<float>(options.size.width) / static_cast<float>(options.size.height);
    FrameSettings settings =
        frame_settings(completed(options, scene.start()), scene.bounds(), aspect);
    if (kind == ImageKind::exr) {
        // It holds the values themselves.
        settings.exposure = 0.0f;
        settings.false_color.reset();
    }
    settings.light.position = orbit(settings.light.position, scene.bounds().center, options.time);

    start = Clock::now();
    Renderer renderer(device, layouts, built_in_shaders(), OffscreenTarget::format_of(kind),
                      static_cast<VkSampleCountFlagBits>(options.samples.value_or(4)), 1);
    OffscreenTarget target(device, {options.size.width, options.size.height}, kind);
    target.render(renderer, scene, settings);
    timings.first_frame = milliseconds_since(start);

    start = Clock::now();
    draw_legends(target.pixels(), options.size, settings);
    write_image(*options.output, options.size.width, options.size.height, target.pixels());
    timings.save = milliseconds_since(start);

    for (std::uint32_t i = 0; i < options.bench_frames; ++i) {
        start = Clock::now();
        target.render(renderer, scene, settings);
        timings.frames.push_back(milliseconds_since(start));
        timings.gpu_frames.push_back(renderer.gpu_milliseconds(0).value_or(0.0));
    }
    if (options.bench_frames > 0) {
        fmt::print("{} frames of {}x{}: median {:.2f} ms, device {:.2f} ms\n", options.bench_frames,
                   options.size.width, options.size.height, median(timings.frames),
                   median(timings.gpu_frames));
    }
    if (options.stats) write_stats(*options.stats, device, scene, timings);
}

}  // namespace cw2
