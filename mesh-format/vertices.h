// A vertex as numbers, whatever the forms that the file holds it in.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh-format/file.h"
#include "mesh-format/tangent_frame.h"

namespace mesh_format {

struct Vertex {
    float position[3];  ///< scene units, relative to SceneRecord::origin
    TangentFrame frame;
    float uv[2];            ///< v = 0 is the top row of the image
    std::uint8_t color[4];  ///< red, green and blue sRGB-encoded, alpha linear; 255 without colours
};

/// Vertex `index`, counted from the mesh's first, of a mesh of `document`, whose geometry is
/// decoded. Equal codes give equal bits, and positions the very ones that the renderer draws.
Vertex unpack_vertex(const Document& document, const MeshRecord& mesh, std::size_t index);

}  // namespace mesh_format
