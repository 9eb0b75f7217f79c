// The window's title.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "cw2/render/frame_settings.h"
#include "cw2/window/window.h"

namespace cw2 {

/// Says the scene, the view and the time of a frame, after an error if there is one.
class Title {
 public:
    /// `window` must outlive this.
    explicit Title(Window& window) : window_(window) {}

    /// The name of the scene, and its place among others or nothing.
    void set_scene(const std::string& name, const std::string& place);
    /// Empty for none.
    void set_error(std::string error);

    /// What is new shows at once, but the time every now and then only.
    void update(const FrameSettings& settings, std::optional<double> milliseconds);

 private:
    Window& window_;
    std::string scene_;
    std::string error_;
    std::string words_;  ///< shown, but for the time
    std::chrono::steady_clock::time_point written_;
};

}  // namespace cw2
