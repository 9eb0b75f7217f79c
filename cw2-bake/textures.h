// Source images to finished mip chains.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cw2-bake/diagnostics.h"
#include "cw2-bake/settings.h"
#include "cw2-bake/source_scene.h"
#include "mesh-format/io.h"
#include "mesh-format/layout.h"

namespace bake {

/// One finished texture; `payload` is as mesh_format::TextureRecord describes.
struct Texture {
    std::string name;
    mesh_format::TextureFormat format{};
    bool clamp = false;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    float psnr = 0.0f;  ///< as in mesh_format::TextureRecord
    std::vector<std::byte> payload;
    std::span<const std::byte> earlier_payload;  ///< instead, in TextureSet::earlier_file
    std::uint64_t checksum = 0;  ///< mesh_format::checksum() of bytes(), once they are finished

    std::span<const std::byte> bytes() const {
        return payload.empty() ? earlier_payload : std::span<const std::byte>(payload);
    }
};

/// What one material samples: indices into TextureSet::textures, or mesh_format::kNoTexture.
struct MaterialTextures {
    std::uint32_t base_color = mesh_format::kNoTexture;
    std::uint32_t roughness = mesh_format::kNoTexture;
    std::uint32_t metalness = mesh_format::kNoTexture;
    std::uint32_t normal = mesh_format::kNoTexture;
    std::uint32_t alpha_mask = mesh_format::kNoTexture;
    bool roughness_holds_factor = false;  ///< the material's factor is in its texture already
};

struct TextureSet {
    std::vector<Texture> textures;  ///< equal textures are stored once, in order of first use
    std::vector<MaterialTextures> materials;  ///< one a material
    std::vector<mesh_format::SourceRecord> sources;
    std::shared_ptr<const mesh_format::MappedFile> earlier_file;
};

/// Told how much of the textures is done, in [0, 1], and the name of the image at work; called
/// from one thread at a time.
using TextureProgress = std::function<void(double done, std::string_view name)>;

/// Reads and filters every image the materials name, and compresses it if `mode` says so, on as
/// many threads as TBB is allowed; the result does not depend on their number. An image that is
/// missing or cannot be read is a warning that names it, and the material goes on without it.
/// What an earlier bake left at `earlier` is used again where it is what would be made anew.
TextureSet bake_textures(std::span<const SourceMaterial> materials, TextureMode mode,
                         const std::filesystem::path& earlier, const Warn& warn,
                         const TextureProgress& progress);

}  // namespace bake
