// Which levels of its textures a picture can touch.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <vector>

#include "cw2/render/camera.h"
#include "cw2/render/triangle_culling.h"
#include "mesh-format/file.h"

namespace cw2 {

/// How a picture is sampled.
struct PictureSampling {
    VkExtent2D extent;
    float lod_bias;    ///< added to the level of detail, at most 0
    float anisotropy;  ///< the samplers' largest ratio, at least 1
};

/// The first level of each texture that a picture from this camera may touch, never one of the last
/// two; levels of which the first is no whole multiple are kept. `shown`: all that its frames draw;
/// empty: of the scene's triangles all that are not beside the picture. A bound: with less, the
/// same picture. Takes 10 ms for a million triangles.
std::vector<std::uint32_t> first_touched_levels(const mesh_format::Document& document,
                                                const Bounds& bounds, const Camera& camera,
                                                const PictureSampling& sampling,
                                                std::span<const TriangleCulling::Shown> shown = {});

}  // namespace cw2
