// A baked scene on the device.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cw2/render/camera.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/scene_file.h"
#include "cw2/render/scene_textures.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "cw2/vulkan/resources.h"
#include "mesh-format/file.h"
#include "shaders/interop.h"

namespace cw2 {

/// What the triangles of one mesh are drawn with.
struct Draw {
    interop::DrawConstants constants;
    mesh_format::VertexForms forms;
    Shading shading;
    bool alpha_mask;   ///< the material has one
    bool merged_maps;  ///< the normal map holds roughness and metalness, too
    bool unlit;
    bool changing_uvs;  ///< as in PipelineKey
    bool cull_back;
    VkDescriptorSet material;
    VkDeviceSize vertex_offset;  ///< bytes
    VkDeviceSize index_offset;   ///< bytes
    std::uint32_t vertex_count;
};

/// Triangles that are culled and drawn as one; see mesh_format::ChunkRecord.
struct SceneChunk {
    glm::vec3 center;
    float radius;
    glm::vec3 cone_axis;
    float cone_cutoff;
    std::uint32_t draw;         ///< index into Scene::draws
    std::uint32_t first_index;  ///< counted from the draw's index_offset
    std::uint32_t index_count;
};

class Scene {
 public:
    /// Uploads the geometry of `file`, whose positions it takes. Throws VulkanError.
    Scene(const Device& device, SceneFile& file);

    /// Makes room for the textures, without which nothing can be drawn; first_levels as of
    /// SceneTextures. Throws VulkanError.
    void make_textures(const Device& device, const Layouts& layouts, const SceneFile& file,
                       const TextureSettings& settings,
                       const std::vector<std::uint32_t>& first_levels = {});

    /// Uploads the contents of the textures; then the file is not needed any more. Throws
    /// VulkanError.
    void write_textures(const Device& device, const SceneFile& file) {
        textures_.write(device, file);
    }

    const Bounds& bounds() const { return bounds_; }
    const SceneStart& start() const { return start_; }
    const std::vector<Draw>& draws() const { return draws_; }
    const std::vector<SceneChunk>& chunks() const { return chunks_; }
    VkBuffer vertices() const { return vertices_.handle.get(); }
    VkBuffer indices() const { return indices_.handle.get(); }
    /// Of all vertices, draw after draw.
    const std::vector<glm::vec3>& positions() const { return positions_; }
    /// On CPUs; else none.
    std::span<const std::uint16_t> host_indices() const;
    /// No other scene of this run has it.
    std::uint64_t id() const { return id_; }
    /// Indexed by DrawConstants::material.
    const std::vector<std::string>& material_names() const { return material_names_; }
    /// Where the vertices of a material are.
    std::vector<glm::vec3> positions_of(std::uint32_t material) const;
    std::uint64_t triangle_count() const;
    /// Device memory that geometry and textures take.
    VkDeviceSize memory_bytes() const;

 private:
    std::vector<VkDescriptorSet> make_material_sets(const Device& device, const Layouts& layouts,
                                                    const mesh_format::Document& document);

    std::uint64_t id_;
    std::vector<glm::vec3> positions_;
    Bounds bounds_;
    SceneStart start_;
    Buffer vertices_;
    Buffer indices_;
    SceneTextures textures_;
    DescriptorPool descriptor_pool_;
    std::vector<std::string> material_names_;
    std::vector<Draw> draws_;
    std::vector<SceneChunk> chunks_;
};

/// All of a file, on the device. Throws VulkanError.
Scene make_scene(const Device& device, const Layouts& layouts, SceneFile file,
                 const TextureSettings& settings);

}  // namespace cw2
