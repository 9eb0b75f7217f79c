// What an MTL says of a texture: options and a path.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "cw2-bake/base/file_finder.h"
#include "cw2-bake/base/source_scene.h"

namespace bake {

/// uv' = scale * uv + offset, v up.
struct MtlTransform {
    glm::vec2 scale{1.0f};
    glm::vec2 offset{0.0f};

    bool operator==(const MtlTransform&) const = default;
};

struct TextureStatement {
    TextureMap map;           ///< without `stated_in`
    MtlTransform transform;   ///< -s and -o
    float bump_scale = 1;     ///< -bm
    bool is_outside = false;  ///< the image is where the finder may not look
};

/// A word as a number, `+` allowed before it.
std::optional<float> as_number(std::string_view word);

/// In lower case, of ASCII letters.
std::string lower_case(std::string_view text);

/// Parses what stands behind the keyword: options, then the path, which is the rest of the line and
/// looked for from `folder`. None if no image is named. Tells `left_out` of each option that is not
/// honoured though it would change the look; none of their numbers is a reason to fail.
std::optional<TextureStatement> parse_texture(
    std::string_view words, const std::filesystem::path& folder, FileFinder& finder,
    const std::function<void(const std::string& option)>& left_out);

}  // namespace bake
