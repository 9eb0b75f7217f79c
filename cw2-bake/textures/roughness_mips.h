// Roughness under a normal map: where a texel covers many bumps, the bumps become roughness.
#pragma once

#include <cstddef>
#include <vector>

#include "cw2-bake/textures/mip_chain.h"

namespace bake {

/// How long the mean of the unit vectors is that a texel of a normal map covers: the shorter, the
/// more they differ.
struct MeanLengths {
    std::uint32_t width;  ///< of the normal map
    std::uint32_t height;
    std::vector<Level> levels;  ///< of its mip chain from level 1 on, one channel
};

MeanLengths mean_lengths(const TexelSource& normals);

/// For filter_chain() on normals: `encode`, which also fills in the levels of `lengths`, as
/// mean_lengths() would. Width and height are set before.
RowEncoder measuring(RowEncoder encode, MeanLengths& lengths);

/// The roughness whose highlight is about as wide as that of roughness `alpha` on normals whose
/// mean has the length `length`, in (0, 1]. After Toksvig, "Mipmapping normal maps", 2005: the
/// Blinn-Phong exponent s = 2 / alpha^4 - 2 becomes s length / (length + s (1 - length)).
float widened_roughness(float alpha, float length);

struct RoughnessChain {
    std::vector<std::byte> payload;  ///< of a texture in r8_unorm
    bool widened;                    ///< a texel differs visibly from what plain averages would be
};

/// The mip chain of `factor` times `alphas`, each level widened by the bumps that its texels cover,
/// of which half is counted; level 0 and what is larger than the normal map cover none.
RoughnessChain filter_roughness(const TexelSource& alphas, float factor, MeanLengths& lengths);

}  // namespace bake
