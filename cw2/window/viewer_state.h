// What the window shows, and how the user changes it.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "cw2/options/options.h"
#include "cw2/render/camera.h"
#include "cw2/render/frame_settings.h"
#include "cw2/window/input.h"

namespace cw2 {

/// The present state is a value of Options, with camera and light spelt out: what draws the same
/// picture into a file.
class ViewerState {
 public:
    /// Shows what `options` ask for; the light stands still. `aspect` is the window's
    /// width / height. Throws UsageError.
    ViewerState(const Options& options, const Bounds& bounds, float aspect);

    /// Does what the user asked for in the `seconds` since the last call, in a window of `aspect`.
    /// True where that changes the picture. Commands that are about the program are not for here.
    bool apply(const Input& input, double seconds, float aspect);

    FrameSettings settings() const;
    Camera camera() const { return settings().camera; }
    const Bounds& bounds() const { return bounds_; }
    /// Moves the camera; its field of view stays.
    void set_camera(const Camera& camera);
    /// Moves the light to where it shall be now, and its orbit with it.
    void set_light(const glm::vec3& position);
    /// Brings all of these points into view, in a window of `aspect`, and makes `center` the
    /// target; the direction of sight stays.
    void frame(std::span<const glm::vec3> vertices, const glm::vec3& center, float aspect);

    const Options& options() const { return options_; }
    bool light_moves() const { return light_moves_; }
    /// Takes over what a panel has changed. Camera and light must still be spelt out.
    void set(const Options& options, bool light_moves);

    /// The scene is another now; camera and light stay where they are.
    void set_bounds(const Bounds& bounds);

 private:
    bool apply(const Command& command, float aspect);
    void reset(float aspect);
    bool fly(const Input& input, float seconds);

    Options start_;
    Bounds bounds_;
    Options options_;
    bool light_moves_ = false;
    bool flies_ = false;  ///< keys that move the camera were held at the last call
};

}  // namespace cw2
