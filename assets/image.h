// Texture sets computed texel by texel, written as PNG.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>

namespace assets {

/// One texel of a surface, all values linear.
struct Texel {
    glm::vec3 color{0.5f};
    float roughness = 0.5f;
    float metalness = 0.0f;
    float height = 0.0f;  ///< metres, becomes the normal map
    float alpha = 1.0f;
};

/// Which images of a set are written: NAME_color.png, NAME_roughness.png, NAME_metalness.png,
/// NAME_normal.png and NAME_mask.png.
struct TextureSet {
    std::string name;
    int size;          ///< texels a side
    glm::vec2 extent;  ///< metres that the image covers, for the normal map's slopes
    bool color = true;
    bool roughness = true;
    bool metalness = false;
    bool normal = true;
    bool mask = false;
    /// The texel at uv in [0, 1)^2; repeats with period 1.
    std::function<Texel(glm::vec2 uv)> texel;
};

/// Writes the images into `directory`. Throws std::runtime_error where a file cannot be written.
void write_texture_set(const std::filesystem::path& directory, const TextureSet& set);

}  // namespace assets
