#include "mesh-format/vertices.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace mesh_format {

namespace {

/// What `count` words q at `bytes` stand for: origin + step * q.
void unpack_words(const std::byte* bytes, int count, const float* origin, const float* step,
                  float* out) {
    for (int k = 0; k < count; ++k) {
        std::uint16_t q = 0;
        std::memcpy(&q, bytes + k * sizeof q, sizeof q);
        out[k] = origin[k] + step[k] * q;
    }
}

}  // namespace

Vertex unpack_vertex(const Document& document, const MeshRecord& mesh, std::size_t index) {
    assert(!document.is_encoded() && index < mesh.vertex_count);
    const VertexLayout layout = vertex_layout(mesh.forms);
    const std::byte* bytes =
        document.vertices.data() + mesh.vertex_offset + index * std::size_t{layout.stride};
    Vertex vertex{};
    if (mesh.forms.position == PositionForm::quantised) {
        // Exact: the step is a power of two, and origin + q fits a float's 24 bits.
        const float step = document.scene.position_step;
        const float steps[3] = {step, step, step};
        float origin[3];
        for (int k = 0; k < 3; ++k) origin[k] = step * static_cast<float>(mesh.origin[k]);
        unpack_words(bytes, 3, origin, steps, vertex.position);
    } else {
        std::memcpy(vertex.position, bytes, sizeof vertex.position);
    }
    vertex.frame = unpack_frame(mesh.forms.frame, bytes + layout.frame_offset);
    if (mesh.forms.uv == UvForm::quantised) {
        unpack_words(bytes + layout.uv_offset, 2, mesh.uv_origin, mesh.uv_step, vertex.uv);
    } else {
        std::memcpy(vertex.uv, bytes + layout.uv_offset, sizeof vertex.uv);
    }
    if (mesh.forms.color == ColorForm::none) {
        std::ranges::fill(vertex.color, std::uint8_t{255});
    } else {
        std::memcpy(vertex.color, bytes + layout.color_offset, sizeof vertex.color);
    }
    return vertex;
}

}  // namespace mesh_format
