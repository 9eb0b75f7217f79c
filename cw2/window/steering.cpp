#include "cw2/window/steering.h"

#include <cmath>
#include <numbers>

#include "cw2/window/orbit_camera.h"

namespace cw2 {

namespace {

constexpr float kRadiansPerHeight = std::numbers::pi_v<float>;
constexpr float kFactorPerNotch = 0.85f;

// Limits of the wheel, in parts of the scene's radius.
constexpr float kNearest = 4e-4f;
constexpr float kFarthest = 100.0f;

}  // namespace

void drag(ViewerState& state, Pointer::Grip grip, const glm::vec2& pixels,
          const glm::vec2& extent) {
    const glm::vec2 way = pixels / extent.y;
    switch (grip) {
        case Pointer::Grip::orbit:
            state.set_camera(orbited(state.camera(), kRadiansPerHeight * way));
            break;
        case Pointer::Grip::pan:
            state.set_camera(panned(state.camera(), way));
            break;
        case Pointer::Grip::light:
            state.set_light(dragged_about(state.settings().light.position, state.bounds().center,
                                          state.camera(), kRadiansPerHeight * way));
            break;
        default:
            break;
    }
}

void Wheel::turn(ViewerState& state, float notches, const glm::vec2& cursor,
                 const glm::vec2& extent, const SurfaceAt& surface_at) {
    const Camera camera = state.camera();
    if (!way_ || way_->cursor != cursor || way_->camera.position != camera.position ||
        way_->camera.target != camera.target) {
        const glm::vec2 place = (cursor - 0.5f * extent) / extent.y;
        const std::optional<glm::vec3> surface = surface_at(cursor);
        way_ = {cursor, camera, surface.value_or(point_at(camera, place))};
    }
    const float radius = state.bounds().radius;
    state.set_camera(dollied(camera, way_->point, std::pow(kFactorPerNotch, notches),
                             kNearest * radius, kFarthest * radius));
    way_->camera = state.camera();
}

}  // namespace cw2
