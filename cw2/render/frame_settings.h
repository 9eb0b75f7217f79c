// What a frame shows of a scene.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "cw2/render/camera.h"
#include "cw2/render/view.h"

namespace cw2 {

/// What every material has instead of its own.
struct MaterialOverrides {
    std::optional<float> roughness;  ///< in [0, 1], in place of factor and texture
    std::optional<float> metalness;  ///< the same
    float normal_strength = 1.0f;    ///< a factor on the slopes of all normal maps
    bool two_sided = false;          ///< the normals of back faces turn to the camera
};

/// That a frame shows the same scene in two ways, side by side.
struct Split {
    Side right;
    float divider = 0.5f;  ///< where the right side begins, in [0, 1] of the width

    /// The first column of pixels that belongs to the right side.
    std::uint32_t column(std::uint32_t width) const {
        return static_cast<std::uint32_t>(std::lround(static_cast<float>(width) * divider));
    }
};

/// What a frame shows; the base is its left side, if there is a split.
struct FrameSettings : Side {
    std::optional<Split> split;
    Camera camera{};
    Light light{};
    MaterialOverrides materials{};
    std::optional<glm::vec3> background{glm::vec3(0.1f)};  ///< linear; none: transparent
    /// Stops: values are multiplied by 2^exposure; none: that of each side's view.
    std::optional<float> exposure;
    std::optional<FalseColor> false_color;  ///< in place of the exposure
    /// One pipeline draws every view, and what interop.h says can be read: for those who want many
    /// views of little. It is slower than one made for a view.
    bool one_pipeline = false;
};

}  // namespace cw2
