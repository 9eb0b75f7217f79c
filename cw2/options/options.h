// The command line, and the config files that stand for one.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cw2/render/frames.h"
#include "cw2/render/view.h"

namespace CLI {
class App;
}

namespace cw2 {

/// Pixels, neither 0.
struct PictureSize {
    std::uint32_t width = 1280;
    std::uint32_t height = 720;
    bool operator==(const PictureSize&) const = default;
};

/// A pixel of a picture, from its upper left corner.
struct PixelPlace {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    bool operator==(const PixelPlace&) const = default;
};

/// What the bytes of a PNG are of the values that it shows.
enum class Encoding { srgb, linear };

/// Samples a pixel, where nobody asks for others.
inline constexpr std::uint32_t kSamples = 4;

/// The values that an option takes, both ends included.
template <typename T>
struct Range {
    T low;
    T high;
    bool has(T value) const { return value >= low && value <= high; }
};
inline constexpr Range<float> kDividerRange{0.0f, 1.0f};
inline constexpr Range<float> kExposureRange{-64.0f, 64.0f};
inline constexpr Range<float> kFovRange{1.0f, 179.0f};
inline constexpr Range<float> kOverrideRange{0.0f, 1.0f};  ///< of roughness and metalness
inline constexpr Range<float> kNormalStrengthRange{0.0f, 10.0f};
inline constexpr Range<std::uint32_t> kAnisotropyRange{1u, 16u};
inline constexpr Range<std::uint32_t> kBenchRange{1u, 1'000'000u};

inline constexpr float kVerticalFov = 60.0f;  ///< degrees, where nobody asks for another

struct Options {
    std::filesystem::path scene;
    std::vector<std::filesystem::path> files;  ///< where there are several; `scene` is the first
    bool z_up = false;        ///< of a scene that is not baked yet: its up axis is +Z
    bool strict = false;      ///< the same: a warning of the bake is an error
    bool restricted = false;  ///< the same: nothing outside the scene's folder is read
    std::optional<std::filesystem::path> output;  ///< none: open a window, but for `pixel`
    PictureSize size;
    View view = interop::kViewShaded;
    std::optional<std::array<Side, 2>> split;  ///< in place of `view`
    float divider = 0.5f;                      ///< of the width, in kDividerRange
    std::optional<float> exposure;             ///< stops, in kExposureRange; none: by the view
    std::optional<FalseColor> false_color;
    std::optional<std::uint32_t> samples;       ///< 1, 4, 16, 64 or 256; none: kSamples
    std::optional<glm::dvec3> camera_position;  ///< this and the next are in the user's coordinates
    std::optional<glm::dvec3> camera_target;
    std::optional<float> vertical_fov;         ///< degrees, in kFovRange; none: kVerticalFov
    std::optional<glm::dvec3> light_position;  ///< the same
    std::optional<glm::vec3> light_color;      ///< none: 1, 1, 1
    glm::vec3 ambient{0.02f};
    std::optional<glm::vec3> background{glm::vec3(0.1f)};  ///< linear; none: transparent
    Encoding encoding = Encoding::srgb;                    ///< of PNGs
    double time = 0.0;                                     ///< seconds of the light's orbit
    Axis orbit_axis = Axis::z;                             ///< that it goes about
    std::optional<float> roughness;  ///< of every material, in kOverrideRange; none: its own
    std::optional<float> metalness;  ///< the same
    float normal_strength = 1.0f;    ///< a factor on all slopes, in kNormalStrengthRange
    bool normal_map = true;
    bool alpha_mask = true;
    bool two_sided = false;                   ///< turn the normals of back faces to the camera
    std::optional<std::uint32_t> anisotropy;  ///< in kAnisotropyRange; none: 16 on GPUs, 1 on CPUs
    std::optional<std::string> device;
    bool list_devices = false;
    bool list_views = false;
    bool validation = false;
    std::optional<FrameRange> frames;  ///< a turntable of pictures
    std::optional<Orbit> orbit;        ///< in `frames`; none: the camera's
    std::optional<PixelPlace> pixel;   ///< whose numbers are printed
    std::optional<std::filesystem::path> stats;
    std::optional<std::uint32_t> bench_pictures;  ///< to time, in kBenchRange

    bool operator==(const Options&) const = default;
};

/// Whether a scene is to be baked before it can be drawn.
bool is_source(const std::filesystem::path& scene);

/// Reads the command line, and the file that its --config names, whose keys are the names of the
/// options. Relative paths in either are relative to the working directory. `--help` and
/// `--version`, which prints "cw2 " and `version`, give nothing. Throws UsageError, and
/// common::FileError where the config file cannot be read.
std::optional<Options> parse_options(int argc, const char* const* argv,
                                     const std::string& version = {});

/// Shows `look` the whole command line as CLI11 has it.
void show_command_line(const std::function<void(const CLI::App&)>& look);

/// Writes a file that `--config` reads as these options, every number exactly. It replaces `path`
/// whole. Throws common::FileError.
void write_config(const std::filesystem::path& path, const Options& options);

}  // namespace cw2
