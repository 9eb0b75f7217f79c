#include "cw2/viewer_state.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "cw2/fly_camera.h"

namespace cw2 {

namespace {

constexpr float kRadiiPerSecond = 0.25f;
constexpr float kRadiansPerDraggedUnit = 0.003f;
/// For how long a key counts as held when it is first seen.
constexpr float kFirstSeconds = 1.0f / 60.0f;

}  // namespace

ViewerState::ViewerState(const Options& options, const Bounds& bounds, float aspect)
    : options_(options),
      bounds_(bounds),
      settings_(frame_settings(options, bounds, aspect)),
      light_seconds_(options.time) {}

FrameSettings ViewerState::settings() const {
    FrameSettings settings = settings_;
    settings.light.position = orbit(settings.light.position, bounds_.center, light_seconds_);
    return settings;
}

bool ViewerState::apply(const Input& input, double seconds, float aspect) {
    // First what went on in the meantime, so that a reset has the last word.
    bool changed = light_moves_;
    if (light_moves_) light_seconds_ += seconds;
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
            settings_.view = command.view;
            return true;
        case CommandKind::next_view:
            settings_.view = (settings_.view + 1) % interop::kViewCount;
            return true;
        case CommandKind::previous_view:
            settings_.view = (settings_.view + interop::kViewCount - 1) % interop::kViewCount;
            return true;
        case CommandKind::toggle_normal_map:
            settings_.normal_map = !settings_.normal_map;
            return true;
        case CommandKind::toggle_alpha_mask:
            settings_.alpha_mask = !settings_.alpha_mask;
            return true;
        case CommandKind::reset:
            settings_.camera = frame_settings(options_, bounds_, aspect).camera;
            light_seconds_ = options_.time;
            light_moves_ = false;
            return true;
        case CommandKind::reload_shaders:
        case CommandKind::save_screenshot:
        case CommandKind::end:
            return false;
    }
    return false;
}

bool ViewerState::fly(const Input& input, float seconds) {
    const bool moves = input.direction != glm::vec3(0.0f);
    const bool turns = input.drag != glm::vec2(0.0f);
    if (turns) settings_.camera = turned(settings_.camera, kRadiansPerDraggedUnit * input.drag);
    if (moves) {
        const float held = flies_ ? seconds : std::min(seconds, kFirstSeconds);
        const float distance = kRadiiPerSecond * bounds_.radius * input.pace * held;
        settings_.camera = moved(settings_.camera, distance * glm::normalize(input.direction));
    }
    flies_ = moves;
    return moves || turns;
}

}  // namespace cw2
