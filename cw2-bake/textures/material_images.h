// From the images that one map of a material names to its finished textures.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/textures/image.h"
#include "cw2-bake/textures/roughness_mips.h"
#include "cw2-bake/textures/texture.h"

namespace bake {

/// What a material asks of one image, or of the two that make its surface.
struct ImageRequest {
    enum class Kind : std::uint8_t {
        surface,  ///< base colour and alpha mask, which depend on each other
        scalar,
        roughness,  ///< under the normal map or bump map `relief`; `map` may be absent
        normal,
        bump,
    };
    Kind kind{};
    std::optional<TextureMap> map{};        ///< of a surface: the base colour
    std::optional<TextureMap> alpha_map{};  ///< of a surface; it or `map` is there
    float alpha_cutoff = 0.0f;              ///< of a surface
    bool color_alpha_is_mask = true;        ///< of a surface, where there is no alpha_map
    bool color_is_blended = false;          ///< of a surface: what its alpha asks for
    float bump_scale = 0.0f;                ///< of a bump, also as a relief
    std::optional<TextureMap> relief{};     ///< of roughness
    bool relief_is_bump = false;
    float normal_scale = 1.0f;  ///< of a relief that is no bump
    float factor = 1.0f;        ///< of roughness, what its map is multiplied with
};

/// Everything that the textures of a request depend on, but what its images hold: numbers only.
using MapSettings = std::tuple<bool, Channel, bool>;
using RequestSettings = std::tuple<ImageRequest::Kind, MapSettings, MapSettings, MapSettings, float,
                                   bool, bool, float, bool, float, float>;
RequestSettings settings_of(const ImageRequest& request);

/// The map whose image is read for a request whatever it holds.
const TextureMap& first_map(const ImageRequest& request);

/// What is odd about an image.
struct ImageWarning {
    std::string stated_in;  ///< as TextureMap has it
    std::string text;       ///< "FILE: what is odd"
};

struct ImageResult {
    std::optional<Texture> texture;
    std::optional<Texture> alpha_mask;
    bool holds_factor = false;  ///< of roughness: the texels are multiplied with it already
    std::vector<ImageWarning> warnings;
};

/// The images that one thread works on.
class ImageCache {
 public:
    /// The image, read when first asked for. Throws ImageError.
    const Image& get(const TextureMap& map);

    /// The lengths that a normal map's levels left behind, for the roughness under it.
    using NormalsKey = std::tuple<std::filesystem::path, MapSettings, bool, float>;
    std::map<NormalsKey, MeanLengths> lengths;

 private:
    std::map<std::filesystem::path, Image> images_;
};

/// Reads, filters, and stores as `form` says. A map whose image cannot be used counts as absent.
/// What says nothing makes no texture: a mask that hides nothing, a normal map that is flat. An
/// image of one value becomes 1 x 1. Throws BakeError where memory runs out.
ImageResult make_textures(const ImageRequest& request, TextureForm form, ImageCache& images);

/// What make_textures() calls the texture and the mask of a request whose images it can use.
std::string texture_name(const ImageRequest& request);
std::string mask_name(const ImageRequest& request);

}  // namespace bake
