#include "cw2/render/scene_textures.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>

#include "mesh-format/blocks.h"

namespace cw2 {

namespace {

using mesh_format::Document;
using mesh_format::kNoTexture;
using mesh_format::MapUse;
using mesh_format::TextureFormat;
using mesh_format::TextureRecord;

/// In the formats of what they stand for: so no kind of image is added to the scene's.
constexpr TextureFormat kWhiteFormats[] = {TextureFormat::rgba8_srgb, TextureFormat::r8_unorm,
                                           TextureFormat::rg8_unorm};

std::size_t white_for(MapUse use) {
    switch (use) {
        case MapUse::base_color:
        case MapUse::emission:
            return 0;
        case MapUse::normal:
            return 2;
        case MapUse::roughness:
        case MapUse::metalness:
        case MapUse::alpha_mask:
            return 1;
        case MapUse::count:
            break;
    }
    return 0;
}

VkFormat vulkan_format(TextureFormat format, bool decoded) {
    switch (format) {
        case TextureFormat::bc1_srgb:
            return decoded ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_BC1_RGB_SRGB_BLOCK;
        case TextureFormat::bc7_srgb:
            return decoded ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_BC7_SRGB_BLOCK;
        case TextureFormat::bc4_unorm:
            return decoded ? VK_FORMAT_R8_UNORM : VK_FORMAT_BC4_UNORM_BLOCK;
        case TextureFormat::bc5_unorm:
            return decoded ? VK_FORMAT_R8G8_UNORM : VK_FORMAT_BC5_UNORM_BLOCK;
        case TextureFormat::r8_unorm:
            return VK_FORMAT_R8_UNORM;
        case TextureFormat::rg8_unorm:
            return VK_FORMAT_R8G8_UNORM;
        case TextureFormat::rgba8_srgb:
            return VK_FORMAT_R8G8B8A8_SRGB;
    }
    return VK_FORMAT_UNDEFINED;
}

/// The same without its `count` largest levels.
TextureRecord without_levels(TextureRecord record, std::uint32_t count) {
    record.width = mesh_format::mip_extent(record.width, count);
    record.height = mesh_format::mip_extent(record.height, count);
    record.mip_count -= count;
    return record;
}

bool is_merged(MapUse use) {
    return use == MapUse::normal || use == MapUse::roughness || use == MapUse::metalness;
}

Sampler make_sampler(const Device& device, VkSamplerAddressMode mode, float anisotropy) {
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = VK_FILTER_LINEAR,
                                   .minFilter = VK_FILTER_LINEAR,
                                   .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                   .addressModeU = mode,
                                   .addressModeV = mode,
                                   .addressModeW = mode,
                                   .anisotropyEnable = anisotropy > 1.0f,
                                   .maxAnisotropy = anisotropy,
                                   .maxLod = VK_LOD_CLAMP_NONE,
                                   .borderColor = VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK};
    VkSampler sampler = VK_NULL_HANDLE;
    check(vkCreateSampler(device.get(), &info, nullptr, &sampler), "vkCreateSampler");
    return {device.get(), sampler};
}

/// Makes images that the host writes ready for that, and to be sampled.
void begin_writing(const Device& device, const std::vector<VkImage>& images) {
    const CommandPool pool = make_command_pool(device);
    const VkCommandBuffer commands = allocate_commands(device, pool.get());
    begin_commands(commands);
    for (const VkImage image : images) {
        image_barrier(commands, image, VK_IMAGE_ASPECT_COLOR_BIT,
                      {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE},
                      {VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                       VK_ACCESS_2_SHADER_SAMPLED_READ_BIT});
    }
    submit_and_wait(device, commands);
}

}  // namespace

SceneTextures::SceneTextures(const Device& device, const Document& document,
                             const TextureSettings& settings,
                             const std::vector<std::uint32_t>& first_levels)
    : settings_(settings),
      textures_(document.textures.size() + std::size(kWhiteFormats)),
      merged_of_material_(document.materials.size()),
      repeat_(make_sampler(device, VK_SAMPLER_ADDRESS_MODE_REPEAT, settings.anisotropy)),
      clamp_(make_sampler(device, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, settings.anisotropy)),
      hidden_beyond_(
          make_sampler(device, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER, settings.anisotropy)) {
    std::set<std::uint32_t> needed;
    if (settings.few_kinds) needed = merge_maps(document);
    const auto first_level = [&](std::uint32_t texture) {
        return first_levels.empty() ? 0 : first_levels[texture];
    };
    for (std::uint32_t i = 0; i < document.textures.size(); ++i) {
        if (settings.few_kinds && !needed.contains(i)) continue;
        textures_[i].stored = i;
        textures_[i].first_level = first_level(i);
        textures_[i].record = without_levels(document.textures[i], first_level(i));
    }
    for (std::size_t i = 0; i < std::size(kWhiteFormats); ++i) {
        textures_[document.textures.size() + i].record = {
            .format = kWhiteFormats[i], .width = 1, .height = 1, .mip_count = 1};
    }
    for (Texture& texture : textures_) {
        if (!texture.merged) continue;
        const TextureRecord record = record_of(document, *texture.merged);
        texture.first_level = record.mip_count;
        for (const std::uint32_t map :
             {texture.merged->normal, texture.merged->roughness, texture.merged->metalness}) {
            if (map != kNoTexture && document.textures[map].mip_count == record.mip_count)
                texture.first_level = std::min(texture.first_level, first_level(map));
        }
        if (texture.first_level == record.mip_count) texture.first_level = 0;
        texture.record = without_levels(record, texture.first_level);
    }
    for (Texture& texture : textures_) {
        TextureRecord& record = texture.record;
        texture.is_one_texel = record.width == 1 && record.height == 1;
        if (texture.is_one_texel && settings.few_kinds)
            record.width = record.height = record.mip_count = 2;
    }
    make_images(device, document);
}

