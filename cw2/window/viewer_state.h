// What the window shows, and how the user changes it.
#pragma once

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

    const Options& options() const { return options_; }
    bool light_moves() const { return light_moves_; }
    /// Takes over what a panel has changed. Camera and light must still be spelt out.
    void set(const Options& options, bool light_moves);

    /// The scene is another now; camera and light stay where they are.
    void set_bounds(const Bounds& bounds);

 private:
    bool apply(const Command& command, float aspect);
    bool fly(const Input& input, float seconds);

    Options start_;
    Bounds bounds_;
    Options options_;
    bool light_moves_ = false;
    bool flies_ = false;  ///< keys that move the camera were held at the last call
};

}  // namespace cw2
