// The sculpture: a lion's head with its mane, as a signed distance field.
#pragma once

#include "assets/polygonise.h"

namespace assets {

/// The head looks along +z, +y is up, the eyes are about 0.3 apart; the chest ends flat at
/// y = -kLionBottom.
inline constexpr float kLionBottom = 0.92f;
Field lion_field();

/// The head as a mesh with UVs on a sphere around it.
Mesh lion_head();

}  // namespace assets
