// What the window shows, and how the user changes it.
#pragma once

#include "cw2/camera.h"
#include "cw2/input.h"
#include "cw2/options.h"
#include "cw2/renderer.h"

namespace cw2 {

class ViewerState {
 public:
    /// Shows what `options` ask for; the light stands still. `aspect` is the window's
    /// width / height. Throws UsageError.
    ViewerState(const Options& options, const Bounds& bounds, float aspect);

    /// Does what the user asked for in the `seconds` since the last call, in a window of `aspect`.
    /// True where that changes the picture. Commands that are about the program are not for here.
    bool apply(const Input& input, double seconds, float aspect);

    FrameSettings settings() const;

 private:
    bool apply(const Command& command, float aspect);
    bool fly(const Input& input, float seconds);

    Options options_;
    Bounds bounds_;
    FrameSettings settings_;  ///< with the light at the start of its orbit
    double light_seconds_;    ///< on its orbit
    bool light_moves_ = false;
    bool flies_ = false;  ///< keys that move the camera were held at the last call
};

}  // namespace cw2
