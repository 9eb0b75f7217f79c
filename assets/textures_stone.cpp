// Marble, flagstones, limestone, carved voussoirs, plaster and brick.
#include "assets/noise.h"
#include "assets/textures.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// A block of a regular bond: where in it a point lies and which one it is.
struct Block {
    vec2 local;  ///< metres from the block's lower left corner
    vec2 size;   ///< metres
    float edge;  ///< metres to the nearest edge
    std::uint32_t id;
};

Block finish_block(vec2 local, vec2 size, std::uint32_t id) {
    const vec2 inset = glm::min(local, size - local);
    return {local, size, std::fmin(inset.x, inset.y), id};
}

Block block_at(vec2 uv, vec2 extent, glm::ivec2 count, float shift, std::uint32_t seed) {
    vec2 p = uv * vec2(count);
    const auto row = static_cast<std::int32_t>(p.y);
    p.x += shift * static_cast<float>(row % 2);
    const auto column = wrap(static_cast<std::int32_t>(std::floor(p.x)), count.x);
    const vec2 size = extent / vec2(count);
    return finish_block(glm::fract(p) * size, size, hash(column, row, seed));
}

/// Courses of blocks of uneven width.
Block flag_at(vec2 uv, vec2 extent, glm::ivec2 count, std::uint32_t seed) {
    const float course = uv.y * static_cast<float>(count.y);
    const auto row = static_cast<std::int32_t>(course);
    const float x = uv.x * static_cast<float>(count.x);
    const auto boundary = [&](std::int32_t i) {
        const std::uint32_t h = hash(wrap(i, count.x), row, seed);
        return static_cast<float>(i) + 0.62f * unit(h);
    };
    auto i = static_cast<std::int32_t>(x);
    if (x < boundary(i)) --i;
    const vec2 unit_size = extent / vec2(count);
    const float width = boundary(i + 1) - boundary(i);
    return finish_block(vec2(x - boundary(i), glm::fract(course)) * unit_size,
                        vec2(width, 1.0f) * unit_size, hash(wrap(i, count.x), row, seed + 1));
}

float veins(vec2 p, std::int32_t period, std::uint32_t seed) {
    const vec2 warp(fbm(p, period, 4, seed), fbm(p, period, 4, seed + 10));
    const float ridge = 1.0f - std::fabs(fbm(p + 1.1f * warp, period, 5, seed + 20)) * 2.2f;
    return saturate(ridge);
}

Texel marble_tile(vec2 uv) {
    constexpr float kExtent = 2.4f;
    const Block tile = block_at(uv, vec2(kExtent), {4, 4}, 0.0f, 11);
    const auto checker = static_cast<int>(uv.x * 4.0f) + static_cast<int>(uv.y * 4.0f);
    const vec2 offset(unit(tile.id) * 40.0f, unit(hash(tile.id)) * 40.0f);
    const vec2 p = tile.local * 4.0f + offset;
    const float vein = veins(p, 64, 21);
    const float thin = std::pow(vein, 9.0f);
    const float cloud = 0.5f + 0.5f * fbm(p * 0.7f, 64, 4, 41);
    vec3 color;
    if (checker % 2 == 0) {
        color = glm::mix(vec3(0.80f, 0.74f, 0.63f), vec3(0.70f, 0.60f, 0.46f), cloud);
        color = glm::mix(color, vec3(0.42f, 0.31f, 0.20f), 0.75f * thin);
    } else {
        color = glm::mix(vec3(0.045f, 0.085f, 0.07f), vec3(0.09f, 0.15f, 0.115f), cloud);
        color = glm::mix(color, vec3(0.50f, 0.52f, 0.45f), 0.85f * std::pow(vein, 14.0f));
    }
    color *= 0.92f + 0.16f * unit(hash(tile.id + 7));
    const float grain = fbm(uv * 96.0f, 96, 4, 51);
    const float worn = smooth_step(-0.1f, 0.7f, fbm(uv * 5.0f, 5, 5, 61));
    const float in_tile = smooth_step(0.0045f, 0.007f, tile.edge + 0.0008f * grain);
    const float grit = fbm(uv * 160.0f, 160, 3, 71);
    const vec3 grout = vec3(0.30f, 0.265f, 0.215f) * (1.0f + 0.35f * grit);
    const vec2 tilt(unit(hash(tile.id + 1)) - 0.5f, unit(hash(tile.id + 2)) - 0.5f);
    const float bevel = smooth_step(0.005f, 0.022f, tile.edge);
    Texel texel;
    texel.color = glm::mix(grout, color, in_tile);
    texel.roughness = mix(0.92f, 0.17f + 0.20f * worn + 0.04f * grain, in_tile);
    texel.height = mix(
        -0.0022f + 0.0006f * grit,
        0.0014f * bevel + 0.012f * glm::dot(tilt, tile.local - tile.size * 0.5f) - 0.0002f * thin,
        in_tile);
    return texel;
}