/// Chooses what is merged. Returns the textures that somebody needs as they are.
std::set<std::uint32_t> SceneTextures::merge_maps(const Document& document) {
    std::set<std::uint32_t> needed;
    std::map<MergedMaps, std::size_t> known;
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        const mesh_format::PerMap<std::uint32_t>& textures = document.materials[i].textures;
        const std::optional<MergedMaps> maps = merged_maps(document, document.materials[i]);
        if (maps) {
            const auto [place, is_new] = known.try_emplace(*maps, textures_.size());
            if (is_new) textures_.emplace_back().merged = maps;
            merged_of_material_[i] = place->second;
        }
        for (std::uint32_t use = 0; use < mesh_format::kMapUseCount; ++use) {
            if (!maps || !is_merged(MapUse{use})) needed.insert(textures.values[use]);
        }
    }
    return needed;
}

bool SceneTextures::is_decoded(const Texture& texture) const {
    return settings_.decode_blocks && !texture.merged &&
           mesh_format::block_extent(texture.record.format) > 1;
}

ImageSettings SceneTextures::settings_of(const Device& device, const Texture& texture) const {
    const TextureRecord& record = texture.record;
    ImageSettings settings{.format = texture.merged
                                         ? VK_FORMAT_R8G8B8A8_UNORM
                                         : vulkan_format(record.format, is_decoded(texture)),
                           .extent = {record.width, record.height},
                           .mip_count = record.mip_count,
                           .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    settings.host_writes = host_can_write(device, settings);
    return settings;
}

void SceneTextures::make_images(const Device& device, const Document& document) {
    // Of both kinds: those that are copied to, and those that the host writes.
    std::array<std::vector<VkImage>, 2> images;
    std::array<std::vector<Texture*>, 2> textures;
    for (Texture& texture : textures_) {
        if (texture.record.mip_count == 0) continue;
        const ImageSettings settings = settings_of(device, texture);
        texture.image = make_image_handle(device, settings);
        images[settings.host_writes].push_back(texture.image.get());
        textures[settings.host_writes].push_back(&texture);
        device.name(
            texture.image.get(),
            texture.merged ? "merged maps"
            : texture.stored == kNoTexture
                ? "white"
                : fmt::format("texture {}", document.text(document.textures[texture.stored].name)));
    }
    for (const bool host_writes : {false, true}) {
        if (images[host_writes].empty()) continue;
        ImageMemory memory = bind_images(device, images[host_writes], host_writes);
        std::ranges::move(memory.blocks, std::back_inserter(memory_));
        for (std::size_t i = 0; i < memory.addresses.size(); ++i)
            textures[host_writes][i]->address = memory.addresses[i];
    }
    for (Texture& texture : textures_) {
        if (!texture.image) continue;
        ImageSettings settings = settings_of(device, texture);
        texture.view = make_image_view(device, texture.image.get(), settings);
        if (!texture.merged) continue;
        // Where the shader reads one map alone, it does so as from an image of its own.
        const VkComponentSwizzle channels[] = {VK_COMPONENT_SWIZZLE_B, VK_COMPONENT_SWIZZLE_A};
        for (std::size_t i = 0; i < 2; ++i) {
            settings.red = channels[i];
            texture.scalar_views[i] = make_image_view(device, texture.image.get(), settings);
        }
    }
    if (!images[true].empty()) begin_writing(device, images[true]);
}

/// What an image is made of; one that is not merged of the first alone.
MergedTextures SceneTextures::read(const SceneFile& file, const Texture& texture) const {
    const auto read_map = [&](std::uint32_t map) {
        if (map == kNoTexture) return StoredTexture{};
        const TextureRecord& record = file.document.textures[map];
        // Of one texel there is no other level.
        const std::uint32_t level = std::min(texture.first_level, record.mip_count - 1);
        return StoredTexture{&record, mesh_format::decode_payload(
                                          file.document, map, file.name, level,
                                          [](std::size_t count, const auto& decode_part) {
                                              tbb::parallel_for(std::size_t{0}, count, decode_part);
                                          })};
    };
    const MergedMaps maps = maps_of(texture);
    return {read_map(maps.normal), read_map(maps.roughness), read_map(maps.metalness)};
}

/// Rows of the stored level.
void SceneTextures::write_rows(const MergedTextures& source, const Texture& texture,
                               const Rows& rows) const {
    if (texture.merged) {
        merge_rows(source, rows);
    } else if (texture.stored == kNoTexture) {
        std::memset(rows.out, 255, mesh_format::block_bytes(texture.record.format));
    } else if (is_decoded(texture)) {
        decode_rows(source.normal, rows);
    } else {
        copy_rows(source.normal, rows);
    }
}

/// Rows of a level of the image, on threads.
void SceneTextures::write_level(const MergedTextures& source, const Texture& texture,
                                const Rows& rows) const {
    if (texture.is_one_texel) {
        std::array<std::byte, 16> texel;
        write_rows(source, texture, {0, 0, 1, texel.data(), texel.size()});
        const std::size_t bytes = texel_block(texture).bytes;
        const std::uint32_t width = mesh_format::mip_extent(texture.record.width, rows.level);
        for (std::uint32_t y = 0; y < rows.count; ++y) {
            for (std::uint32_t x = 0; x < width; ++x)
                std::memcpy(rows.out + y * rows.pitch + x * bytes, texel.data(), bytes);
        }
        return;
    }
    constexpr std::size_t kBytesAtOnce = 64u << 10;
    using Range = tbb::blocked_range<std::size_t>;
    const std::size_t groups = (std::size_t{rows.count} + 3) / 4;
    tbb::parallel_for(
        Range(0, groups, kBytesAtOnce / (4 * rows.pitch) + 1), [&](const Range& range) {
            const auto first = static_cast<std::uint32_t>(4 * range.begin());
            const auto end = static_cast<std::uint32_t>(4 * range.end());
            write_rows(
                source, texture,
                {rows.level + texture.first_level, rows.first + first,
                 std::min(end, rows.count) - first, rows.out + first * rows.pitch, rows.pitch});
        });
}

TexelBlock SceneTextures::texel_block(const Texture& texture) const {
    if (texture.merged) return {1, 4};
    const TextureFormat format = texture.record.format;
    return is_decoded(texture)
               ? TexelBlock{1, mesh_format::decoded_texel_bytes(format)}
               : TexelBlock{mesh_format::block_extent(format), mesh_format::block_bytes(format)};
}

/// What it is made of; where it is not merged the first alone.
MergedMaps SceneTextures::maps_of(const Texture& texture) {
    return texture.merged.value_or(MergedMaps{texture.stored, kNoTexture, kNoTexture});
}

void SceneTextures::forget(const SceneFile& file, const Texture& texture) {
    const MergedMaps maps = maps_of(texture);
    for (const std::uint32_t map : {maps.normal, maps.roughness, maps.metalness}) {
        if (map != kNoTexture) file.forget(file.document.payload(file.document.textures[map]));
    }
}

void SceneTextures::write(const Device& device, const SceneFile& file) const {
    std::optional<Uploader> uploader;
    for (const Texture& texture : textures_) {
        if (!texture.image) continue;
        const MergedTextures source = read(file, texture);
        const TextureRecord& record = texture.record;
        const TexelBlock block = texel_block(texture);
        const auto row_count = [&](std::uint32_t level) {
            return (mesh_format::mip_extent(record.height, level) + block.extent - 1) /
                   block.extent;
        };
        if (texture.address) {
            for (std::uint32_t level = 0; level < record.mip_count; ++level) {
                const LevelPlace place = level_place(device, texture.image.get(), level);
                write_level(
                    source, texture,
                    {level, 0, row_count(level), texture.address + place.offset, place.pitch});
            }
            forget(file, texture);
            continue;
        }
        if (!uploader) uploader.emplace(device);
        uploader->write_image(
            texture.image.get(), settings_of(device, texture), block,
            [&](std::uint32_t level, std::uint32_t first, std::uint32_t count, std::byte* out) {
                const std::uint32_t width = mesh_format::mip_extent(record.width, level);
                const std::size_t pitch =
                    std::size_t{(width + block.extent - 1) / block.extent} * block.bytes;
                write_level(source, texture, {level, first, count, out, pitch});
            });
        forget(file, texture);
    }
    if (uploader) uploader->finish();
}

VkDescriptorImageInfo SceneTextures::descriptor(const Document& document, std::size_t material,
                                                MapUse use) const {
    const std::size_t merged = is_merged(use) ? merged_of_material_[material] : 0;
    const std::uint32_t stored = document.materials[material].textures[use];
    const Texture& texture =
        textures_[merged != 0            ? merged
                  : stored == kNoTexture ? document.textures.size() + white_for(use)
                                         : stored];
    const ImageView& view = merged != 0 && use != MapUse::normal
                                ? texture.scalar_views[use == MapUse::metalness]
                                : texture.view;
    const std::uint32_t flags = texture.record.flags;
    const Sampler& sampler = flags & mesh_format::kHiddenBeyond  ? hidden_beyond_
                             : flags & mesh_format::kClampToEdge ? clamp_
                                                                 : repeat_;
    return {sampler.get(), view.get(),
            texture.address ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
}

VkDeviceSize SceneTextures::bytes() const {
    VkDeviceSize bytes = 0;
    for (const Memory& memory : memory_) bytes += memory.bytes();
    return bytes;
}

}  // namespace cw2
