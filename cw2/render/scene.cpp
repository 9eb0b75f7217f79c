#include "cw2/render/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <glm/gtc/type_ptr.hpp>

#include "common/lfs_pointer.h"
#include "cw2/render/decode_textures.h"
#include "cw2/render/merged_maps.h"
#include "cw2/render/vertex_positions.h"
#include "mesh-format/blocks.h"
#include "mesh-format/decode.h"

namespace cw2 {

namespace {

using mesh_format::Document;
using mesh_format::MapUse;
using mesh_format::MaterialRecord;
using mesh_format::MeshRecord;
using mesh_format::TextureFormat;
using mesh_format::TextureRecord;

VkFormat vulkan_format(TextureFormat format, bool decoded) {
    switch (format) {
        case TextureFormat::bc1_srgb:
            return decoded ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_BC1_RGB_SRGB_BLOCK;
        case TextureFormat::bc4_unorm:
            return decoded ? VK_FORMAT_R8_UNORM : VK_FORMAT_BC4_UNORM_BLOCK;
        case TextureFormat::bc5_unorm:
            return decoded ? VK_FORMAT_R8G8_UNORM : VK_FORMAT_BC5_UNORM_BLOCK;
        case TextureFormat::r8_unorm:
            return VK_FORMAT_R8_UNORM;
        case TextureFormat::rgba8_unorm:
            return VK_FORMAT_R8G8B8A8_UNORM;
        case TextureFormat::rgba8_srgb:
            return VK_FORMAT_R8G8B8A8_SRGB;
    }
    return VK_FORMAT_UNDEFINED;
}

bool in_blocks(const TextureRecord& record) {
    return mesh_format::block_extent(record.format) > 1;
}

ImageSettings image_settings(const TextureRecord& record, bool decode_blocks) {
    return {.format = vulkan_format(record.format, decode_blocks),
            .extent = {record.width, record.height},
            .mip_count = record.mip_count,
            .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
}

/// Of the image of merged maps.
TextureRecord merged_record(TextureRecord normal) {
    normal.format = TextureFormat::rgba8_unorm;
    return normal;
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
                                   .maxLod = VK_LOD_CLAMP_NONE};
    VkSampler sampler = VK_NULL_HANDLE;
    check(vkCreateSampler(device.get(), &info, nullptr, &sampler), "vkCreateSampler");
    return {device.get(), sampler};
}

Shading shading_of(const MaterialRecord& material) {
    if (glm::make_vec3(material.emission) != glm::vec3(0.0f)) return Shading::emissive;
    return material.flags & mesh_format::kAlphaMask ? Shading::alpha_mask : Shading::opaque;
}

std::uint32_t normal_map_of(const Document& document, const MaterialRecord& material) {
    if (material.textures[MapUse::normal] == mesh_format::kNoTexture)
        return interop::kNormalMapAbsent;
    return document.textures[material.textures[MapUse::normal]].format == TextureFormat::bc5_unorm
               ? interop::kNormalMapXy
               : interop::kNormalMapXyz;
}

interop::DrawConstants constants_of(const Document& document, const MeshRecord& mesh,
                                    const MaterialRecord& material) {
    interop::DrawConstants constants{};
    constants.position_origin = glm::make_vec3(mesh.origin);
    constants.position_step = document.scene.position_step;
    constants.uv_origin = glm::make_vec2(mesh.uv_origin);
    constants.uv_step = glm::make_vec2(mesh.uv_step);
    constants.base_color = glm::make_vec3(material.base_color);
    constants.emission = glm::make_vec3(material.emission);
    constants.roughness = material.roughness;
    constants.metalness = material.metalness;
    constants.alpha_cutoff = material.alpha_cutoff;
    constants.normal_map = normal_map_of(document, material);
    constants.normal_scale = material.normal_scale;
    constants.back_normals = material.flags & mesh_format::kFlipBackNormals ? -1.0f : 1.0f;
    constants.material = mesh.material;
    return constants;
}

Buffer upload_buffer(const Device& device, Uploader& uploader, std::span<const std::byte> bytes,
                     VkBufferUsageFlags usage) {
    Buffer buffer = make_buffer(device, std::max<std::size_t>(bytes.size(), 4),
                                usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::device);
    uploader.write_buffer(buffer.handle.get(), bytes);
    return buffer;
}

}  // namespace

Scene::Scene(const Device& device, const Layouts& layouts, const Document& document,
             const TextureSettings& settings)
    : positions_(vertex_positions(document)),
      bounds_(bounds_of(document.scene, positions_)),
      start_(start_of(document.scene)),
      repeat_(make_sampler(device, VK_SAMPLER_ADDRESS_MODE_REPEAT, settings.anisotropy)),
      clamp_(make_sampler(device, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, settings.anisotropy)) {
    Uploader uploader(device);
    vertices_ =
        upload_buffer(device, uploader, document.vertices, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    indices_ = upload_buffer(device, uploader, std::as_bytes(document.indices),
                             VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    device.name(vertices_.handle.get(), "scene vertices");
    device.name(indices_.handle.get(), "scene indices");
    upload_textures(device, document, settings, uploader);
    uploader.finish();

    for (const MaterialRecord& material : document.materials) {
        material_names_.emplace_back(document.text(material.name));
    }
    const std::vector<VkDescriptorSet> sets = make_material_sets(device, layouts, document);
    for (const MeshRecord& mesh : document.meshes) {
        const MaterialRecord& material = document.materials[mesh.material];
        for (const auto& chunk : document.chunks.subspan(mesh.first_chunk, mesh.chunk_count)) {
            chunks_.push_back({.center = glm::make_vec3(chunk.center),
                               .radius = chunk.radius,
                               .cone_axis = glm::make_vec3(chunk.cone_axis),
                               .cone_cutoff = chunk.cone_cutoff,
                               .draw = static_cast<std::uint32_t>(draws_.size()),
                               .first_index = chunk.first_index,
                               .index_count = chunk.index_count});
        }
        draws_.push_back({.constants = constants_of(document, mesh, material),
                          .forms = mesh.forms,
                          .shading = shading_of(material),
                          .alpha_mask = (material.flags & mesh_format::kAlphaMask) != 0,
                          .merged_maps = merged_of_material_[mesh.material] != merged_.end(),
                          .unlit = (material.flags & mesh_format::kUnlit) != 0,
                          .cull_back = (material.flags & mesh_format::kCullBack) != 0,
                          .material = sets[mesh.material],
                          .vertex_offset = mesh.vertex_offset,
                          .index_offset = mesh.first_index * sizeof(std::uint16_t),
                          .vertex_count = mesh.vertex_count});
    }
}

std::set<std::uint32_t> Scene::merge_maps(const Document& document) {
    std::set<std::uint32_t> needed;
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        const mesh_format::PerMap<std::uint32_t>& textures = document.materials[i].textures;
        const std::optional<MergedMaps> maps = merged_maps(document, document.materials[i]);
        if (maps) merged_of_material_[i] = merged_.try_emplace(*maps).first;
        for (std::uint32_t use = 0; use < mesh_format::kMapUseCount; ++use) {
            if (!maps || !is_merged(MapUse{use})) needed.insert(textures.values[use]);
        }
    }
    return needed;
}

void Scene::upload_textures(const Device& device, const Document& document,
                            const TextureSettings& settings, Uploader& uploader) {
    static constexpr std::byte kWhite[4] = {std::byte{255}, std::byte{255}, std::byte{255},
                                            std::byte{255}};
    constexpr TextureRecord kWhiteTexel{
        .format = TextureFormat::rgba8_unorm, .width = 1, .height = 1, .mip_count = 1};
    merged_of_material_.assign(document.materials.size(), merged_.end());
    std::set<std::uint32_t> needed;
    if (settings.merge_maps) needed = merge_maps(document);
    std::vector<VkImage> images;
    const auto add = [&](const TextureRecord& record, Texture& texture, const std::string& name) {
        texture.image = make_image_handle(device, image_settings(record, settings.decode_blocks));
        texture.clamp = (record.flags & mesh_format::kClampToEdge) != 0;
        images.push_back(texture.image.get());
        device.name(images.back(), name);
    };
    textures_.resize(document.textures.size() + 1);
    const auto is_needed = [&](std::uint32_t i) {
        return !settings.merge_maps || needed.contains(i);
    };
    for (std::uint32_t i = 0; i < document.textures.size(); ++i) {
        const TextureRecord& record = document.textures[i];
        if (is_needed(i))
            add(record, textures_[i], fmt::format("texture {}", document.text(record.name)));
    }
    add(kWhiteTexel, textures_.back(), "white texel");
    for (auto& [maps, texture] : merged_) {
        const TextureRecord& normal = document.textures[maps.normal];
        add(merged_record(normal), texture,
            fmt::format("merged texture {}", document.text(normal.name)));
    }
    texture_memory_ = bind_images(device, images);

    std::vector<std::byte> decoded;
    const auto upload = [&](Texture& texture, const TextureRecord& record, const TexelBlock& block,
                            std::span<const std::span<const std::byte>> levels) {
        uploader.write_image(texture.image.get(), {record.width, record.height}, block, levels);
        texture.view = make_image_view(device, texture.image.get(),
                                       image_settings(record, settings.decode_blocks));
    };
    for (std::uint32_t i = 0; i < document.textures.size(); ++i) {
        const TextureRecord& record = document.textures[i];
        if (!is_needed(i)) continue;
        if (settings.decode_blocks && in_blocks(record)) {
            upload(textures_[i], record, {1, mesh_format::decoded_texel_bytes(record.format)},
                   texel_levels(document, i, decoded));
        } else {
            upload(
                textures_[i], record,
                {mesh_format::block_extent(record.format), mesh_format::block_bytes(record.format)},
                stored_levels(document, i));
        }
    }
    upload(textures_.back(), kWhiteTexel, {1, 4}, std::array{std::span<const std::byte>(kWhite)});
    for (auto& [maps, texture] : merged_) {
        const TextureRecord record = merged_record(document.textures[maps.normal]);
        upload(texture, record, {1, 4}, merged_levels(document, maps, decoded));
        // Where the shader reads one map alone, it does so as from an image of its own.
        const VkComponentSwizzle channels[] = {VK_COMPONENT_SWIZZLE_B, VK_COMPONENT_SWIZZLE_A};
        for (std::size_t i = 0; i < 2; ++i) {
            ImageSettings own = image_settings(record, false);
            own.red = channels[i];
            texture.scalar_views[i] = make_image_view(device, texture.image.get(), own);
        }
    }
}

std::vector<VkDescriptorSet> Scene::make_material_sets(const Device& device, const Layouts& layouts,
                                                       const Document& document) {
    const auto set_count = static_cast<std::uint32_t>(document.materials.size());
    descriptor_pool_ = make_descriptor_pool(device, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                            mesh_format::kMapUseCount * set_count, set_count);
    std::vector<VkDescriptorSet> sets;
    for (std::size_t i = 0; i < document.materials.size(); ++i) {
        const MaterialRecord& material = document.materials[i];
        const VkDescriptorSet set = allocate_set(device, descriptor_pool_.get(),
                                                 layouts.material_set(shading_of(material)));
        device.name(set, fmt::format("material {}", document.text(material.name)));
        write_material_set(device, set, material, i);
        sets.push_back(set);
    }
    return sets;
}

void Scene::write_material_set(const Device& device, VkDescriptorSet set,
                               const MaterialRecord& material, std::size_t number) const {
    const auto merged = merged_of_material_[number];
    std::array<VkDescriptorImageInfo, mesh_format::kMapUseCount> images;
    std::array<VkWriteDescriptorSet, mesh_format::kMapUseCount> writes;
    const std::uint32_t count = map_count(shading_of(material));
    for (std::uint32_t use = 0; use < count; ++use) {
        const std::uint32_t index = material.textures.values[use];
        const bool is_part = merged != merged_.end() && is_merged(MapUse{use});
        const Texture& texture = is_part                            ? merged->second
                                 : index == mesh_format::kNoTexture ? textures_.back()
                                                                    : textures_[index];
        const bool is_scalar = is_part && MapUse{use} != MapUse::normal;
        const ImageView& view =
            is_scalar ? texture.scalar_views[MapUse{use} == MapUse::metalness] : texture.view;
        images[use] = {texture.clamp ? clamp_.get() : repeat_.get(), view.get(),
                       VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        writes[use] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                       .dstSet = set,
                       .dstBinding = use,
                       .descriptorCount = 1,
                       .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                       .pImageInfo = &images[use]};
    }
    vkUpdateDescriptorSets(device.get(), count, writes.data(), 0, nullptr);
}

VkDeviceSize Scene::memory_bytes() const {
    VkDeviceSize bytes = vertices_.memory.bytes() + indices_.memory.bytes();
    for (const Memory& memory : texture_memory_) bytes += memory.bytes();
    return bytes;
}

std::vector<glm::vec3> Scene::positions_of(std::uint32_t material) const {
    std::vector<glm::vec3> positions;
    auto first = positions_.begin();
    for (const Draw& draw : draws_) {
        const auto last = first + draw.vertex_count;
        if (draw.constants.material == material) positions.insert(positions.end(), first, last);
        first = last;
    }
    return positions;
}

std::uint64_t Scene::triangle_count() const {
    std::uint64_t count = 0;
    for (const SceneChunk& chunk : chunks_) count += chunk.index_count / 3;
    return count;
}

namespace {

Scene scene_of(const Device& device, const Layouts& layouts, std::span<const std::byte> bytes,
               const std::string& name, const TextureSettings& settings) {
    Document document = mesh_format::parse(bytes, name);
    const mesh_format::DecodedGeometry decoded = decode(document, name);
    return {device, layouts, document, settings};
}

}  // namespace

Scene load_scene(const Device& device, const Layouts& layouts, const std::filesystem::path& path,
                 const TextureSettings& settings) {
    const common::MappedFile file(path);
    return scene_of(device, layouts, file.bytes(), path.string(), settings);
}

Scene reload_scene(const Device& device, const Layouts& layouts, const std::filesystem::path& path,
                   const TextureSettings& settings) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto size = static_cast<std::streamoff>(file.tellg());
    std::vector<std::byte> bytes(static_cast<std::size_t>(std::max<std::streamoff>(size, 0)));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
        throw common::FileError(fmt::format("{}: cannot be read", path.string()));
    }
    if (common::is_lfs_pointer(bytes)) {
        throw common::FileError(fmt::format("{}: {}", path.string(), common::kIsLfsPointer));
    }
    return scene_of(device, layouts, bytes, path.string(), settings);
}

}  // namespace cw2
