// What drags and the wheel do to the camera and the light.
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "cw2/window/pointer.h"
#include "cw2/window/viewer_state.h"

namespace cw2 {

/// The surface that a picture shows at a place in pixels; nothing for the background.
using SurfaceAt = std::function<std::optional<glm::vec3>(glm::vec2)>;

/// Does what a drag by `pixels` in a picture of this `extent` asks of what the button has hold of.
void drag(ViewerState& state, Pointer::Grip grip, const glm::vec2& pixels, const glm::vec2& extent);

/// Turns of the wheel.
class Wheel {
 public:
    /// Goes towards what is at `cursor`, or away from it: the surface, else as far as the target.
    /// Which point that is is asked for once, for as long as cursor and camera are left alone.
    void turn(ViewerState& state, float notches, const glm::vec2& cursor, const glm::vec2& extent,
              const SurfaceAt& surface_at);

 private:
    struct Way {
        glm::vec2 cursor;
        Camera camera;  ///< where it has come to
        glm::vec3 point;
    };
    std::optional<Way> way_;
};

}  // namespace cw2
