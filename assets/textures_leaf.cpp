// Leaves painted on cards: colour, mask and relief.
#include <algorithm>

#include "assets/noise.h"
#include "assets/textures.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// A leaf on the card. `shape` maps (t along the midrib in [0, 1], s across, both in units of the
/// length) to the signed distance inside the outline, about.
struct Leaf {
    vec2 base;
    float angle;   ///< of the midrib from +v, counter-clockwise
    float length;  ///< in units of the card
    float tone;    ///< [0, 1], dark to light
};

enum class Outline { laurel, ivy };

/// How far inside the outline, in units of the leaf's length; < 0 outside.
float inside(Outline outline, float t, float s) {
    if (outline == Outline::laurel) {
        if (t < 0.0f || t > 1.0f) return -std::fmax(-t, t - 1.0f) - std::fabs(s) * 0.2f;
        return 0.24f * std::pow(std::sin(kPi * std::pow(t, 0.85f)), 0.85f) - std::fabs(s);
    }
    const vec2 p(s, t - 0.34f);
    const float angle = std::atan2(p.x, p.y);
    const float lobes = std::pow(std::fabs(std::cos(2.5f * angle)), 0.8f);
    const float reach = 0.62f - 0.16f * std::fabs(angle) / kPi - 0.22f * std::fabs(angle) / kPi;
    const float notch = 0.20f * smooth_step(2.55f, 3.1f, std::fabs(angle));
    return reach * (0.52f + 0.48f * lobes) - notch - glm::length(p);
}

struct Painted {
    Texel texel;
    float coverage;  ///< in units of the card: > 0 inside a leaf
};

/// Paints a leaf over what is there.
void paint(Painted& under, const Leaf& leaf, Outline outline, vec2 uv, int order, vec3 dark,
           vec3 light) {
    const vec2 d = uv - leaf.base;
    if (glm::dot(d, d) > 1.5f * leaf.length * leaf.length) return;
    const vec2 axis(-std::sin(leaf.angle), std::cos(leaf.angle));
    const float t = glm::dot(d, axis) / leaf.length;
    const float s = glm::dot(d, vec2(axis.y, -axis.x)) / leaf.length;
    const float in = inside(outline, t, s);
    const float coverage = in * leaf.length;
    under.coverage = std::fmax(under.coverage, coverage);
    if (in < 0.0f) return;
    const float side = std::fabs(s);
    const float midrib = smooth_step(0.022f, 0.004f, side);
    const float vein_phase =
        outline == Outline::laurel ? (t - 1.1f * side) * 9.0f : std::atan2(s, t - 0.1f) * 2.6f;
    const float vein = smooth_step(0.14f, 0.0f, std::fabs(glm::fract(vein_phase) - 0.5f));
    const float mottle = fbm(uv * 24.0f, 24, 4, 901);
    const float rim = smooth_step(0.05f, 0.0f, in);
    vec3 color = glm::mix(dark, light, saturate(leaf.tone + 0.25f * mottle));
    color = glm::mix(color, light * vec3(1.5f, 1.35f, 1.1f), 0.45f * midrib + 0.16f * vein);
    color = glm::mix(color, light * vec3(1.25f, 0.95f, 0.6f), 0.3f * rim);
    under.texel.color = color;
    under.texel.roughness = 0.44f + 0.10f * mottle + 0.12f * vein;
    under.texel.height = 0.004f * static_cast<float>(order % 5) +
                         0.25f * leaf.length * std::sqrt(std::fmax(in, 0.0f)) * 0.35f -
                         0.006f * midrib - 0.003f * vein;
}

Texel card(const std::vector<Leaf>& leaves, Outline outline, vec2 uv, vec3 dark, vec3 light,
           vec2 stem_from, vec2 stem_to) {
    Painted painted{{.color = 0.5f * (dark + light)}, -1.0f};
    if (stem_from != stem_to) {
        const vec2 along = stem_to - stem_from;
        const float h = saturate(glm::dot(uv - stem_from, along) / glm::dot(along, along));
        const float in = mix(0.013f, 0.005f, h) - glm::length(uv - stem_from - along * h);
        painted.coverage = in;
        if (in > 0.0f) painted.texel.color = vec3(0.16f, 0.12f, 0.05f);
    }
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        paint(painted, leaves[i], outline, uv, static_cast<int>(i), dark, light);
    }
    painted.texel.alpha = smooth_step(-0.0015f, 0.0015f, painted.coverage);
    return painted.texel;
}

