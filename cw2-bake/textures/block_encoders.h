// Texels to blocks, the row of blocks as the unit.
#pragma once

#include <cstddef>
#include <cstdint>

namespace bake {

/// A level as it is stored uncompressed: rows of texels from the top, tightly packed.
struct PlainLevel {
    const std::byte* texels;
    std::uint32_t width;
    std::uint32_t height;
};

// Each encodes the texels from row `top` on, at most 4 rows of them, and returns the sum over them
// of the squared differences of what the blocks decode to; see mesh_format::decode_block_row().
// Texels of a block beyond the level's edges are as those at the edge. The result is the same on
// every processor.

/// Four bytes a texel; the error is that of red, green and blue.
double encode_bc1_row(const PlainLevel& level, std::uint32_t top, std::byte* out);

/// The same, several times slower and nearer.
double encode_bc7_row(const PlainLevel& level, std::uint32_t top, std::byte* out);

/// One byte a texel; one at or above `limit` gets a value that is so, too, and one below it one
/// below.
double encode_bc4_row(const PlainLevel& level, std::uint32_t top, std::uint32_t limit,
                      std::byte* out);

/// Two bytes a texel, 0.5 n + 0.5 of x and y; the error is that of three components, z rebuilt, in
/// units of a byte that need not be whole.
double encode_bc5_row(const PlainLevel& level, std::uint32_t top, std::byte* out);

}  // namespace bake
