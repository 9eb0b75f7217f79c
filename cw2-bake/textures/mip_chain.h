// Mip chains by exact area averages: a texel of a level is the mean of what it covers of the level
// above it, so every level keeps the mean of level 0, for odd sizes too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "mesh-format/layout.h"

namespace bake {

/// One level: rows from the top, channels interleaved.
struct Level {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t channels = 0;
    std::vector<float> texels;

    std::span<float> row(std::uint32_t y) {
        const std::size_t length = std::size_t{width} * channels;
        return {texels.data() + y * length, length};
    }
};

/// Level 0 row by row, so that it is never in memory as floats: fills `texels` with row y.
using RowSource = std::function<void(std::uint32_t y, std::span<float> texels)>;

/// Level 0 as its texture stores it, where that is known without filtering: fills a row.
using StoredRowSource = std::function<void(std::uint32_t y, std::byte* out)>;

/// What level 0 is, and how its rows are read.
struct TexelSource {
    std::uint32_t width;
    std::uint32_t height;
    std::uint32_t channels;
    RowSource read_row;
    StoredRowSource read_stored_row{};  ///< what an encoder would make of read_row(); may be empty
};

/// Writes one row of filtered texels as a texture's bytes.
using RowEncoder = std::function<void(std::span<const float> texels, std::byte* out)>;

/// The next level: the area average of `source`, each of whose rows is read once, in order.
Level halve(const TexelSource& source);

/// The texels of `level`, which must outlive the source.
TexelSource source_of(Level& level);

/// The complete payload of a texture, as mesh_format::TextureRecord describes it. Rows of level 0
/// are encoded as they are read, unless the source has them as they are stored.
std::vector<std::byte> filter_chain(mesh_format::TextureFormat format, const TexelSource& source,
                                    const RowEncoder& encode);

/// How an alpha mask will be sampled.
struct MaskUse {
    float cutoff;         ///< what is below is hidden
    bool clamp = false;   ///< the texture does not repeat; beyond hidden edges it is 0
    bool blocks = false;  ///< compress_to_blocks() will be asked to store it
};

/// The payload of an alpha mask (r8_unorm; values in [0, 1]): each level shows what level 0 shows
/// at `cutoff`; see mask_coverage.h. After Castano, "Computing alpha mipmaps", 2010, who scales a
/// level until as many of its texels are shown; between them small leaves would vanish.
std::vector<std::byte> filter_mask(const TexelSource& source, const MaskUse& use);

/// Whether all that lies along the edges of a mask's level 0, which `texels` begins with, is
/// hidden.
bool hides_its_edges(std::span<const std::byte> texels, std::uint32_t width, std::uint32_t height,
                     float cutoff);

/// The payload of the base colour (rgba8_srgb) under an alpha mask. `source` has four channels:
/// linear red, green and blue, and 1; or four times 0 where the mask hides the texel. At least one
/// is shown. Hidden texels count nowhere; at every level, 0 too, they continue the colours beside
/// them, so that no filter draws a hidden colour into sight. `clamp`: the texture does not repeat.
std::vector<std::byte> filter_masked_color(const TexelSource& source, bool clamp);

/// The smallest byte that a shader sees at or above `cutoff`.
std::uint32_t cutoff_byte(float cutoff);

/// The smallest value that is at or above `cutoff` once it is stored in 8 bits.
float shown_from(float cutoff);

/// Encoders: values in [0, 1] to r8_unorm; linear RGB to rgba8_srgb, alpha 255; vectors of any
/// length to x and y of unit vectors in rg8_unorm as 0.5 n + 0.5, no vector as (0, 0, 1).
void encode_unorm8(std::span<const float> texels, std::byte* out);
void encode_srgb8(std::span<const float> texels, std::byte* out);
void encode_normal8(std::span<const float> texels, std::byte* out);

}  // namespace bake
