// Finished payloads in fewer bytes.
#pragma once

#include "cw2-bake/textures/texture.h"

namespace bake {

/// Stores the payload as mesh_format::kPartBytes says, if that takes less. The bytes depend on
/// nothing but the payload and the library's version.
void compress_payload(Texture& texture);

/// The version of the library that does it.
const char* payload_compression_library();

}  // namespace bake
