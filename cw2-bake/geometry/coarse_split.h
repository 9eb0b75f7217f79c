// The first cuts of what is too much to be cut as a whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/geometry/framed_scene.h"

namespace bake {

/// The triangles of a scene in parts of at most kMostTriangles of one material, as halving a
/// material's triangles (see halve()) comes to them.
struct CoarseParts {
    static constexpr std::size_t kMostTriangles = 1 << 18;

    struct Part {
        std::uint32_t material;
        std::size_t first;  ///< in `triangles`
        std::size_t size;
    };
    std::vector<Part> parts;             ///< a material's behind those of the one before
    RawVector<std::uint32_t> triangles;  ///< part after part, ascending in each

    std::span<const std::uint32_t> triangles_of(const Part& part) const {
        return std::span(triangles).subspan(part.first, part.size);
    }
};

CoarseParts split_coarsely(const FramedScene& scene);

}  // namespace bake
