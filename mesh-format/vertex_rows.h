// The commonest forms of vertices, decoded many numbers at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh-format/index_stream.h"
#include "mesh-format/layout.h"
#include "mesh-format/surface.h"

namespace mesh_format {

/// Whether position and UV of these forms are numbers of a Place.
constexpr bool has_places(const VertexForms& forms) {
    return forms.position == PositionForm::quantised && forms.uv == UvForm::quantised;
}

/// Whether decode_rows() takes vertices of these forms.
constexpr bool are_rows(const VertexForms& forms) {
    return has_places(forms) &&
           (forms.frame == FrameForm::quat48 || forms.frame == FrameForm::quat32) &&
           forms.color == ColorForm::none;
}

/// What decode_vertices() does, with the stream's planes. `model` is that of surfaces if frames are
/// predicted from them.
void decode_rows(const MeshRecord& mesh, const SurfaceModel* model,
                 std::span<const std::uint16_t> indices, std::span<const Neighbours> neighbours,
                 const std::byte* planes, std::byte* vertices, Scratch& scratch);

}  // namespace mesh_format
