#include "cw2/options/frame_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "cw2/options/config.h"

namespace cw2 {

Options completed(Options options, const SceneStart& start, const Bounds& bounds) {
    constexpr float kDegreesPerRadian = 180.0f / std::numbers::pi_v<float>;
    if (start.camera && !options.camera_position && !options.camera_target) {
        options.camera_position = to_user(start.camera->position, bounds);
        options.camera_target = to_user(start.camera->target, bounds);
        if (!options.vertical_fov) {
            options.vertical_fov = start.camera->vertical_fov * kDegreesPerRadian;
        }
    }
    if (!options.light_position && start.light_position)
        options.light_position = to_user(*start.light_position, bounds);
    if (!options.light_color) options.light_color = start.light_color;
    return options;
}

namespace {

Camera start_camera(const Options& options, const Bounds& bounds, float aspect) {
    constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180.0f;
    const float fov = options.vertical_fov.value_or(kVerticalFov) * kRadiansPerDegree;
    Camera camera = options.camera_position
                        ? Camera{from_user(*options.camera_position, bounds), bounds.center, fov}
                        : default_camera(bounds, fov, aspect);
    if (options.camera_target) camera.target = from_user(*options.camera_target, bounds);
    if (camera.position == camera.target) {
        throw UsageError("the camera's position and target are the same point");
    }
    return camera;
}

}  // namespace

FrameSettings frame_settings(const Options& options, const Bounds& bounds, float aspect) {
    FrameSettings settings;
    const auto side_of = [&](Side side) {
        side.normal_map &= options.normal_map;
        side.alpha_mask &= options.alpha_mask;
        return side;
    };
    static_cast<Side&>(settings) =
        side_of(options.split ? options.split->front() : Side{options.view});
    if (options.split) settings.split = {side_of(options.split->back()), options.divider};
    settings.exposure = options.exposure;
    settings.false_color = options.false_color;
    settings.camera = start_camera(options, bounds, aspect);
    settings.light = {options.light_position ? from_user(*options.light_position, bounds)
                                             : default_light_position(bounds, settings.camera),
                      options.light_color.value_or(glm::vec3(1.0f)), options.ambient};
    settings.materials = {options.roughness, options.metalness, options.normal_strength,
                          options.two_sided};
    settings.background = options.background;
    return settings;
}

void require_size(const Options& options, const Device& device) {
    const std::uint32_t largest = device.properties().limits.maxImageDimension2D;
    if (options.size.width > largest || options.size.height > largest) {
        throw VulkanError(fmt::format("--size: device '{}' renders at most {} pixels a side",
                                      device.properties().deviceName, largest));
    }
}

TextureSettings texture_settings(const Options& options, const Device& device) {
    // Measured on lavapipe: any anisotropy makes a frame three times as long.
    const auto wanted = static_cast<float>(options.anisotropy.value_or(device.is_cpu() ? 1u : 16u));
    // On CPUs sampling blocks makes a frame 1.5 times as long, and with no shader cache most of the
    // first one is the compiling of their decoders.
    return {.anisotropy = std::min(wanted, device.properties().limits.maxSamplerAnisotropy),
            .decode_blocks = device.is_cpu() || !device.samples_blocks(),
            .few_kinds = device.is_cpu()};
}

}  // namespace cw2
