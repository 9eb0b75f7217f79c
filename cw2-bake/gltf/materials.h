// The materials of a glTF.
#pragma once

#include <glm/vec2.hpp>
#include <set>
#include <span>
#include <string>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/gltf/file.h"
#include "cw2-bake/textures/texture.h"

namespace bake {

/// KHR_texture_transform: scaled, then turned about the origin (counter-clockwise as one sees the
/// image), then moved; v points down.
struct UvTransform {
    glm::dvec2 offset{0.0};
    double rotation = 0.0;  ///< radians
    glm::dvec2 scale{1.0};

    glm::dvec2 apply(const glm::dvec2& uv) const;
    bool operator==(const UvTransform&) const = default;
};

struct GltfMaterial {
    SourceMaterial source;
    bool visible = true;  ///< false: its alpha is below its cutoff everywhere
    int uv_set = 0;       ///< all its textures are sampled at this set
    UvTransform uv_transform;
};

class GltfMaterials {
 public:
    /// Both must outlive this.
    GltfMaterials(const GltfFile& file, const Warn& warn) : file_(file), warn_(warn) {}

    /// The material of this index, or for -1 that of primitives with none. Warns of what cannot be
    /// drawn as it says:
    /// - BLEND is opaque, but where half of the texture's alpha masks; warn_of_blending() tells
    ///   which.
    /// - Textures of one material share a UV set and a transform: those of the base colour, else
    ///   of the normal map, else of the metallic-roughness texture.
    /// - A sampler that mirrors, or clamps along one axis alone, repeats.
    GltfMaterial convert(int index);

    /// Of what was said for several materials at once.
    void warn_of_left_out() const;

 private:
    struct TextureUse;
    std::optional<TextureMap> texture_map(const TextureUse& use, const std::string& place);
    void take_mask(const tinygltf::Material& material, const std::string& place,
                   GltfMaterial& result);
    static void take_emission(const tinygltf::Material& material, const std::string& place,
                              SourceMaterial& source);

    const GltfFile& file_;
    const Warn& warn_;
    std::set<int> unusable_images_;  ///< of which a warning told
    std::string first_opaque_;       ///< what becomes of the first blended one without a texture
    std::size_t opaque_ = 0;
};

/// Warns of the blended materials of a glTF that have a texture, now that it is known which of them
/// have a mask; the others are told by GltfMaterials.
void warn_of_blending(std::span<const SourceMaterial> materials,
                      std::span<const MaterialTextures> textures, const Warn& warn);

}  // namespace bake
