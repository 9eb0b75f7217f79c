#include "cw2/render/decode_textures.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh-format/blocks.h"

namespace cw2 {

namespace {

constexpr std::uint32_t kBlock = 4;

}  // namespace

std::vector<std::span<const std::byte>> decode_levels(
    const mesh_format::TextureRecord& record, std::span<const std::span<const std::byte>> levels,
    std::vector<std::byte>& memory) {
    const std::size_t texel = mesh_format::decoded_texel_bytes(record.format);
    std::vector<std::size_t> offsets{0};
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
        offsets.push_back(offsets.back() + texel * mesh_format::mip_extent(record.width, i) *
                                               mesh_format::mip_extent(record.height, i));
    }
    // No smaller, so that memory that is used again is not cleared again.
    memory.resize(std::max(memory.size(), offsets.back()));
    std::vector<std::span<const std::byte>> decoded;
    for (std::uint32_t i = 0; i < levels.size(); ++i) {
        const std::uint32_t width = mesh_format::mip_extent(record.width, i);
        const std::uint32_t height = mesh_format::mip_extent(record.height, i);
        const std::size_t row_bytes = std::size_t{mesh_format::block_count(record.format, width)} *
                                      mesh_format::block_bytes(record.format);
        tbb::parallel_for(std::uint32_t{0}, mesh_format::block_count(record.format, height),
                          [&](std::uint32_t row) {
                              const std::uint32_t y = row * kBlock;
                              mesh_format::decode_block_row(
                                  record.format, levels[i].data() + row * row_bytes, width,
                                  std::min(height - y, kBlock),
                                  memory.data() + offsets[i] + texel * width * y);
                          });
        decoded.push_back(std::span(memory).subspan(offsets[i], offsets[i + 1] - offsets[i]));
    }
    return decoded;
}

std::vector<std::span<const std::byte>> stored_levels(const mesh_format::Document& document,
                                                      std::uint32_t texture) {
    const mesh_format::TextureRecord& record = document.textures[texture];
    std::vector<std::span<const std::byte>> levels;
    std::uint64_t offset = record.offset;
    for (std::uint32_t level = 0; level < record.mip_count; ++level) {
        const std::uint64_t bytes =
            mesh_format::mip_bytes(record.format, record.width, record.height, level);
        levels.push_back(document.texels.subspan(offset, bytes));
        offset += bytes;
    }
    return levels;
}

std::vector<std::span<const std::byte>> texel_levels(const mesh_format::Document& document,
                                                     std::uint32_t texture,
                                                     std::vector<std::byte>& memory) {
    const mesh_format::TextureRecord& record = document.textures[texture];
    const auto levels = stored_levels(document, texture);
    return mesh_format::block_extent(record.format) > 1 ? decode_levels(record, levels, memory)
                                                        : levels;
}

}  // namespace cw2
