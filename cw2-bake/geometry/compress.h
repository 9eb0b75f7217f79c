// Packed geometry to the smaller form that mesh-format/layout.h describes.
#pragma once

#include <cstddef>
#include <vector>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/geometry/quantise.h"

namespace bake {

/// The sections that stand for a geometry's vertices and indices in a compressed file.
struct EncodedGeometry {
    std::vector<std::byte> vertices;
    std::vector<std::byte> indices;
};

/// Lossless; mesh by mesh in parallel, the same bytes for any number of threads.
EncodedGeometry compress(const PackedGeometry& geometry, const Advance& advance = kUnwatched);

}  // namespace bake
