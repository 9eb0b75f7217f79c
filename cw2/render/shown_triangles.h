// Which triangles a picture shows, for devices on which the hidden ones cost most.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cw2/render/depth_buffer.h"
#include "cw2/render/scene.h"

namespace cw2 {

/// Triangles that are drawn as one.
struct DrawRange {
    std::uint32_t draw;  ///< index into Scene::draws, whose vertices the indices count
    std::uint32_t first_index;
    std::uint32_t index_count;
};

struct ShownTriangles {
    std::vector<std::uint16_t> indices;
    std::vector<DrawRange> ranges;  ///< of these indices, in the order to draw them
};

/// What triangles are made of.
struct SceneTriangles {
    std::span<const glm::vec3> positions;  ///< of all vertices, draw after draw
    std::span<const std::uint16_t> indices;
    std::span<const SceneChunk> chunks;
    std::span<const Draw> draws;
};

/// A picture with one sample in the middle of each pixel.
struct PictureView {
    glm::mat4 clip_from_world;  ///< depth is `near` / w
    float near;
    VkExtent2D extent;
    VkRect2D area;  ///< that is drawn, in `extent`
};

/// What is nearest in each of the bands in which a picture is looked at.
using BandDepths = std::array<DepthBuffer, 4>;

/// Lists the triangles of `chunks`, opaque ones from near to far before alpha-masked ones, that may
/// be seen: not those that are beside the picture, look away and are culled, cover no pixel's
/// centre, or lie behind opaque ones wherever they and a pixel around them would be. Which corner
/// of a pixel's grid a device's floats are rounded to makes no difference.
/// Works in bands of the picture, on threads; for any number of them the answer is the same.
ShownTriangles shown_triangles(const SceneTriangles& scene, std::span<const std::uint32_t> chunks,
                               const PictureView& view, BandDepths& depths);

}  // namespace cw2
