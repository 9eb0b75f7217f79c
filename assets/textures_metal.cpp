// Bronze, rusty iron and chain links.
#include "assets/noise.h"
#include "assets/textures.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// Cast and chased bronze, polished where hands and weather reach: metallic everywhere.
Texel bronze(vec2 uv) {
    const float cloud = fbm(uv * 4.0f, 4, 5, 701);
    const Cell dent = cells(uv * 28.0f + 0.3f * fbm(uv * 12.0f, 12, 2, 703), 28, 705);
    const float hammered = dent.nearest * dent.nearest;
    const float scratch = fbm(uv * vec2(8.0f, 128.0f), 128, 2, 707);
    const float grain = fbm(uv * 100.0f, 100, 3, 709);
    Texel texel;
    texel.color = glm::mix(vec3(0.86f, 0.58f, 0.27f), vec3(0.66f, 0.38f, 0.17f),
                           saturate(0.45f + 0.8f * cloud)) *
                  (1.0f + 0.05f * grain);
    texel.roughness = 0.58f + 0.08f * cloud + 0.04f * grain;
    texel.metalness = 1.0f;
    texel.height = 0.0007f * hammered + 0.00012f * scratch + 0.00010f * grain;
    return texel;
}

/// Wrought iron: bare metal that rust eats into. Rust is no metal.
Texel rusty(Texel texel, float rust, float grain) {
    const vec3 oxide =
        glm::mix(vec3(0.30f, 0.10f, 0.035f), vec3(0.16f, 0.055f, 0.025f), saturate(0.5f + grain));
    texel.color = glm::mix(vec3(0.48f, 0.46f, 0.44f) * (1.0f + 0.1f * grain), oxide, rust);
    texel.roughness = mix(0.38f + 0.08f * grain, 0.90f, rust);
    texel.metalness = 1.0f - rust;
    return texel;
}

Texel iron(vec2 uv) {
    const float patch = fbm(uv * 5.0f, 5, 6, 721);
    const float grain = fbm(uv * 90.0f, 90, 3, 723);
    const float rust = smooth_step(-0.05f, 0.18f, patch + 0.15f * grain);
    Texel texel;
    texel.height = 0.0010f * rust * (0.6f + grain) + 0.0006f * patch;
    return rusty(texel, rust, grain);
}

/// A round bar's cross-section: height above the card at distance d from the axis; < 0 outside.
float bar_height(float d, float radius) {
    return d < radius ? std::sqrt(radius * radius - d * d) : radius - d;
}

/// Two links of a chain to a tile: one face on around v = 0.25, one edge on around v = 0.75.
/// Units of the tile's side.
Texel chain(vec2 uv) {
    constexpr float kRadius = 0.072f;
    constexpr float kHalfWidth = 0.16f;  // of the link's centre line
    constexpr float kHalfLength = 0.33f;
    const auto wrapped = [](float v) { return v - std::floor(v + 0.5f); };
    const float x = uv.x - 0.5f;
    const float face_v = wrapped(uv.y - 0.25f);
    const float straight = kHalfLength - kHalfWidth;
    const float beyond = std::fmax(std::fabs(face_v) - straight, 0.0f);
    const float ring = std::fabs(std::sqrt(x * x + beyond * beyond) - kHalfWidth);
    const float face = bar_height(ring, kRadius);
    const float edge_v = wrapped(uv.y - 0.75f);
    const float past = std::fmax(std::fabs(edge_v) - kHalfLength, 0.0f);
    const float edge = bar_height(std::sqrt(x * x + past * past), kRadius);
    const float height = std::fmax(face, edge);
    const float patch = fbm(uv * 6.0f, 6, 5, 741);
    const float grain = fbm(uv * 40.0f, 40, 3, 743);
    // Links rub where they meet: bare there.
    const float rub = smooth_step(0.14f, 0.04f, std::fabs(std::fabs(face_v) - kHalfLength));
    const float rust = smooth_step(-0.12f, 0.12f, patch + 0.2f * grain - 0.5f * rub);
    Texel texel;
    texel.alpha = smooth_step(-0.004f, 0.004f, height);
    texel.height = std::fmax(height, 0.0f) + 0.006f * grain;
    return rusty(texel, rust, grain);
}

/// A brass lantern's pierced wall: stars and dots cut through.
Texel pierced(vec2 uv) {
    const vec2 p = glm::fract(uv * vec2(8.0f, 4.0f)) - 0.5f;
    const vec2 shifted = glm::fract(uv * vec2(8.0f, 4.0f) + 0.5f) - 0.5f;
    const float angle = std::atan2(p.y, p.x);
    const float hole = std::fmin(glm::length(p) - (0.22f + 0.07f * std::cos(6.0f * angle)),
                                 glm::length(shifted) - 0.11f);
    const float grain = fbm(uv * 60.0f, 60, 3, 761);
    const float cloud = fbm(uv * 4.0f, 4, 4, 763);
    Texel texel;
    texel.alpha = smooth_step(-0.012f, 0.012f, hole);
    texel.color =
        glm::mix(vec3(0.88f, 0.66f, 0.28f), vec3(0.60f, 0.38f, 0.15f), saturate(0.4f + cloud));
    texel.roughness = 0.40f + 0.12f * cloud + 0.05f * grain;
    texel.metalness = 1.0f;
    texel.height = 0.0015f * smooth_step(0.14f, 0.0f, hole) + 0.0001f * grain;
    return texel;
}

}  // namespace

std::vector<TextureSet> metal_textures() {
    return {
        {.name = "bronze", .size = 1024, .extent = vec2(0.7f), .texel = bronze},
        {.name = "iron", .size = 512, .extent = vec2(0.5f), .metalness = true, .texel = iron},
        {.name = "chain",
         .size = 512,
         .extent = vec2(1.0f),
         .metalness = true,
         .mask = true,
         .texel = chain},
        {.name = "pierced",
         .size = 512,
         .extent = vec2(0.6f, 0.3f),
         .mask = true,
         .texel = pierced},
    };
}

}  // namespace assets
