// What the texels of an image say of a surface's bumps.
#pragma once

#include "cw2-bake/textures/image.h"

namespace bake {

enum class Relief {
    heights,     ///< grey, but for the noise of a lossy file
    colors,      ///< neither that nor normals
    normals,     ///< unit vectors with z up, as 0.5 n + 0.5, nearly everywhere
    normals_xy,  ///< the same, but blue says nothing: z = sqrt(1 - x^2 - y^2)
    vectors,     ///< of other lengths than 1 mostly, to be normalised
};

/// Whether a bump map holds heights, as it should, or normals, as it often does. Normals average
/// to about (0, 0, 1): that tells them from a photograph of the sky.
Relief relief_of_bump(const Image& image);

/// The same of a map that is said to hold normals: what is no grey image holds some. Their z is
/// missing where it is not above 0, nearly everywhere, or 1 whatever x and y are. Grey texels,
/// which fillers may be, have no say in whether they are of length 1.
Relief relief_of_normals(const Image& image);

}  // namespace bake
