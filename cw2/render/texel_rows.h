// Rows of textures as a device keeps them: as they are stored, without their blocks, or merged.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "mesh-format/decode.h"
#include "mesh-format/file.h"

namespace cw2 {

/// Rows of a level, of texels, or of blocks where the image has some, and where they go.
struct Rows {
    std::uint32_t level;  ///< of the stored texture
    std::uint32_t first;
    std::uint32_t count;
    std::byte* out;
    std::size_t pitch;  ///< bytes from a row to the next
};

/// A texture of a file.
struct StoredTexture {
    const mesh_format::TextureRecord* record = nullptr;  ///< null for none
    mesh_format::Payload payload{};                      ///< of the levels that are needed
};

/// As they are stored.
void copy_rows(const StoredTexture& texture, const Rows& rows);

/// Texels as mesh_format::decode_block_row() leaves them. The first row is a multiple of 4, and so
/// is the count unless the level ends with them.
void decode_rows(const StoredTexture& texture, const Rows& rows);

/// Maps that a fragment reads one by one, in one image: for devices on which every read counts.
/// Textures of a material whose texels lie at the same places: indices into the document's, or
/// mesh_format::kNoTexture.
struct MergedMaps {
    std::uint32_t normal;
    std::uint32_t roughness;
    std::uint32_t metalness;
    auto operator<=>(const MergedMaps&) const = default;
};

/// The textures that these are; one that is absent has no record.
struct MergedTextures {
    StoredTexture normal;
    StoredTexture roughness;
    StoredTexture metalness;
};

/// Nothing where maps of more than a texel differ in size or in what happens at their borders.
std::optional<MergedMaps> merged_maps(const mesh_format::Document& document,
                                      const mesh_format::MaterialRecord& material);

/// Size, levels and flags of the merged image.
mesh_format::TextureRecord record_of(const mesh_format::Document& document, const MergedMaps& maps);

/// Rows as of decode_rows(), 8 bits a channel: x and y of the normal, roughness, metalness; 255 for
/// what is absent.
void merge_rows(const MergedTextures& maps, const Rows& rows);

}  // namespace cw2
