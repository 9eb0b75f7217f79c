// Damask curtains with gold thread, carpets and planks.
#include "assets/noise.h"
#include "assets/textures.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// Over and under of a plain weave, about [-1, 1].
float weave(vec2 uv, float threads) {
    const vec2 p = uv * threads;
    const float warp = std::cos(2.0f * kPi * p.x);
    const float weft = std::cos(2.0f * kPi * p.y);
    const bool over = (static_cast<int>(p.x) + static_cast<int>(p.y)) % 2 == 0;
    return over ? 0.6f * warp + 0.4f : 0.6f * weft - 0.1f;
}

/// An ogee lattice with a palmette in each mesh: 1 on the ornament, 0 on the ground.
float damask(vec2 uv) {
    const vec2 p = uv * vec2(2.0f, 2.0f);
    const float wave = 0.25f + 0.22f * std::sin(2.0f * kPi * p.y);
    const float x = glm::fract(p.x);
    const float lattice = std::fmin(std::fabs(x - wave), std::fabs(1.0f - x - wave));
    float ornament = smooth_step(0.035f, 0.022f, lattice);
    for (int k = 0; k < 2; ++k) {
        vec2 q = glm::fract(p + vec2(0.5f * static_cast<float>(k), 0.5f * static_cast<float>(k))) -
                 vec2(0.5f, k == 0 ? 0.25f : 0.25f);
        q.y -= 0.0f;
        const float angle = std::atan2(q.x, q.y);
        const float petals = 0.105f + 0.05f * std::cos(7.0f * angle) + 0.05f * std::cos(angle);
        const float r = glm::length(q);
        ornament = std::fmax(ornament, smooth_step(0.012f, 0.0f, r - petals) *
                                           smooth_step(0.025f, 0.035f, std::fabs(r - 0.075f)));
    }
    return ornament;
}

Texel curtain(vec2 uv, vec3 ground, vec3 ornament, bool gold) {
    const float pattern = damask(uv);
    const float thread = weave(uv, 160.0f);
    const float fade = fbm(uv * 3.0f, 3, 4, 801);
    Texel texel;
    texel.color =
        glm::mix(ground, ornament, pattern) * (0.92f + 0.08f * thread) * (1.0f + 0.12f * fade);
    texel.roughness = mix(0.82f, gold ? 0.46f : 0.60f, pattern) + 0.05f * thread;
    texel.metalness = gold ? 0.85f * pattern : 0.0f;
    texel.height = 0.0006f * thread + 0.0016f * pattern;
    return texel;
}

Texel carpet(vec2 uv) {
    const vec2 p = glm::abs(uv - 0.5f) * 2.0f;
    const float border = std::fmax(p.x, p.y);
    const float stitch = weave(uv, 128.0f);
    const vec3 red(0.36f, 0.035f, 0.03f);
    const vec3 navy(0.02f, 0.035f, 0.12f);
    const vec3 cream(0.66f, 0.54f, 0.36f);
    const vec3 ochre(0.55f, 0.27f, 0.05f);
    const vec2 q = glm::fract(uv * 10.0f) - 0.5f;
    const float diamond = std::fabs(q.x) + std::fabs(q.y);
    vec3 color = diamond < 0.2f ? cream : (diamond < 0.34f ? navy : red);
    const float medallion = p.x * 1.4f + p.y;
    if (medallion < 0.95f) color = navy;
    if (medallion < 0.88f) color = diamond < 0.22f ? red : ochre;
    if (medallion < 0.42f) color = diamond < 0.25f ? cream : red;
    if (border > 0.72f) color = diamond < 0.26f ? cream : navy;
    if (std::fabs(border - 0.74f) < 0.02f || std::fabs(border - 0.95f) < 0.025f) color = ochre;
    Texel texel;
    texel.color = color * (0.85f + 0.15f * stitch) * (1.0f + 0.15f * fbm(uv * 6.0f, 6, 5, 821));
    texel.roughness = 0.93f;
    texel.height = 0.0012f * stitch;
    return texel;
}

Texel wood(vec2 uv) {
    constexpr float kPlanks = 6.0f;
    const float x = uv.x * kPlanks;
    const auto plank = static_cast<std::int32_t>(x);
    const std::uint32_t id = hash(plank, 0, 841);
    const float across = glm::fract(x);
    const float edge = std::fmin(across, 1.0f - across) / kPlanks;
    const float offset = unit(id);
    const vec2 p(across + 3.0f * unit(hash(id)), uv.y + offset);
    const float bend = 0.6f * fbm(vec2(p.x, p.y * 2.0f), 64, 3, 843) +
                       0.25f * fbm(vec2(uv.x * 6.0f, uv.y * 2.0f), 12, 3, 844);
    const float rings = 0.5f + 0.5f * std::sin(2.0f * kPi * (across * 3.5f + 2.4f * bend + offset));
    const float fibre = fbm(vec2(uv.x * 180.0f, uv.y * 6.0f), 180, 3, 845);
    const float gap = smooth_step(0.0022f, 0.005f, edge);
    vec3 color =
        glm::mix(vec3(0.235f, 0.115f, 0.052f), vec3(0.14f, 0.062f, 0.027f), std::pow(rings, 2.0f));
    color *= (0.8f + 0.4f * unit(hash(id + 4))) * (1.0f + 0.25f * fibre);
    Texel texel;
    texel.color = color * mix(0.15f, 1.0f, gap);
    texel.roughness = mix(0.95f, 0.55f + 0.12f * rings + 0.12f * fibre, gap);
    texel.height = mix(
        -0.004f, 0.0007f * fibre - 0.0006f * rings + 0.0015f * smooth_step(0.0f, 0.02f, edge), gap);
    return texel;
}

}  // namespace

std::vector<TextureSet> cloth_and_wood_textures() {
    const vec3 crimson(0.42f, 0.022f, 0.03f);
    const vec3 teal(0.02f, 0.15f, 0.20f);
    const vec3 gold(0.85f, 0.58f, 0.22f);
    const vec3 pale(0.20f, 0.40f, 0.42f);
    return {
        {.name = "curtain_red",
         .size = 1024,
         .extent = vec2(0.9f),
         .metalness = true,
         .texel = [=](vec2 uv) { return curtain(uv, crimson, gold, true); }},
        {.name = "curtain_teal",
         .size = 512,
         .extent = vec2(0.9f),
         .normal = false,
         .texel = [=](vec2 uv) { return curtain(uv, teal, pale, false); }},
        {.name = "carpet", .size = 512, .extent = vec2(1.2f), .roughness = false, .texel = carpet},
        {.name = "wood", .size = 512, .extent = vec2(1.2f), .texel = wood},
    };
}

}  // namespace assets