Texel flagstone(vec2 uv) {
    constexpr float kExtent = 2.4f;
    const float wobble = 0.006f * fbm(uv * 14.0f, 14, 3, 101);
    const Block flag = flag_at(uv, vec2(kExtent), {4, 5}, 103);
    const vec2 offset(unit(flag.id) * 30.0f, unit(hash(flag.id)) * 30.0f);
    const float bumps = fbm(flag.local * 5.0f + offset, 64, 6, 105);
    const float pits = smooth_step(0.25f, 0.0f, cells(uv * 70.0f, 70, 107).nearest) *
                       smooth_step(0.0f, 0.5f, fbm(uv * 9.0f, 9, 3, 108));
    const float stain = fbm(uv * 3.0f, 3, 5, 109);
    const float edge = flag.edge + wobble + 0.004f * fbm(uv * 60.0f, 60, 3, 111);
    const float in_flag = smooth_step(0.009f, 0.017f, edge);
    const float crown = smooth_step(0.008f, 0.05f, edge);
    const float warm = unit(hash(flag.id + 3));
    vec3 color = glm::mix(vec3(0.44f, 0.375f, 0.295f), vec3(0.52f, 0.47f, 0.40f), warm);
    color *= (0.80f + 0.35f * unit(hash(flag.id + 5))) * (1.0f + 0.28f * bumps + 0.16f * stain);
    color *= 1.0f - 0.35f * pits;
    const float soil_noise = fbm(uv * 110.0f, 110, 3, 113);
    const vec3 moss = glm::mix(vec3(0.16f, 0.13f, 0.095f), vec3(0.10f, 0.125f, 0.045f),
                               smooth_step(-0.1f, 0.4f, stain));
    Texel texel;
    texel.color = glm::mix(moss * (1.0f + 0.5f * soil_noise), color, in_flag);
    texel.roughness = mix(0.97f, 0.80f - 0.14f * crown + 0.12f * bumps, in_flag);
    texel.height = mix(-0.007f + 0.002f * soil_noise,
                       0.006f * crown + 0.008f * bumps - 0.003f * pits, in_flag);
    return texel;
}

Texel limestone(vec2 uv) {
    const float coarse = fbm(uv * 4.0f, 4, 6, 201);
    const float strata = fbm(uv * vec2(2.0f, 12.0f), 12, 4, 203);
    const Cell shell = cells(uv * 26.0f, 26, 205);
    const float hole = smooth_step(mix(0.08f, 0.20f, unit(shell.id)), 0.03f, shell.nearest) *
                       smooth_step(0.55f, 0.75f, unit(hash(shell.id)));
    const float grain = fbm(uv * 128.0f, 128, 2, 207);
    vec3 color = glm::mix(vec3(0.76f, 0.69f, 0.56f), vec3(0.66f, 0.56f, 0.42f),
                          saturate(0.45f + 0.6f * coarse));
    color *= 1.0f + 0.06f * strata + 0.06f * grain - 0.30f * hole;
    Texel texel;
    texel.color = color;
    texel.roughness = 0.66f + 0.12f * coarse + 0.08f * grain + 0.15f * hole;
    texel.height = 0.0012f * coarse + 0.0006f * strata + 0.00025f * grain - 0.0018f * hole;
    return texel;
}

/// Red and cream stones, each with a carved leaf that leans towards +u, so that a mirrored half
/// is seen as such. u runs along the arch, v from the opening outward.
Texel voussoir(vec2 uv) {
    const vec2 extent(0.84f);
    const Block stone = block_at(uv, extent, {4, 4}, 0.0f, 301);
    const bool red = static_cast<int>(uv.x * 4.0f) % 2 == 0;
    const vec2 p = (stone.local - 0.5f * stone.size) / stone.size.y;
    // A leaf along the diagonal: pointed ellipse with a midrib and ribs that run off it.
    const vec2 axis = glm::normalize(vec2(0.45f, 1.0f));
    const vec2 leaf(glm::dot(p, axis), glm::dot(p, vec2(axis.y, -axis.x)));
    const float along = saturate((leaf.x + 0.36f) / 0.72f);
    const float width = 0.30f * std::sqrt(std::sin(kPi * along)) * (1.25f - 0.7f * along);
    const float inside = smooth_step(0.0f, 0.055f, width - std::fabs(leaf.y));
    const float rib = std::fabs(std::sin((leaf.x - 0.8f * std::fabs(leaf.y)) * 26.0f));
    const float midrib = smooth_step(0.03f, 0.0f, std::fabs(leaf.y));
    const float carve = inside * (0.75f + 0.18f * rib + 0.3f * midrib);
    const float grain = fbm(uv * 64.0f, 64, 4, 303);
    const float wear = fbm(uv * 8.0f, 8, 5, 305);
    const float in_stone = smooth_step(0.0025f, 0.005f, stone.edge + 0.0006f * grain);
    const float border =
        smooth_step(0.010f, 0.016f, stone.edge) * (1.0f - smooth_step(0.018f, 0.026f, stone.edge));
    vec3 color = red ? vec3(0.47f, 0.125f, 0.065f) : vec3(0.80f, 0.72f, 0.57f);
    color *= (0.9f + 0.2f * unit(stone.id)) * (1.0f + 0.16f * grain + 0.2f * wear);
    color *= 1.0f - 0.25f * inside * (1.0f - rib) + 0.1f * inside;
    Texel texel;
    texel.color = glm::mix(vec3(0.42f, 0.36f, 0.28f), color, in_stone);
    texel.roughness = mix(0.95f, 0.62f + 0.15f * wear, in_stone);
    texel.height = mix(-0.0025f, 0.007f * carve + 0.003f * border + 0.0005f * grain, in_stone);
    return texel;
}