std::vector<Leaf> laurel_leaves() {
    Random random(911);
    std::vector<Leaf> leaves;
    for (int i = 0; i < 13; ++i) {
        const float t = static_cast<float>(i) / 12.0f;
        const float side = i % 2 == 0 ? 1.0f : -1.0f;
        leaves.push_back({{0.5f + 0.01f * side, 0.06f + 0.56f * t},
                          side * (1.15f - 0.95f * t + random.range(-0.15f, 0.15f)),
                          random.range(0.33f, 0.40f) * (1.0f - 0.15f * t),
                          random.next()});
    }
    return leaves;
}

std::vector<Leaf> ivy_leaves() {
    Random random(921);
    std::vector<Leaf> leaves;
    for (int i = 0; i < 9; ++i) {
        const vec2 cell(i % 3, i / 3);
        leaves.push_back({vec2(0.19f, 0.12f) + cell * vec2(0.31f, 0.27f) +
                              vec2(random.range(-0.05f, 0.05f), random.range(-0.04f, 0.04f)),
                          random.range(-0.9f, 0.9f), random.range(0.24f, 0.33f), random.next()});
    }
    return leaves;
}

std::vector<Leaf> frond_leaflets() {
    Random random(931);
    std::vector<Leaf> leaves;
    constexpr int kPairs = 26;
    for (int i = 0; i < kPairs; ++i) {
        const float t = static_cast<float>(i) / (kPairs - 1.0f);
        const float length = 0.47f * std::pow(std::sin(kPi * (0.12f + 0.86f * t)), 0.7f);
        for (const float side : {-1.0f, 1.0f}) {
            leaves.push_back({{0.5f, 0.02f + 0.93f * t},
                              side * (1.25f - 0.55f * t + random.range(-0.05f, 0.05f)),
                              length,
                              random.next()});
        }
    }
    return leaves;
}

/// Slim leaflets: a laurel leaf with its width scaled down.
Texel frond(const std::vector<Leaf>& leaflets, vec2 uv) {
    const vec3 dark(0.035f, 0.13f, 0.02f);
    const vec3 light(0.13f, 0.30f, 0.05f);
    Painted painted{{.color = 0.5f * (dark + light)}, -1.0f};
    const float rachis = 0.009f - std::fabs(uv.x - 0.5f);
    for (const Leaf& leaf : leaflets) {
        const vec2 d = uv - leaf.base;
        const vec2 axis(-std::sin(leaf.angle), std::cos(leaf.angle));
        const float t = glm::dot(d, axis) / leaf.length;
        const float across = glm::dot(d, vec2(axis.y, -axis.x));
        if (t < 0.0f || t > 1.0f) continue;
        const float width = 0.019f * std::pow(std::sin(kPi * std::pow(t, 0.6f)), 0.7f);
        const float in = width - std::fabs(across);
        if (in > 0.0f && painted.coverage <= 0.0f) {
            const float crease = smooth_step(0.004f, 0.0f, std::fabs(across));
            painted.texel.color = glm::mix(dark, light, saturate(leaf.tone * 0.7f + 0.3f * t)) *
                                  (1.0f + 0.4f * crease);
            painted.texel.height = 0.02f + 0.4f * in - 0.003f * crease;
        }
        painted.coverage = std::fmax(painted.coverage, in);
    }
    if (rachis > 0.0f) {
        painted.texel.color = vec3(0.20f, 0.26f, 0.07f);
        painted.texel.height = 0.025f + rachis;
    }
    painted.texel.alpha = smooth_step(-0.001f, 0.001f, std::fmax(painted.coverage, rachis));
    return painted.texel;
}

}  // namespace

std::vector<TextureSet> leaf_textures() {
    const auto leaf_set = [](std::string name, std::function<Texel(vec2)> texel) {
        return TextureSet{.name = std::move(name),
                          .size = 1024,
                          .extent = vec2(1.0f),
                          .roughness = false,
                          .mask = true,
                          .texel = std::move(texel)};
    };
    return {
        leaf_set("laurel",
                 [leaves = laurel_leaves()](vec2 uv) {
                     return card(leaves, Outline::laurel, uv, {0.022f, 0.095f, 0.018f},
                                 {0.085f, 0.23f, 0.04f}, {0.5f, 0.0f}, {0.5f, 0.66f});
                 }),
        leaf_set("ivy",
                 [leaves = ivy_leaves()](vec2 uv) {
                     return card(leaves, Outline::ivy, uv, {0.028f, 0.11f, 0.02f},
                                 {0.12f, 0.26f, 0.055f}, {0, 0}, {0, 0});
                 }),
        leaf_set("frond", [leaves = frond_leaflets()](vec2 uv) { return frond(leaves, uv); }),
    };
}

}  // namespace assets
