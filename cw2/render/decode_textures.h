// Textures in blocks for devices that sample blocks slowly or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mesh-format/file.h"

namespace cw2 {

/// The levels of a texture as the document has them.
std::vector<std::span<const std::byte>> stored_levels(const mesh_format::Document& document,
                                                      std::uint32_t texture);

/// The same without blocks, decoded into `memory` where there are some.
std::vector<std::span<const std::byte>> texel_levels(const mesh_format::Document& document,
                                                     std::uint32_t texture,
                                                     std::vector<std::byte>& memory);

/// The levels of a texture with blocks as mesh_format::decode_block_row() leaves them, in parallel.
/// They lie in `memory`, whose earlier contents are lost.
std::vector<std::span<const std::byte>> decode_levels(
    const mesh_format::TextureRecord& record, std::span<const std::span<const std::byte>> levels,
    std::vector<std::byte>& memory);

}  // namespace cw2
