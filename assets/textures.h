// The demo scene's materials and the texture sets they use.
#pragma once

#include <vector>

#include "assets/image.h"
#include "assets/mesh_writer.h"

namespace assets {

std::vector<TextureSet> stone_textures();
std::vector<TextureSet> ceramic_textures();
std::vector<TextureSet> metal_textures();
std::vector<TextureSet> cloth_and_wood_textures();
std::vector<TextureSet> leaf_textures();

/// All of the above.
std::vector<TextureSet> texture_sets();

/// What the MTL states; maps are named in the folder textures/.
std::vector<MaterialStatement> materials();

}  // namespace assets
