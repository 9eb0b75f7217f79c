// Which levels of its textures a picture can touch.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "cw2/render/camera.h"
#include "cw2/render/scene_file.h"

namespace cw2 {

/// How a picture is sampled.
struct PictureSampling {
    VkExtent2D extent;
    float lod_bias;    ///< added to the level of detail, at most 0
    float anisotropy;  ///< the samplers' largest ratio, at least 1
};

/// The first level of each texture that a picture from this camera may touch, never one of the last
/// two; levels of which the first is no whole multiple are kept. A bound: with less, the same
/// picture. Takes 10 ms for a million triangles.
std::vector<std::uint32_t> first_touched_levels(const SceneFile& file, const Camera& camera,
                                                const PictureSampling& sampling);

}  // namespace cw2
