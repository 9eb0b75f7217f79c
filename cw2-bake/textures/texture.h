// Finished textures, as the stages after them know them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/io.h"
#include "mesh-format/layout.h"

namespace bake {

enum class TextureMode {
    bc,        ///< in blocks, where that is good enough; roughness made fit for its normal map
    lossless,  ///< 8 bits a channel
    none,      ///< materials keep their factors only
};

/// How textures are stored.
struct TextureForm {
    // A mode alone is a form.
    TextureForm(TextureMode mode_, bool compressed_ = false)
        : mode(mode_), compressed(compressed_) {}

    TextureMode mode;
    bool compressed;  ///< payloads in Zstandard frames
};

/// One finished texture; `payload` is as mesh_format::TextureRecord describes.
struct Texture {
    std::string name;
    mesh_format::TextureFormat format{};
    std::uint32_t flags = 0;  ///< mesh_format::TextureFlags
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
    mesh_format::PerMap<std::uint32_t> textures = mesh_format::per_map(mesh_format::kNoTexture);
    bool roughness_holds_factor = false;  ///< the material's factor is in its texture already
};

struct TextureSet {
    std::vector<Texture> textures;  ///< equal textures are stored once, in order of first use
    std::vector<MaterialTextures> materials;  ///< one a material
    std::vector<mesh_format::SourceRecord> sources;
    std::shared_ptr<const common::MappedFile> earlier_file;
};

}  // namespace bake
