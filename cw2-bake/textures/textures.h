// Source images to finished mip chains.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/textures/texture.h"

namespace bake {

/// Told how much of the textures is done, in [0, 1], and the name of the image at work; called
/// from one thread at a time.
using TextureProgress = std::function<void(double done, std::string_view name)>;

/// Reads and filters every image the materials name, and stores it as `form` says, on as many
/// threads as TBB is allowed; the result does not depend on their number. An image that is missing
/// or cannot be read is a warning that names it, and the material goes on without it. What an
/// earlier bake left at `earlier` is used again where it is what would be made anew.
TextureSet bake_textures(std::span<const SourceMaterial> materials, TextureForm form,
                         const std::filesystem::path& earlier, const Warn& warn,
                         const TextureProgress& progress);

}  // namespace bake
