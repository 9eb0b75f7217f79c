// Finished textures of an earlier bake, for the next one.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "cw2-bake/textures/material_images.h"
#include "mesh-format/file.h"

namespace bake {

/// As mesh_format::SourceRecord has it.
using SourceKey = std::array<std::uint64_t, 2>;

/// The key of each request: XXH3 (128 bits) of what its images hold and of everything else that
/// its textures depend on, the code that makes them and `form` included; not of names and places.
/// None where an image cannot be read.
std::vector<std::optional<SourceKey>> source_keys(std::span<const ImageRequest> requests,
                                                  TextureForm form);

/// The file that an earlier bake left.
class EarlierBake {
 public:
    /// Without a whole file of this version at `path` it holds nothing.
    explicit EarlierBake(const std::filesystem::path& path);

    /// What a request with this key became, if it is there and its payloads are unaltered; the
    /// names are those of `request`. The textures refer to file().
    std::optional<ImageResult> find(const SourceKey& key, const ImageRequest& request) const;

    /// Keeps the payloads in memory.
    const std::shared_ptr<const common::MappedFile>& file() const { return file_; }

 private:
    std::optional<Texture> texture(std::uint32_t index, const std::string& name) const;

    /// Many sources may have become one texture: its checksum is compared once.
    struct Checked {
        std::once_flag once;
        bool is_whole = false;
    };

    std::shared_ptr<const common::MappedFile> file_;
    mesh_format::Document document_;
    std::map<SourceKey, const mesh_format::SourceRecord*> sources_;
    mutable std::vector<Checked> checked_;  ///< by texture
};

}  // namespace bake
