// What a picture shows.
#pragma once

#include <array>
#include <compare>
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

/// Values that false colour spreads its colours over: by their logarithm if low is positive, else
/// evenly. high > low.
struct ValueRange {
    float low;
    float high;
    bool operator==(const ValueRange&) const = default;
};

/// The range that shows a view well, indexed by View.
inline constexpr std::array<ValueRange, interop::kViewCount> kViewRanges{{
    {0.001f, 10.0f},   // shaded
    {0.0f, 1.0f},      // normal
    {0.0f, 1.0f},      // vertex-normal
    {0.0f, 1.0f},      // view-direction
    {0.0f, 1.0f},      // light-direction
    {0.0f, 0.32f},     // diffuse: at most 1 / pi
    {0.001f, 100.0f},  // specular
    {0.01f, 1e4f},     // distribution
    {0.0f, 1.0f},      // masking
    {0.0f, 1.0f},      // fresnel
    {0.0f, 1.0f},      // base-color
    {0.0f, 1.0f},      // roughness
    {0.0f, 1.0f},      // metalness
    {0.0f, 1.0f},      // tangent
    {0.0f, 1.0f},      // bitangent
    {0.0f, 1.0f},      // uv
    {0.0f, 1.0f},      // alpha-mask
}};

/// Stops by which what people look at is brightened where nobody asks for others: log2(pi) for the
/// picture, so that white paper that faces the light is white.
constexpr float default_exposure(View view) {
    return view == interop::kViewShaded ? 1.6514961f : 0.0f;
}

/// That a view is to be shown in false colours.
struct FalseColor {
    std::optional<ValueRange> range;  ///< none: the view's own
    bool operator==(const FalseColor&) const = default;

    ValueRange range_of(View view) const { return range.value_or(kViewRanges[view]); }
};

/// What one side of a picture shows.
struct Side {
    View view = interop::kViewShaded;
    bool normal_map = true;  ///< false: the vertex normal shades
    bool alpha_mask = true;  ///< false: nothing is discarded
    auto operator<=>(const Side&) const = default;
};

inline std::optional<View> view_named(std::string_view name) {
    for (View view = 0; view < kViewNames.size(); ++view) {
        if (kViewNames[view] == name) return view;
    }
    return std::nullopt;
}

}  // namespace cw2
