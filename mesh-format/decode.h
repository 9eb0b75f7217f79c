// The geometry of a compressed file, as that of any other. A library of its own: it needs more than
// the standard library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "mesh-format/file.h"

namespace mesh_format {

/// What the sections vertices and indices of an encoded document decode to.
struct DecodedGeometry {
    std::unique_ptr<std::byte[]> vertices;
    std::unique_ptr<std::uint16_t[]> indices;
};

/// Decodes an encoded document mesh by mesh, in parallel, and checks the result, which `document`
/// then refers to; leaves any other as it is. Throws FormatError, which calls the file `name`,
/// where the sections are damaged, or claim to be more than a thousand times the size of what is
/// stored of them and of the chunks.
DecodedGeometry decode(Document& document, std::string_view name);

}  // namespace mesh_format
