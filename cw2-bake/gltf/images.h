// A baked scene's textures as glTF wants them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "mesh-format/file.h"

namespace bake {

/// The bytes of each texture, as mesh_format::TextureRecord describes them.
using TexturePayloads = std::span<const std::span<const std::byte>>;

inline constexpr std::uint32_t kNoImage = 0xFFFF'FFFF;

/// Indices into GltfImages::images, or kNoImage.
struct GltfMaterialImages {
    std::uint32_t color = kNoImage;  ///< and the alpha mask in alpha
    std::uint32_t metallic_roughness = kNoImage;
    std::uint32_t normal = kNoImage;
    std::uint32_t emission = kNoImage;
};

struct GltfImages {
    struct File {
        std::string name;
        bool clamp;
        std::vector<std::byte> png;
    };
    std::vector<File> images;                   ///< each different one once
    std::vector<GltfMaterialImages> materials;  ///< one a material
};

/// The largest level of every texture that a material uses, blocks decoded: base colour with the
/// alpha mask, roughness in green with metalness in blue, normals with z. Where two that share an
/// image differ in size, the smaller one's texels are repeated, unless that took more than four
/// times the texels of the larger one, whose size the image then has, with a warning.
GltfImages make_gltf_images(const mesh_format::Document& document, TexturePayloads payloads,
                            const Warn& warn);

}  // namespace bake
