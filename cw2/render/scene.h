// A baked scene on the device.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/io.h"
#include "cw2/render/camera.h"
#include "cw2/render/merged_maps.h"
#include "cw2/render/pipelines.h"
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

/// How textures are kept and sampled.
struct TextureSettings {
    float anisotropy = 1.0f;     ///< the samplers' largest ratio, 1 for none
    bool decode_blocks = false;  ///< what is stored in blocks becomes single texels
    bool merge_maps = false;     ///< normal, roughness and metalness in one image; needs the other
};

class Scene {
 public:
    /// Uploads `document`, which is not needed afterwards. Throws VulkanError.
    Scene(const Device& device, const Layouts& layouts, const mesh_format::Document& document,
          const TextureSettings& settings);

    const Bounds& bounds() const { return bounds_; }
    const SceneStart& start() const { return start_; }
    const std::vector<Draw>& draws() const { return draws_; }
    const std::vector<SceneChunk>& chunks() const { return chunks_; }
    VkBuffer vertices() const { return vertices_.handle.get(); }
    VkBuffer indices() const { return indices_.handle.get(); }
    /// Indexed by DrawConstants::material.
    const std::vector<std::string>& material_names() const { return material_names_; }
    /// Where the vertices of a material are.
    std::vector<glm::vec3> positions_of(std::uint32_t material) const;
    std::uint64_t triangle_count() const;
    /// Device memory that geometry and textures take.
    VkDeviceSize memory_bytes() const;

 private:
    struct Texture {
        ImageHandle image;
        ImageView view;
        bool clamp = false;
        std::array<ImageView, 2> scalar_views{};  ///< of merged maps: roughness, metalness
    };
    using Merged = std::map<MergedMaps, Texture>;

    void upload_textures(const Device& device, const mesh_format::Document& document,
                         const TextureSettings& settings, Uploader& uploader);
    /// Chooses what is merged. Returns the textures that somebody needs as they are.
    std::set<std::uint32_t> merge_maps(const mesh_format::Document& document);
    std::vector<VkDescriptorSet> make_material_sets(const Device& device, const Layouts& layouts,
                                                    const mesh_format::Document& document);
    void write_material_set(const Device& device, VkDescriptorSet set,
                            const mesh_format::MaterialRecord& material, std::size_t number) const;

    std::vector<glm::vec3> positions_;  ///< of all vertices, draw after draw
    Bounds bounds_;
    SceneStart start_;
    Buffer vertices_;
    Buffer indices_;
    std::vector<Memory> texture_memory_;
    /// The document's, those that are needed; then a white texel for what is absent.
    std::vector<Texture> textures_;
    Merged merged_;
    std::vector<Merged::const_iterator> merged_of_material_;  ///< the end where there is none
    Sampler repeat_;
    Sampler clamp_;
    DescriptorPool descriptor_pool_;
    std::vector<std::string> material_names_;
    std::vector<Draw> draws_;
    std::vector<SceneChunk> chunks_;
};

/// Reads, checks and uploads a .cw2mesh file. Throws common::FileError or VulkanError.
Scene load_scene(const Device& device, const Layouts& layouts, const std::filesystem::path& path,
                 const TextureSettings& settings);

/// The same for a file that somebody may be writing: mapped bytes that are cut off would end the
/// process, so these are read.
Scene reload_scene(const Device& device, const Layouts& layouts, const std::filesystem::path& path,
                   const TextureSettings& settings);

}  // namespace cw2
