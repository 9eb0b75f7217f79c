// The statements of a whole OBJ text, parsed in pieces in parallel and strung together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/chunk.h"

namespace bake {

/// What an OBJ states. Indices are from 0, all in range. The result does not depend on the size of
/// the pieces or on the number of threads.
struct ObjContents {
    /// Positions, normals (of length 1, or 0), uvs, corners, triangle_material and, where a normal
    /// may be missing, without_normals are filled.
    SourceScene scene;
    std::vector<ObjPolygon> polygons;             ///< faces of more than three corners, as fans
    std::vector<ObjSmoothingUse> smoothing_uses;  ///< in the order of their triangles
    /// One a position, as in SourceScene::colors, 0 where it has none; empty if none has.
    std::vector<std::uint32_t> colors;
    std::vector<std::string> material_names;  ///< in order of first use
    /// Of the first `usemtl` of each material; none for that of faces before any.
    std::vector<std::optional<std::size_t>> material_offsets;
    std::vector<ObjStatement> libraries;  ///< mtllib
    std::vector<ObjError> warnings;       ///< in the order of the text
    LineCounter lines{{}};                ///< of the text
};

/// Parses `text` in pieces of about `chunk_bytes`, on as many threads as TBB is allowed; `name` is
/// used in messages. Positions are those of the text less `origin`. Memory mapped for `text` is
/// given back as the parsing goes on (it must be a read-only mapping of a file). Throws BakeError
/// at the first malformed statement, then at the first index of a position that is out of range. A
/// UV or a normal whose index is out of range, or whose line holds no finite numbers, is absent,
/// with a warning.
ObjContents parse_obj(std::string_view text, const std::string& name, std::size_t chunk_bytes,
                      const glm::dvec3& origin = glm::dvec3(0.0),
                      const Advance& advance = kUnwatched);

}  // namespace bake