Texel plaster(vec2 uv) {
    const float trowel = fbm(uv * vec2(5.0f, 7.0f) + 0.4f * fbm(uv * 4.0f, 4, 3, 401), 35, 5, 403);
    const float stain = fbm(uv * 2.0f, 2, 6, 405);
    const float grain = fbm(uv * 150.0f, 150, 2, 407);
    const Cell crack_cell = cells(uv * 5.0f + 0.35f * fbm(uv * 10.0f, 10, 4, 409), 5, 411);
    const float crack = smooth_step(0.016f, 0.003f, crack_cell.second - crack_cell.nearest) *
                        smooth_step(0.05f, 0.35f, fbm(uv * 3.0f, 3, 3, 413));
    const float bare = smooth_step(0.42f, 0.47f, fbm(uv * 3.0f, 3, 6, 415));
    vec3 color = glm::mix(vec3(0.80f, 0.62f, 0.38f), vec3(0.72f, 0.49f, 0.26f),
                          smooth_step(-0.5f, 0.6f, stain));
    color *= 1.0f + 0.10f * trowel + 0.05f * grain;
    color = glm::mix(color, vec3(0.62f, 0.55f, 0.45f) * (1.0f + 0.25f * grain), bare);
    color *= 1.0f - 0.6f * crack;
    Texel texel;
    texel.color = color;
    texel.roughness = 0.84f + 0.10f * stain - 0.08f * trowel + 0.08f * bare;
    texel.height =
        0.0045f * trowel + 0.0008f * grain * (1.0f + 1.5f * bare) - 0.004f * bare - 0.004f * crack;
    return texel;
}

Texel brick(vec2 uv) {
    const vec2 extent(1.44f, 1.44f);
    const Block brick = block_at(uv, extent, {6, 18}, 0.5f, 501);
    const float chip = fbm(uv * 48.0f, 48, 4, 503);
    const float grain = fbm(uv * 120.0f, 120, 3, 505);
    const float in_brick = smooth_step(0.0045f, 0.009f, brick.edge + 0.0035f * chip);
    const float tone = unit(brick.id);
    vec3 color = glm::mix(vec3(0.40f, 0.145f, 0.075f), vec3(0.50f, 0.25f, 0.135f), tone);
    color *= 0.82f + 0.36f * unit(hash(brick.id));
    color *= 1.0f + 0.25f * grain;
    const float lime = smooth_step(0.15f, 0.75f, fbm(uv * 5.0f, 5, 5, 507));
    color = glm::mix(color, vec3(0.62f, 0.56f, 0.48f), 0.35f * lime);
    const vec3 mortar = vec3(0.52f, 0.46f, 0.37f) * (1.0f + 0.3f * grain);
    Texel texel;
    texel.color = glm::mix(mortar, color, in_brick);
    texel.roughness = mix(0.96f, 0.82f + 0.1f * grain, in_brick);
    texel.height = mix(-0.005f + 0.0012f * grain,
                       0.0016f * chip + 0.0008f * grain + 0.003f * (tone - 0.5f), in_brick);
    return texel;
}

}  // namespace

std::vector<TextureSet> stone_textures() {
    return {
        {.name = "marble_tile", .size = 1024, .extent = vec2(2.4f), .texel = marble_tile},
        {.name = "flagstone", .size = 1024, .extent = vec2(2.4f), .texel = flagstone},
        {.name = "limestone", .size = 1024, .extent = vec2(1.0f), .texel = limestone},
        {.name = "voussoir", .size = 1024, .extent = vec2(0.84f), .texel = voussoir},
        {.name = "plaster", .size = 1024, .extent = vec2(3.0f), .texel = plaster},
        {.name = "brick", .size = 512, .extent = vec2(1.44f), .texel = brick},
    };
}

}  // namespace assets
