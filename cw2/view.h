// What a picture shows.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "shaders/interop.h"

namespace cw2 {

/// One of interop's kView constants.
using View = std::uint32_t;

/// Names as the command line has them, indexed by View.
inline constexpr std::array<std::string_view, interop::kViewCount> kViewNames{
    "shaded",     "normal",    "vertex-normal", "view-direction", "light-direction",
    "diffuse",    "specular",  "distribution",  "masking",        "fresnel",
    "base-color", "roughness", "metalness",     "tangent",        "bitangent",
    "uv",         "alpha-mask"};

/// One line on what each view shows, for --list-views and the README.
inline constexpr std::array<std::string_view, interop::kViewCount> kViewDescriptions{
    "the picture: ambient, diffuse and specular light",
    "shading normal, normal map applied, as 0.5 n + 0.5",
    "interpolated vertex normal as 0.5 n + 0.5",
    "direction to the camera as 0.5 v + 0.5",
    "direction to the light as 0.5 l + 0.5",
    "Lambert term before light colour and n.l",
    "specular term D F G / (4 n.v n.l), before light colour and n.l",
    "D, the Blinn-Phong distribution of microfacet normals",
    "G, shadowing and masking between microfacets",
    "F, Fresnel reflectance after Schlick",
    "base colour, linear",
    "roughness",
    "metalness",
    "interpolated tangent as 0.5 t + 0.5",
    "bitangent, handedness applied, as 0.5 b + 0.5",
    "fractional part of the texture coordinate",
    "alpha mask; 1 where a material has none",
};

inline std::optional<View> view_named(std::string_view name) {
    for (View view = 0; view < kViewNames.size(); ++view) {
        if (kViewNames[view] == name) return view;
    }
    return std::nullopt;
}

}  // namespace cw2
