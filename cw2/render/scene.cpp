#include "cw2/render/scene.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <span>
#include <utility>

namespace cw2 {

namespace {

using mesh_format::Document;
using mesh_format::MapUse;
using mesh_format::MaterialRecord;
using mesh_format::MeshRecord;

Shading shading_of(const MaterialRecord& material) {
    if (glm::make_vec3(material.emission) != glm::vec3(0.0f)) return Shading::emissive;
    return material.flags & mesh_format::kAlphaMask ? Shading::alpha_mask : Shading::opaque;
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
    constants.has_normal_map = material.textures[MapUse::normal] != mesh_format::kNoTexture;
    constants.normal_scale = material.normal_scale;
    constants.back_normals = material.flags & mesh_format::kFlipBackNormals ? -1.0f : 1.0f;
    constants.material = mesh.material;
    return constants;
}

/// Uploads bytes of a file, which need not be in memory twice.
Buffer upload_buffer(const Device& device, std::optional<Uploader>& uploader, const SceneFile& file,
                     std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
    const std::size_t size = std::max<std::size_t>(bytes.size(), 4);
    if (device.is_cpu()) {
        Buffer buffer = make_buffer(device, size, usage, MemoryUse::upload);
        constexpr std::size_t kPiece = 2 << 20;
        const std::size_t pieces = (bytes.size() + kPiece - 1) / kPiece;
        tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t i) {
            const std::size_t first = i * kPiece;
            const auto piece = bytes.subspan(first, std::min(kPiece, bytes.size() - first));
            std::memcpy(buffer.mapped.data() + first, piece.data(), piece.size());
            file.forget(piece);
        });
        return buffer;
    }
    if (!uploader) uploader.emplace(device);
    Buffer buffer =
        make_buffer(device, size, usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::device);
    uploader->write_buffer(buffer.handle.get(), bytes);
    file.forget(bytes);
    return buffer;
}

std::uint64_t new_id() {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
}

}  // namespace

Scene::Scene(const Device& device, SceneFile& file)
    : id_(new_id()),
      positions_(std::move(file.positions)),
      bounds_(file.bounds),
      start_(file.start) {
    const Document& document = file.document;
    std::optional<Uploader> uploader;
    vertices_ =
        upload_buffer(device, uploader, file, document.vertices, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    indices_ = upload_buffer(device, uploader, file, std::as_bytes(document.indices),
                             VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    if (uploader) uploader->finish();
    device.name(vertices_.handle.get(), "scene vertices");
    device.name(indices_.handle.get(), "scene indices");

    for (const MaterialRecord& material : document.materials) {
        material_names_.emplace_back(document.text(material.name));
    }
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
                          .unlit = (material.flags & mesh_format::kUnlit) != 0,
                          .cull_back = (material.flags & mesh_format::kCullBack) != 0,
                          .vertex_offset = mesh.vertex_offset,
                          .index_offset = mesh.first_index * sizeof(std::uint16_t),
                          .vertex_count = mesh.vertex_count});
    }
}

void Scene::make_textures(const Device& device, const Layouts& layouts, const SceneFile& file,
                          const TextureSettings& settings,
                          const std::vector<std::uint32_t>& first_levels) {
    textures_ = SceneTextures(device, file.document, settings, first_levels);
    const std::vector<VkDescriptorSet> sets = make_material_sets(device, layouts, file.document);
    for (Draw& draw : draws_) {
        draw.changing_uvs = device.is_cpu() && settings.anisotropy > 1.0f;
        draw.merged_maps = textures_.has_merged_maps(draw.constants.material);
        draw.material = sets[draw.constants.material];
    }
}

std::span<const std::uint16_t> Scene::host_indices() const {
    return {reinterpret_cast<const std::uint16_t*>(indices_.mapped.data()),
            indices_.mapped.size() / sizeof(std::uint16_t)};
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
        std::array<VkDescriptorImageInfo, mesh_format::kMapUseCount> images;
        std::array<VkWriteDescriptorSet, mesh_format::kMapUseCount> writes;
        const std::uint32_t count = map_count(shading_of(material));
        for (std::uint32_t use = 0; use < count; ++use) {
            images[use] = textures_.descriptor(document, i, MapUse{use});
            writes[use] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                           .dstSet = set,
                           .dstBinding = use,
                           .descriptorCount = 1,
                           .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                           .pImageInfo = &images[use]};
        }
        vkUpdateDescriptorSets(device.get(), count, writes.data(), 0, nullptr);
        sets.push_back(set);
    }
    return sets;
}

VkDeviceSize Scene::memory_bytes() const {
    return vertices_.memory.bytes() + indices_.memory.bytes() + textures_.bytes();
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

Scene make_scene(const Device& device, const Layouts& layouts, SceneFile file,
                 const TextureSettings& settings) {
    Scene scene(device, file);
    scene.make_textures(device, layouts, file, settings);
    scene.write_textures(device, file);
    return scene;
}

}  // namespace cw2
