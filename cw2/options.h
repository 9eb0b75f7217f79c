// The command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "cw2/camera.h"
#include "cw2/renderer.h"
#include "cw2/scene.h"
#include "cw2/view.h"

namespace cw2 {

struct Options {
    std::filesystem::path scene;
    std::optional<std::filesystem::path> output;  ///< none: open a window
    std::uint32_t width = 1280;
    std::uint32_t height = 720;
    View view = interop::kViewShaded;
    std::optional<std::uint32_t> samples;  ///< 1 or 4; none: by the device and the output
    std::optional<glm::vec3> camera_position;
    std::optional<glm::vec3> camera_target;
    float vertical_fov = 60.0f;  ///< degrees, in (0, 180)
    std::optional<glm::vec3> light_position;
    glm::vec3 light_color{1.0f};
    glm::vec3 ambient{0.02f};
    glm::vec3 background{0.1f};
    double time = 0.0;  ///< seconds of the light's orbit
    bool normal_map = true;
    bool alpha_mask = true;
    std::optional<std::uint32_t> anisotropy;  ///< 1 to 16; none: 16 on GPUs, 1 on CPUs
    std::optional<std::string> device;
    bool list_devices = false;
    bool list_views = false;
    bool validation = false;
    std::optional<std::filesystem::path> stats;
    std::uint32_t bench_frames = 0;  ///< further frames to time
};

/// A command line that does not make sense; what() is one line.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Reads the command line. `--help` and `--version` print and give nothing. Throws UsageError.
std::optional<Options> parse_options(int argc, const char* const* argv);

/// What the options ask a frame to show of a scene of these bounds, at the start of the light's
/// orbit. `aspect` is the picture's width / height.
FrameSettings frame_settings(const Options& options, const Bounds& bounds, float aspect);

/// Throws VulkanError where the device cannot render pictures of the size in the options.
void require_size(const Options& options, const Device& device);

/// How the options and the device want textures.
TextureSettings texture_settings(const Options& options, const Device& device);

}  // namespace cw2
