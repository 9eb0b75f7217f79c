// Texels to a PNG file in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace bake {

/// `texels` are rows from the top, tightly packed, of 3 (red, green, blue) or 4 (and alpha)
/// channels of 8 bits. Throws mesh_format::FileError.
std::vector<std::byte> encode_png(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                                  std::span<const std::byte> texels);

}  // namespace bake
