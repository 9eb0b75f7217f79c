// The attributes of a scene's vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/geometry/weld.h"

namespace bake {

/// A scene's triangles over framed vertices.
struct FramedScene {
    const SourceScene& source;  ///< its attributes and materials; its corners may be gone
    const FramedTriangles& framed;

    const glm::vec3& position(std::uint32_t vertex) const {
        return source.positions[framed.vertices[vertex].corner.position];
    }
    const glm::vec3& normal(std::uint32_t vertex) const {
        return source.normals[framed.vertices[vertex].corner.normal];
    }
    /// As the file has it: v = 0 is the top row.
    glm::vec2 uv(std::uint32_t vertex) const {
        const glm::vec2& uv = source.uvs[framed.vertices[vertex].corner.uv];
        return {uv.x, 1.0f - uv.y};
    }
    /// Times 3/4, so that no sum of finite positions overflows.
    glm::vec3 centroid(std::size_t triangle) const {
        const std::uint32_t* corners = &framed.indices[3 * triangle];
        return 0.25f * position(corners[0]) + 0.25f * position(corners[1]) +
               0.25f * position(corners[2]);
    }
};

}  // namespace bake
