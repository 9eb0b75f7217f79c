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

/// Values that false colour spreads its colours over: by their logarithm if low is positive, else
/// evenly. high > low.
struct ValueRange {
    float low;
    float high;
    bool operator==(const ValueRange&) const = default;
};

/// What is known of a view beside how it is computed, which shaders/shade.glsl says.
struct ViewInfo {
    View view;
    std::string_view name;         ///< as the command line has it
    std::string_view description;  ///< one line, for --list-views and the panel
    ValueRange range{0.0f, 1.0f};  ///< that shows it well in false colours
    /// Stops by which what people look at is brightened where nobody asks for others: log2(pi) for
    /// the picture, so that white paper that faces the light is white.
    float exposure = 0.0f;
};

/// Indexed by View.
inline constexpr std::array<ViewInfo, interop::kViewCount> kViews{{
    {interop::kViewShaded,
     "shaded",
     "the picture: ambient c + (diffuse + specular) light n.l + emission / pi",
     {0.001f, 10.0f},
     1.6514961f},
    {interop::kViewNormal, "normal", "shading normal, normal map applied, as 0.5 n + 0.5"},
    {interop::kViewVertexNormal, "vertex-normal", "interpolated vertex normal as 0.5 n + 0.5"},
    {interop::kViewViewDirection, "view-direction", "direction to the camera as 0.5 v + 0.5"},
    {interop::kViewLightDirection, "light-direction", "direction to the light as 0.5 l + 0.5"},
    {interop::kViewDiffuse,
     "diffuse",
     "c / pi (1 - F)(1 - M), the Lambert term before light colour and n.l",
     {0.0f, 0.32f}},  // at most 1 / pi
    {interop::kViewSpecular,
     "specular",
     "specular term D F G / (4 n.v n.l), before light colour and n.l",
     {0.001f, 100.0f}},
    {interop::kViewDistribution,
     "distribution",
     "D, the distribution of microfacet normals: (p + 2) / (2 pi) (n.h)^p, p = 2 / alpha^4 - 2",
     {0.01f, 1e4f}},
    {interop::kViewMasking, "masking",
     "G, between microfacets: min(1, 2 n.h n.v / v.h, 2 n.h n.l / v.h)"},
    {interop::kViewFresnel, "fresnel",
     "F, reflectance after Schlick: F0 + (1 - F0)(1 - v.h)^5, F0 = (1 - M) 0.04 + M c"},
    {interop::kViewBaseColor, "base-color", "base colour c, linear"},
    {interop::kViewRoughness, "roughness", "roughness alpha"},
    {interop::kViewMetalness, "metalness", "metalness M"},
    {interop::kViewTangent, "tangent", "interpolated tangent as 0.5 t + 0.5"},
    {interop::kViewBitangent, "bitangent", "bitangent, handedness applied, as 0.5 b + 0.5"},
    {interop::kViewUv, "uv", "fractional part of the texture coordinate"},
    {interop::kViewAlphaMask, "alpha-mask", "alpha mask; 1 where a material has none"},
    {interop::kViewEmission, "emission", "what is emitted, linear; 1 is as bright as white paper"},
    {interop::kViewVertexColor, "vertex-color", "interpolated vertex colour, linear; else white"},
}};
static_assert([] {
    for (View view = 0; view < kViews.size(); ++view) {
        if (kViews[view].view != view) return false;
    }
    return true;
}());

/// That a view is to be shown in false colours.
struct FalseColor {
    std::optional<ValueRange> range;  ///< none: the view's own
    bool operator==(const FalseColor&) const = default;

    ValueRange range_of(View view) const { return range.value_or(kViews[view].range); }
};

/// What one side of a picture shows.
struct Side {
    View view = interop::kViewShaded;
    bool normal_map = true;  ///< false: the vertex normal shades
    bool alpha_mask = true;  ///< false: nothing is discarded
    auto operator<=>(const Side&) const = default;
};

inline std::optional<View> view_named(std::string_view name) {
    for (View view = 0; view < kViews.size(); ++view) {
        if (kViews[view].name == name) return view;
    }
    return std::nullopt;
}

}  // namespace cw2
