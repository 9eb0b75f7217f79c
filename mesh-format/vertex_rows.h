// The commonest forms of vertices, decoded many numbers at once.
#pragma once

#include <cstddef>
#include <span>

#include "mesh-format/index_stream.h"
#include "mesh-format/layout.h"

namespace mesh_format {

/// Whether decode_rows() is for these: vertices of eight numbers of 16 bits, none predicted from
/// what comes after it.
constexpr bool are_rows(const VertexForms& forms, FrameModel model) {
    return forms.position == PositionForm::quantised && forms.uv == UvForm::quantised &&
           (forms.frame == FrameForm::quat48 || forms.frame == FrameForm::quat32) &&
           forms.color == ColorForm::none && model != FrameModel::x_tangent_of_positions;
}

/// What decode_vertices() does, with the stream's planes.
void decode_rows(const MeshRecord& mesh, FrameModel model, std::span<const Neighbours> neighbours,
                 const std::byte* planes, std::byte* vertices, Scratch& scratch);

}  // namespace mesh_format
