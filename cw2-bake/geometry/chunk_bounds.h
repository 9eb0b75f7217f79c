// What a chunk is culled by.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "cw2-bake/geometry/box.h"
#include "mesh-format/layout.h"

namespace bake {

/// The sphere and the cone of at most kMaxChunkTriangles triangles over `positions`, all of which
/// they use and which `box` bounds; the index range is left 0.
mesh_format::ChunkRecord bound_chunk(const Box<glm::vec3>& box,
                                     std::span<const glm::vec3> positions,
                                     std::span<const std::uint16_t> indices);

}  // namespace bake
