#include "cw2/render/texel_rows.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "mesh-format/blocks.h"

namespace cw2 {

namespace {

using mesh_format::kNoTexture;
using mesh_format::MapUse;
using mesh_format::TextureFormat;
using mesh_format::TextureRecord;

constexpr std::uint32_t kBlock = 4;

std::size_t row_bytes(const TextureRecord& record, std::uint32_t level) {
    const std::uint32_t width = mesh_format::mip_extent(record.width, level);
    return std::size_t{mesh_format::block_count(record.format, width)} *
           mesh_format::block_bytes(record.format);
}

/// Of a level of a texture, where `row` of its rows of blocks begins.
const std::byte* stored_row(const StoredTexture& texture, std::uint32_t level, std::uint32_t row) {
    const TextureRecord& record = *texture.record;
    std::uint64_t offset = 0;
    for (std::uint32_t i = 0; i < level; ++i)
        offset += mesh_format::mip_bytes(record.format, record.width, record.height, i);
    return texture.payload.bytes.data() + offset + row * row_bytes(record, level);
}

bool in_blocks(const TextureRecord& record) {
    return mesh_format::block_extent(record.format) > 1;
}

bool is_one_texel(const TextureRecord& record) {
    return record.width == 1 && record.height == 1;
}

/// One channel or two of a map, four rows at a time; a map of one texel has it everywhere.
class MapRows {
 public:
    MapRows(const StoredTexture& texture, std::uint32_t level, std::uint32_t width)
        : texture_(texture), level_(level), is_read_(!texture.record) {
        if (is_read_) return;
        const TextureRecord& record = *texture.record;
        const std::size_t texel = in_blocks(record)
                                      ? mesh_format::decoded_texel_bytes(record.format)
                                      : mesh_format::block_bytes(record.format);
        pitch_ = width * texel;
        texels_.resize(kBlock * pitch_);
        if (!is_one_texel(record)) return;
        level_ = 0;
        read_rows(0, 1);
        for (std::size_t i = texel; i < texels_.size(); ++i) texels_[i] = texels_[i - texel];
        is_read_ = true;
    }
    void read(std::uint32_t first, std::uint32_t count) {
        if (!is_read_) read_rows(first, count);
    }
    /// Null where there is no such map.
    const std::byte* row(std::uint32_t y) const {
        return texels_.empty() ? nullptr : texels_.data() + y * pitch_;
    }

 private:
    void read_rows(std::uint32_t first, std::uint32_t count) {
        const Rows rows{level_, first, count, texels_.data(), pitch_};
        in_blocks(*texture_.record) ? decode_rows(texture_, rows) : copy_rows(texture_, rows);
    }

    const StoredTexture& texture_;
    std::uint32_t level_;
    bool is_read_;  ///< all of it
    std::size_t pitch_ = 0;
    std::vector<std::byte> texels_;
};

}  // namespace

void copy_rows(const StoredTexture& texture, const Rows& rows) {
    const std::size_t bytes = row_bytes(*texture.record, rows.level);
    const std::byte* from = stored_row(texture, rows.level, rows.first);
    for (std::uint32_t y = 0; y < rows.count; ++y)
        std::memcpy(rows.out + y * rows.pitch, from + y * bytes, bytes);
}

void decode_rows(const StoredTexture& texture, const Rows& rows) {
    const TextureRecord& record = *texture.record;
    const std::size_t bytes = row_bytes(record, rows.level);
    const std::uint32_t width = mesh_format::mip_extent(record.width, rows.level);
    const std::byte* blocks = stored_row(texture, rows.level, rows.first / kBlock);
    for (std::uint32_t y = 0; y < rows.count; y += kBlock, blocks += bytes)
        mesh_format::decode_block_row(record.format, blocks, width,
                                      std::min(rows.count - y, kBlock), rows.out + y * rows.pitch,
                                      rows.pitch);
}

std::optional<MergedMaps> merged_maps(const mesh_format::Document& document,
                                      const mesh_format::MaterialRecord& material) {
    const MergedMaps maps{material.textures[MapUse::normal], material.textures[MapUse::roughness],
                          material.textures[MapUse::metalness]};
    const TextureRecord whole = record_of(document, maps);
    for (const std::uint32_t map : {maps.normal, maps.roughness, maps.metalness}) {
        if (map == kNoTexture || is_one_texel(document.textures[map])) continue;
        const TextureRecord& record = document.textures[map];
        if (record.width != whole.width || record.height != whole.height ||
            ((record.flags ^ whole.flags) & ~mesh_format::kCompressed) != 0)
            return std::nullopt;
    }
    return maps;
}

TextureRecord record_of(const mesh_format::Document& document, const MergedMaps& maps) {
    TextureRecord whole{.width = 1, .height = 1, .mip_count = 1};
    for (const std::uint32_t map : {maps.normal, maps.roughness, maps.metalness}) {
        if (map != kNoTexture && is_one_texel(whole)) whole = document.textures[map];
    }
    return whole;
}

void merge_rows(const MergedTextures& maps, const Rows& rows) {
    std::uint32_t width = 1;
    for (const StoredTexture* map : {&maps.normal, &maps.roughness, &maps.metalness}) {
        if (map->record)
            width = std::max(width, mesh_format::mip_extent(map->record->width, rows.level));
    }
    const auto map_rows = [&](const StoredTexture& map) { return MapRows(map, rows.level, width); };
    MapRows normal = map_rows(maps.normal);
    std::array<MapRows, 2> scalars{map_rows(maps.roughness), map_rows(maps.metalness)};
    for (std::uint32_t y = 0; y < rows.count; y += kBlock) {
        const std::uint32_t count = std::min(rows.count - y, kBlock);
        normal.read(rows.first + y, count);
        for (MapRows& map : scalars) map.read(rows.first + y, count);
        for (std::uint32_t i = 0; i < count; ++i) {
            constexpr std::byte kOne{255};
            std::byte* out = rows.out + (y + i) * rows.pitch;
            const std::byte* const xy = normal.row(i);
            const std::byte* const roughness = scalars[0].row(i);
            const std::byte* const metalness = scalars[1].row(i);
            for (std::size_t x = 0; x < width; ++x, out += 4) {
                out[0] = xy ? xy[2 * x] : kOne;
                out[1] = xy ? xy[2 * x + 1] : kOne;
                out[2] = roughness ? roughness[x] : kOne;
                out[3] = metalness ? metalness[x] : kOne;
            }
        }
    }
}

}  // namespace cw2
