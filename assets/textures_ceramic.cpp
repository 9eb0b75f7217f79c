// Glazed wall tiles, terracotta and the pool.
#include "assets/noise.h"
#include "assets/textures.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// Half the distance function of an eight-pointed star of two squares around the origin.
float star(vec2 p) {
    const vec2 q = glm::abs(p);
    const float upright = std::fmax(q.x, q.y);
    const float turned = (q.x + q.y) * 0.70710678f;
    return std::fmin(upright, turned);
}

/// A glazed star-and-cross tile, 0.2 m; four by four to an image.
Texel azulejo(vec2 uv) {
    constexpr float kCount = 4.0f;
    const vec2 p = glm::fract(uv * kCount) - 0.5f;
    const glm::ivec2 tile(uv * kCount);
    const std::uint32_t id = hash(tile.x, tile.y, 601);
    const float edge = 0.5f - std::fmax(std::fabs(p.x), std::fabs(p.y));
    const float d = star(p);
    const vec2 corner = glm::abs(p) - 0.5f;
    const float dc = star(corner);
    const vec3 white(0.80f, 0.78f, 0.70f);
    const vec3 blue(0.018f, 0.075f, 0.32f);
    const vec3 green(0.025f, 0.24f, 0.15f);
    const vec3 ochre(0.66f, 0.33f, 0.045f);
    const float radius = glm::length(p);
    const float petal = 0.13f + 0.055f * std::cos(8.0f * std::atan2(p.y, p.x));
    vec3 color = white;
    if (d < 0.335f) color = blue;
    if (d < 0.30f) color = white;
    if (d < 0.27f) color = green;
    if (radius < petal + 0.025f) color = white;
    if (radius < petal) color = ochre;
    if (radius < 0.05f) color = blue;
    if (dc < 0.155f) color = ochre;
    if (dc < 0.125f) color = white;
    if (dc < 0.095f) color = blue;
    // The lines between two glazes stand proud of them (cuenca).
    const float ring = std::fmin(std::fmin(std::fabs(d - 0.335f), std::fabs(d - 0.27f)),
                                 std::fmin(std::fabs(radius - petal), std::fabs(dc - 0.155f)));
    const float ridge = smooth_step(0.016f, 0.004f, ring);
    const float pool = fbm(uv * 20.0f, 20, 4, 605);
    const float craze = fbm(uv * 90.0f, 90, 3, 607);
    const float in_tile = smooth_step(0.008f, 0.016f, edge);
    color *= (0.86f + 0.28f * unit(id)) * (1.0f + 0.14f * pool);
    const vec2 tilt(unit(hash(id)) - 0.5f, unit(hash(id + 9)) - 0.5f);
    Texel texel;
    texel.color = glm::mix(vec3(0.46f, 0.41f, 0.33f) * (1.0f + 0.3f * craze), color, in_tile);
    texel.roughness = mix(0.93f, 0.14f + 0.10f * saturate(pool) + 0.10f * ridge, in_tile);
    texel.height = mix(-0.0022f,
                       0.0010f * smooth_step(0.01f, 0.05f, edge) + 0.0009f * ridge +
                           0.0005f * pool + 0.012f * glm::dot(tilt, p) * 0.2f,
                       in_tile);
    return texel;
}

Texel terracotta(vec2 uv) {
    const float cloud = fbm(uv * 3.0f, 3, 6, 621);
    const float rings = fbm(uv * vec2(3.0f, 60.0f), 60, 3, 623);
    const float lime = smooth_step(0.12f, 0.75f, fbm(uv * 4.0f, 4, 6, 625));
    const float grain = fbm(uv * 110.0f, 110, 3, 627);
    vec3 color = glm::mix(vec3(0.52f, 0.205f, 0.095f), vec3(0.62f, 0.30f, 0.155f),
                          saturate(0.5f + 0.7f * cloud));
    color *= 1.0f + 0.07f * rings + 0.10f * grain;
    color = glm::mix(color, vec3(0.70f, 0.60f, 0.49f), 0.45f * lime);
    Texel texel;
    texel.color = color;
    texel.roughness = 0.72f + 0.15f * lime + 0.08f * grain;
    texel.height = 0.0011f * rings + 0.0004f * grain + 0.0008f * cloud;
    return texel;
}

