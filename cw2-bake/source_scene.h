// A scene as its source file states it, whatever the format: what the readers produce and the
// stages consume. Knows no parser.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace bake {

inline constexpr std::uint32_t kAbsent = 0xFFFF'FFFF;

/// One corner of a triangle: indices into the scene's attribute arrays. A reader leaves `normal`
/// or `uv` at kAbsent where the source has none; the position is always there.
struct Corner {
    std::uint32_t position;
    std::uint32_t normal = kAbsent;
    std::uint32_t uv = kAbsent;
};

/// Which part of an image's texel a map reads.
enum class Channel : std::uint8_t {
    standard,  ///< what the use of the map suggests
    r,
    g,
    b,
    alpha,
    luminance,
};

/// A reference to an image, as a material states it.
struct TextureMap {
    std::filesystem::path file;  ///< resolved against the file that names it; may not exist
    std::string stated_in;       ///< "PATH:LINE" of the statement, for messages
    Channel channel = Channel::standard;
    bool clamp = false;
};

/// How a height map becomes a normal map: `scale` multiplies the height (bm), which is in texels.
struct BumpMap {
    TextureMap map;
    float scale = 1.0f;
};

/// Factors are linear and multiply their map's texels; see the material rules of the README.
struct SourceMaterial {
    std::string name;
    glm::vec3 base_color{0.8f};
    float roughness = 1.0f;  ///< [0, 1], the alpha of the Blinn-Phong distribution
    float metalness = 0.0f;  ///< [0, 1]
    float alpha_cutoff = 0.5f;
    bool cull_back = false;
    std::optional<TextureMap> base_color_map;  ///< sRGB
    std::optional<TextureMap> roughness_map;
    std::optional<TextureMap> metalness_map;
    std::optional<TextureMap> normal_map;  ///< tangent space, green up along +v
    std::optional<BumpMap> bump_map;       ///< used where there is no normal_map
    std::optional<TextureMap> alpha_map;   ///< else the alpha of base_color_map may mask
};

/// Triangles over shared attribute arrays. Right-handed, +Y up; v = 0 is the bottom row of an
/// image. Every number is finite, every index in range, there is at least one triangle, and no
/// component is -0 (so that equality of bits is equality of values).
struct SourceScene {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< unit length where a corner refers to it
    std::vector<glm::vec2> uvs;
    std::vector<Corner> corners;                   ///< 3 a triangle, counter-clockwise
    std::vector<std::uint32_t> triangle_material;  ///< one a triangle, index into materials
    /// One a triangle, 0 = not smoothed; empty if every corner has a normal.
    std::vector<std::uint32_t> smoothing_group;
    std::vector<SourceMaterial> materials;
};

}  // namespace bake
