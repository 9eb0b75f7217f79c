// The widgets over the picture: everything that can be set, and what can be read off. They know
// only Dear ImGui; call between its NewFrame and Render.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cw2/options/options.h"
#include "cw2/render/camera.h"
#include "cw2/render/picker.h"
#include "cw2/window/input.h"
#include "cw2/window/presenter.h"

namespace cw2 {

/// What the panel shows and does not change.
struct PanelFacts {
    std::string device;
    Bounds bounds;
    VkExtent2D extent;  ///< of the picture, pixels
    FrameTimes times;
    FrameCounts counts;
    std::uint64_t triangles;    ///< of the whole scene, on each side of a split
    std::uint64_t scene_bytes;  ///< device memory of geometry and textures
    std::uint64_t image_bytes;  ///< device memory of what is drawn into
    std::optional<Pick> pick;   ///< of the pixel that was clicked
    std::string picked_material;
    std::string message;  ///< the latest; empty for none
    bool message_is_error;
    float scale;  ///< pixels of a length of 1
};

/// What the panel changes.
struct PanelState {
    Options options;  ///< with camera, light and samples spelt out, and valid, before and after
    bool light_moves;
};

/// Draws what can be read off, in a window of its own.
void draw_readings(const PanelFacts& facts);
/// Its parts: of what a pixel shows, and of what a frame costs.
void pixel_section(const PanelFacts& facts);
void frame_section(const PanelFacts& facts, bool open);

/// Draws all of it, the readings too; gives the commands of the buttons pressed.
std::vector<Command> draw_panel(const PanelFacts& facts, PanelState& state);

/// The camera, and where the light is, as options of the command line: without the latter it would
/// follow the camera.
std::string camera_flags(const Options& options);

}  // namespace cw2
