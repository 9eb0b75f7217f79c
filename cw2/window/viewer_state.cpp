#include "cw2/window/viewer_state.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "cw2/options/frame_of.h"
#include "cw2/window/fly_camera.h"

namespace cw2 {

namespace {

constexpr float kRadiiPerSecond = 0.25f;
constexpr float kRadiansPerDraggedUnit = 0.003f;
/// For how long a key counts as held when it is first seen.
constexpr float kFirstSeconds = 1.0f / 60.0f;

/// `options` with camera and light as a scene of these bounds has them.
Options spelt_out(const Options& options, const Bounds& bounds, float aspect) {
    const FrameSettings settings = frame_settings(options, bounds, aspect);
    Options result = options;
    result.camera_position = to_user(settings.camera.position, bounds);
    result.camera_target = to_user(settings.camera.target, bounds);
    result.vertical_fov = options.vertical_fov.value_or(kVerticalFov);
    result.light_position = to_user(settings.light.position, bounds);
    result.light_color = settings.light.color;
    result.samples = options.samples.value_or(kSamples);
    return result;
}

/// The view that keys change; the left one where there are two.
View& shown_view(Options& options) {
    return options.split ? options.split->front().view : options.view;
}

}  // namespace

ViewerState::ViewerState(const Options& options, const Bounds& bounds, float aspect)
    : start_(options), bounds_(bounds), options_(spelt_out(options, bounds, aspect)) {}

FrameSettings ViewerState::settings() const {
    // With a camera that is spelt out the aspect does not matter.
    FrameSettings settings = frame_settings(options_, bounds_, 1.0f);
    settings.light.position =
        orbit(settings.light.position, bounds_.center, options_.time, options_.orbit_axis);
    return settings;
}

void ViewerState::set(const Options& options, bool light_moves) {
    options_ = options;
    light_moves_ = light_moves;
}

void ViewerState::set_camera(const Camera& camera) {
    options_.camera_position = to_user(camera.position, bounds_);
    options_.camera_target = to_user(camera.target, bounds_);
}

void ViewerState::set_light(const glm::vec3& position) {
    options_.light_position =
        to_user(orbit(position, bounds_.center, -options_.time, options_.orbit_axis), bounds_);
}

void ViewerState::set_bounds(const Bounds& bounds) {
    const glm::vec3 light = from_user(to_user(settings().light.position, bounds_), bounds);
    const bool moves_orbit = bounds.center != bounds_.center || bounds.origin != bounds_.origin;
    bounds_ = bounds;
    // The orbit may be about another centre now: it starts where it comes by the same point.
    if (moves_orbit) set_light(light);
}

void ViewerState::frame(std::span<const glm::vec3> vertices, const glm::vec3& center,
                        float aspect) {
    const Camera now = camera();
    set_camera(framed(vertices, center, axes_of(now).back, nearest_frame(bounds_), now.vertical_fov,
                      aspect));
}

bool ViewerState::apply(const Input& input, double seconds, float aspect) {
    // First what went on in the meantime, so that a reset has the last word.
    bool changed = light_moves_;
    if (light_moves_) options_.time += seconds;
    changed |= fly(input, static_cast<float>(seconds));
    for (const Command& command : input.commands) changed |= apply(command, aspect);
    return changed;
}

bool ViewerState::apply(const Command& command, float aspect) {
    switch (command.kind) {
        case CommandKind::toggle_light:
            light_moves_ = !light_moves_;
            return true;
        case CommandKind::show_view:
            shown_view(options_) = command.view;
            return true;
        case CommandKind::next_view:
            shown_view(options_) = (shown_view(options_) + 1) % interop::kViewCount;
            return true;
        case CommandKind::previous_view:
            shown_view(options_) =
                (shown_view(options_) + interop::kViewCount - 1) % interop::kViewCount;
            return true;
        case CommandKind::toggle_normal_map:
            options_.normal_map = !options_.normal_map;
            return true;
        case CommandKind::toggle_alpha_mask:
            options_.alpha_mask = !options_.alpha_mask;
            return true;
        case CommandKind::toggle_two_sided:
            options_.two_sided = !options_.two_sided;
            return true;
        case CommandKind::frame_scene:
            frame(bounds_.vertices, bounds_.center, aspect);
            return true;
        case CommandKind::reset:
            reset(aspect);
            return true;
        default:
            return false;
    }
}

void ViewerState::reset(float aspect) {
    const Options start = spelt_out(start_, bounds_, aspect);
    options_.camera_position = start.camera_position;
    options_.camera_target = start.camera_target;
    options_.vertical_fov = start.vertical_fov;
    options_.light_position = start.light_position;
    options_.light_color = start.light_color;
    options_.time = start.time;
    options_.orbit_axis = start.orbit_axis;
    light_moves_ = false;
}

bool ViewerState::fly(const Input& input, float seconds) {
    const bool moves = input.direction != glm::vec3(0.0f);
    const bool turns = input.drag != glm::vec2(0.0f);
    flies_ &= moves;
    if (!moves && !turns) return false;
    Camera there = camera();
    if (turns) there = turned(there, kRadiansPerDraggedUnit * input.drag);
    if (moves) {
        const float held = flies_ ? seconds : std::min(seconds, kFirstSeconds);
        const float distance = kRadiiPerSecond * bounds_.radius * input.pace * held;
        there = moved(there, distance * glm::normalize(input.direction));
    }
    set_camera(there);
    flies_ = moves;
    return true;
}

}  // namespace cw2
