// A scene as its source file states it, whatever the format: what the readers produce and the
// stages consume. Knows no parser.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cw2-bake/base/run_vector.h"
#include "mesh-format/layout.h"

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
    /// As file_finder.h finds it; may not exist. Of an embedded image a name that no other image of
    /// the scene has.
    std::filesystem::path file;
    /// The contents of an image file, where the source embeds it.
    std::shared_ptr<const std::vector<std::byte>> embedded{};
    std::string stated_in;  ///< "PATH:LINE" of the statement, for messages
    Channel channel = Channel::standard;
    bool clamp = false;
    std::string note{};  ///< what to warn of if the file is not there as named; else empty
};

/// How a height map becomes a normal map: `scale` multiplies the height (bm), which is in texels.
struct BumpMap {
    TextureMap map;
    float scale = 1.0f;
};

/// Factors are linear and multiply their map's texels; see the material rules of docs/cw2-bake.md.
struct SourceMaterial {
    std::string name;
    glm::vec3 base_color{0.8f};  ///< linear, [0, 1]
    float roughness = 1.0f;      ///< [0, 1], the alpha of the Blinn-Phong distribution
    float metalness = 0.0f;      ///< [0, 1]
    float alpha_cutoff = 0.5f;
    float normal_scale = 1.0f;  ///< multiplies x and y of the vectors in the map of normals
    bool cull_back = false;
    bool flip_back_normals = false;        ///< a back face is lit from behind
    bool base_color_alpha_is_mask = true;  ///< where there is no map of the mask
    glm::vec3 emission{0.0f};              ///< linear, as mesh_format::MaterialRecord has it
    bool unlit = false;                    ///< shows its base colour whatever the light
    bool blend = false;                    ///< the source blends it, by `opacity`
    float opacity = 1.0f;                  ///< [0, 1]
    /// By mesh_format::MapUse. Base colour and emission are sRGB; normals are in tangent space,
    /// green up along +v; without an alpha mask the alpha of the base colour may mask.
    mesh_format::PerMap<std::optional<TextureMap>> maps{};
    std::optional<BumpMap> bump_map;  ///< used where there is no map of normals
};

/// What a viewer starts with, if the source says it.
struct SourceCamera {
    glm::vec3 position;
    glm::vec3 target;    ///< another point
    float vertical_fov;  ///< radians, in (0, pi)
};
struct SourceLight {
    glm::vec3 position;
    glm::vec3 color;  ///< linear; the light has no falloff
};

/// The triangles begin .. end.
struct TriangleRange {
    std::size_t begin, end;
};

/// Triangles over shared attribute arrays. Right-handed, +Y up; v = 0 is the bottom row of an
/// image. Every number is finite, every index in range, there is at least one triangle, and no
/// component is -0 (so that equality of bits is equality of values).
struct SourceScene {
    /// Positions, those of camera and light included, are relative to it; in the coordinates of the
    /// source.
    glm::dvec3 origin{0.0};
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< unit length where a corner refers to it
    std::vector<glm::vec2> uvs;
    std::vector<Corner> corners;  ///< 3 a triangle, counter-clockwise
    RunVector triangle_material;  ///< one a triangle, index into materials
    /// One a triangle, 0 = not smoothed; empty if every corner has a normal.
    RunVector smoothing_group;
    /// Where corners without a normal are, ascending: outside of these every corner has one.
    std::vector<TriangleRange> without_normals;
    /// One a corner as tangents.h describes them, or zero where the source gives none; empty if it
    /// gives none at all.
    std::vector<glm::vec4> tangents;
    /// One a corner, which multiplies the base colour: red in the lowest byte, green, blue, sRGB-
    /// encoded, and linear alpha. Empty if the source gives none at all.
    std::vector<std::uint32_t> colors;
    std::vector<SourceMaterial> materials;
    std::optional<SourceCamera> camera;
    std::optional<SourceLight> light;
    /// That were read, and those that were named and are not there; images are not among them.
    std::vector<std::filesystem::path> files;
};

}  // namespace bake
