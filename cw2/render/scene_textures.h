// The textures of a scene on the device.
#pragma once

#include <vulkan/vulkan.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "cw2/render/scene_file.h"
#include "cw2/render/texel_rows.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/handle.h"
#include "cw2/vulkan/resources.h"
#include "mesh-format/file.h"

namespace cw2 {

/// How textures are kept and sampled.
struct TextureSettings {
    float anisotropy = 1.0f;     ///< the samplers' largest ratio, 1 for none
    bool decode_blocks = false;  ///< what is stored in blocks becomes single texels
    /// For devices on which every read counts, and which compile shaders for every kind of image:
    /// normal, roughness and metalness in one image, and none of a single texel. Needs the other.
    bool few_kinds = false;
};

class SceneTextures {
 public:
    SceneTextures() = default;
    /// Makes images for the textures of `document`, their levels from first_levels[i] on (all of
    /// them where it is empty), without their contents. Throws VulkanError.
    SceneTextures(const Device& device, const mesh_format::Document& document,
                  const TextureSettings& settings, const std::vector<std::uint32_t>& first_levels);

    /// Writes the contents. Images that the host writes are left alone by the queue meanwhile.
    void write(const Device& device, const SceneFile& file) const;

    /// Whether the normal map of a material holds roughness and metalness, too.
    bool has_merged_maps(std::size_t material) const { return merged_of_material_[material] != 0; }
    /// What `use` of a material is sampled from; white where it has no such map.
    VkDescriptorImageInfo descriptor(const mesh_format::Document& document, std::size_t material,
                                     mesh_format::MapUse use) const;
    /// Device memory.
    VkDeviceSize bytes() const;

 private:
    struct Texture {
        /// The document's texture that it holds, or mesh_format::kNoTexture.
        std::uint32_t stored = mesh_format::kNoTexture;
        std::optional<MergedMaps> merged;     ///< that it holds
        mesh_format::TextureRecord record{};  ///< of the image
        std::uint32_t first_level = 0;        ///< of the stored ones, the image's level 0
        bool is_one_texel = false;            ///< stored so; in the image it may be more
        ImageHandle image;
        ImageView view;
        std::array<ImageView, 2> scalar_views{};  ///< of merged maps: roughness, metalness
        std::byte* address = nullptr;             ///< of an image that the host writes
    };

    std::set<std::uint32_t> merge_maps(const mesh_format::Document& document);
    ImageSettings settings_of(const Device& device, const Texture& texture) const;
    bool is_decoded(const Texture& texture) const;
    TexelBlock texel_block(const Texture& texture) const;
    void make_images(const Device& device, const mesh_format::Document& document);
    static MergedMaps maps_of(const Texture& texture);
    static void forget(const SceneFile& file, const Texture& texture);
    MergedTextures read(const SceneFile& file, const Texture& texture) const;
    void write_level(const MergedTextures& source, const Texture& texture, const Rows& rows) const;
    void write_rows(const MergedTextures& source, const Texture& texture, const Rows& rows) const;

    TextureSettings settings_;
    std::vector<Memory> memory_;
    /// The document's, without an image where none is needed; white ones for maps that are absent,
    /// one for each format; merged maps.
    std::vector<Texture> textures_;
    std::vector<std::size_t> merged_of_material_;  ///< index of textures_, 0 where there is none
    Sampler repeat_;
    Sampler clamp_;
    Sampler hidden_beyond_;
};

}  // namespace cw2