/// Herringbone-like paving of the galleries: small squares set in a basket weave.
Texel paver(vec2 uv) {
    constexpr float kCount = 6.0f;  // baskets a side, two bricks each
    const vec2 p = uv * kCount;
    const glm::ivec2 basket(p);
    vec2 q = glm::fract(p);
    if ((basket.x + basket.y) % 2 == 1) q = {q.y, q.x};
    const int half = q.y < 0.5f ? 0 : 1;
    const vec2 local(q.x, glm::fract(q.y * 2.0f) * 0.5f);
    const float edge =
        std::fmin(std::fmin(local.x, 1.0f - local.x), std::fmin(local.y, 0.5f - local.y));
    const std::uint32_t id = hash(basket.x, basket.y * 2 + half, 641);
    const float chip = fbm(uv * 50.0f, 50, 4, 643);
    const float wear = fbm(uv * 4.0f, 4, 5, 645);
    const float in_brick = smooth_step(0.018f, 0.035f, edge + 0.012f * chip);
    vec3 color = glm::mix(vec3(0.40f, 0.165f, 0.085f), vec3(0.55f, 0.28f, 0.155f), unit(id));
    color *= 1.0f + 0.22f * chip + 0.15f * wear;
    Texel texel;
    texel.color = glm::mix(vec3(0.36f, 0.31f, 0.25f) * (1.0f + 0.3f * chip), color, in_brick);
    texel.roughness = mix(0.95f, 0.52f + 0.22f * wear + 0.1f * chip, in_brick);
    texel.height = mix(-0.003f, 0.0012f * chip + 0.0024f * (unit(hash(id)) - 0.5f), in_brick);
    return texel;
}

/// Turquoise mosaic seen through a rippled surface: the normal is the water's.
Texel water(vec2 uv) {
    const vec2 refraction(fbm(uv * 6.0f, 6, 3, 661), fbm(uv * 6.0f, 6, 3, 663));
    const vec2 p = glm::fract(uv + 0.02f * refraction) * 24.0f;
    const glm::ivec2 cell(p);
    const vec2 q = glm::fract(p);
    const float edge = std::fmin(std::fmin(q.x, 1.0f - q.x), std::fmin(q.y, 1.0f - q.y));
    const float tone = unit(hash(cell.x, cell.y, 665));
    vec3 color = glm::mix(vec3(0.02f, 0.16f, 0.21f), vec3(0.07f, 0.34f, 0.36f), tone);
    color = glm::mix(vec3(0.03f, 0.10f, 0.11f), color, smooth_step(0.03f, 0.09f, edge));
    const float caustic_ridge = 1.0f - std::fabs(fbm(uv * 5.0f + 0.6f * refraction, 5, 4, 667));
    color *= 0.75f + 0.9f * std::pow(saturate(caustic_ridge), 10.0f);
    Texel texel;
    texel.color = color;
    texel.roughness = 0.09f;
    texel.height = 0.010f * fbm(uv * 5.0f + 0.3f * refraction, 5, 3, 669);
    return texel;
}

}  // namespace

std::vector<TextureSet> ceramic_textures() {
    return {
        {.name = "azulejo", .size = 1024, .extent = vec2(0.8f), .texel = azulejo},
        {.name = "terracotta", .size = 512, .extent = vec2(1.0f), .texel = terracotta},
        {.name = "paver", .size = 1024, .extent = vec2(1.8f), .texel = paver},
        {.name = "water", .size = 512, .extent = vec2(1.5f), .roughness = false, .texel = water},
    };
}

}  // namespace assets
