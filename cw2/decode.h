// The geometry of a compressed file, as that of any other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "mesh-format/file.h"

namespace cw2 {

/// What the sections vertices and indices of an encoded document decode to.
struct DecodedGeometry {
    std::vector<std::byte> vertices;
    std::vector<std::uint16_t> indices;
};

/// Decodes mesh by mesh, in parallel. Throws mesh_format::FileError, which calls the file `name`,
/// where the sections are damaged, or claim to be more than a thousand times their stored size.
DecodedGeometry decode(const mesh_format::Document& document, std::string_view name);

}  // namespace cw2
