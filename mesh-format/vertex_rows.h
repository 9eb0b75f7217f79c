// The commonest forms of vertices, decoded many numbers at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh-format/index_stream.h"
#include "mesh-format/layout.h"

namespace mesh_format {

/// Whether positions and UVs of these forms are numbers of rows.
constexpr bool has_rows(const VertexForms& forms) {
    return forms.position == PositionForm::quantised && forms.uv == UvForm::quantised;
}

/// Whether all of a vertex of these forms is a row.
constexpr bool are_rows(const VertexForms& forms) {
    return has_rows(forms) &&
           (forms.frame == FrameForm::quat48 || forms.frame == FrameForm::quat32) &&
           forms.color == ColorForm::none;
}

/// What decode_vertices() does, with the stream's planes.
void decode_rows(const MeshRecord& mesh, FrameModel model, int area_shift,
                 std::span<const std::uint16_t> indices, std::span<const Neighbours> neighbours,
                 const std::byte* planes, std::byte* vertices, Scratch& scratch);

}  // namespace mesh_format
