// Columns, piers, arches with mirrored UVs, balustrades.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "assets/noise.h"
#include "assets/scene.h"
#include "assets/shapes.h"

namespace assets {
namespace {

using glm::mat4;
using glm::vec2;
using glm::vec3;

constexpr float kHalfDepth = kWallDepth / 2;
constexpr float kOuterRadius = 1.15f;  // of the archivolt
constexpr float kRelief = 0.03f;       // of the archivolt before the wall
constexpr float kBead = 0.025f;
constexpr int kArchSegments = 32;  // even: the keystone seam falls on a vertex

/// Half of the bay's width left and right of the arch's centre, on the front.
struct BayWidth {
    float left = kBay / 2;
    float right = kBay / 2;
};

/// Places a bay: its x runs along the arcade, its z out of it; the arch's centre is x = 0.
struct Bay {
    mat4 world_from_bay;
    BayWidth width;
};

mat4 place(float x, float z, bool facing_x) {
    const mat4 moved = glm::translate(mat4(1.0f), vec3(x, 0.0f, z));
    return facing_x ? glm::rotate(moved, kPi / 2, vec3(0, 1, 0)) : moved;
}

std::vector<Bay> all_bays() {
    constexpr float kHalf = kBay / 2;
    constexpr float kToCorner = kHalf + kHalfDepth;
    constexpr float kToBackWall = kHalf + 0.15f;
    std::vector<Bay> bays;
    for (int i = 0; i < kLongBays; ++i) {
        const float x = kArcadeX + kBay * (static_cast<float>(i) + 0.5f);
        bays.push_back({place(x, kArcadeZ, false),
                        {i == 0 ? kToCorner : kHalf, i + 1 == kLongBays ? kToCorner : kHalf}});
    }
    for (int i = 0; i < kShortBays; ++i) {
        const float z = kEndZ - kBay * (static_cast<float>(i) + 0.5f);
        bays.push_back({place(kArcadeX, z, true),
                        {i == 0 ? kToCorner : kHalf, i + 1 == kShortBays ? kToCorner : kHalf}});
    }
    bays.push_back({place(kEndX, kArcadeZ - kHalf, true), {kToCorner, kToBackWall}});
    bays.push_back({place(kArcadeX - kHalf, kEndZ, false), {kToBackWall, kToCorner}});
    return bays;
}

/// The angle on an arch that runs from its left springing (s = 0) over the crown to the right.
vec2 on_arch(float s) {
    return {-std::cos(kPi * s), std::sin(kPi * s)};
}

/// Runs up to the crown and back again: the right half mirrors the left one.
float mirrored(float s) {
    return 2.0f * (s < 0.5f ? s : 1.0f - s);
}

/// The face of the arch's stones and its bead, on the front of a wall around z = 0.
void add_archivolt(Mesh& stones, Mesh& bead, float springing) {
    constexpr float kBeadRadius = kOuterRadius - kBead;
    append(stones, patch(
                       kArchSegments, 1,
                       [&](float s, float t) {
                           const float radius = mix(kArchRadius, kBeadRadius - kBead, t);
                           return vec3(on_arch(s) * radius + vec2(0.0f, springing),
                                       kHalfDepth + kRelief);
                       },
                       [](float s, float t) { return vec2(2.0f * mirrored(s), 0.25f * t); }));
    append(bead, patch(
                     kArchSegments, 4,
                     [&](float s, float t) {
                         const vec2 around(-std::cos(kPi * t), std::sin(kPi * t));
                         return vec3(
                             on_arch(s) * (kBeadRadius + kBead * around.x) + vec2(0.0f, springing),
                             kHalfDepth + mix(kRelief, 0.0f, t) + kBead * around.y);
                     },
                     [](float s, float t) { return vec2(2.0f * mirrored(s), 0.1f * t); }));
}

/// The wall above and beside an arch, on the front.
Mesh spandrel(BayWidth width, float springing, float top, float u_offset) {
    constexpr int kRows = 2;
    constexpr float kScale = 1.0f / 3.0f;
    const auto uv_of = [&](vec3 p) { return vec2(p.x + u_offset, p.y) * kScale; };
    Mesh mesh;
    const auto add = [&](int columns, const std::function<vec2(float)>& bottom) {
        const auto position = [&](float s, float t) {
            const vec2 low = bottom(s);
            return vec3(low.x, mix(low.y, top, t), kHalfDepth);
        };
        append(mesh, patch(columns, kRows, position,
                           [&](float s, float t) { return uv_of(position(s, t)); }));
    };
    add(kArchSegments, [&](float s) { return on_arch(s) * kOuterRadius + vec2(0.0f, springing); });
    add(1, [&](float s) { return vec2(mix(-width.left, -kOuterRadius, s), springing); });
    add(1, [&](float s) { return vec2(mix(kOuterRadius, width.right, s), springing); });
    for (Vertex& vertex : mesh.vertices) vertex.normal = vec3(0, 0, 1);
    return mesh;
}

void add_arch(Model& model, const Bay& bay, float springing, float top, float u_offset) {
    Mesh stones;
    Mesh bead;
    add_archivolt(stones, bead, springing);
    const mat4 half_turn = glm::rotate(bay.world_from_bay, kPi, vec3(0, 1, 0));
    Mesh& voussoirs = model.part("arches", "voussoir");
    Mesh& beads = model.part("archivolts", "limestone");
    Mesh& walls = model.part("spandrels", "plaster");
    append(voussoirs, stones, bay.world_from_bay);
    append(voussoirs, stones, half_turn);
    append(beads, bead, bay.world_from_bay);
    append(beads, bead, half_turn);
    append(walls, spandrel(bay.width, springing, top, u_offset), bay.world_from_bay);
    append(walls, spandrel({bay.width.right, bay.width.left}, springing, top, u_offset + 1.1f),
           half_turn);
    constexpr float kHalfSoffit = kHalfDepth + kRelief;
    append(voussoirs,
           patch(
               kArchSegments, 1,
               [&](float s, float t) {
                   return vec3(on_arch(s) * kArchRadius + vec2(0.0f, springing),
                               mix(-kHalfSoffit, kHalfSoffit, t));
               },
               [](float s, float t) { return vec2(2.0f * mirrored(s), 0.75f * t); }),
           bay.world_from_bay);
}

/// A bell with two rows of leaves that curl outward; from y = 0 to `height`.
Mesh capital(float neck, float lip, float height) {
    const auto leaf = [](float angle, float t, float from, float to, float turn) {
        const float local = (t - from) / (to - from);
        if (local <= 0.0f || local >= 1.12f) return 0.0f;
        const float around = std::cos(4.0f * angle + turn);
        const float width = mix(1.25f, 0.45f, local * local);
        const float blade = smooth_step(1.0f - width, 1.0f, around);
        const float curl = 0.010f + 0.052f * std::pow(saturate(local), 3.0f);
        const float tip = 1.0f - smooth_step(0.98f, 1.12f, local);
        const float ribs = 1.0f - 0.16f * std::fabs(std::sin(12.0f * angle + 3.0f * turn));
        return curl * blade * tip * ribs;
    };
    return patch(
        48, 16,
        [=](float u, float v) {
            const float angle = 2.0f * kPi * u;
            float radius = mix(neck, lip, std::pow(std::fmax(v, 0.0f), 2.4f));
            radius += leaf(angle, v, 0.0f, 0.52f, 0.0f) + leaf(angle, v, 0.28f, 0.86f, kPi) +
                      0.6f * leaf(angle, v, 0.55f, 0.98f, 0.0f);
            return vec3(radius * std::sin(angle), v * height, radius * std::cos(angle));
        },
        [=](float u, float v) { return vec2(u, v * height); });
}

/// A column with its foot at y = 0 and its abacus' top at `height`.
void add_column(Model& model, const mat4& world_from_column, float height, float twist) {
    constexpr float kFoot = 0.30f;
    constexpr float kCapital = 0.42f;
    constexpr float kAbacus = 0.10f;
    constexpr float kRadius = 0.165f;
    const float shaft_top = height - kCapital - kAbacus;
    Mesh& stone = model.part("columns", "limestone");
    append(stone, box({-0.25f, 0, -0.25f}, {0.25f, 0.11f, 0.25f}, 0.012f, 1.0f), world_from_column);
    const Profile foot{curve({{0.215f, 0.11f}, {0.24f, 0.14f}, {0.215f, 0.175f}}, 2),
                       {{0.215f, 0.175f}, {0.20f, 0.18f}},
                       curve({{0.20f, 0.18f}, {0.178f, 0.205f}, {0.193f, 0.23f}}, 2),
                       curve({{0.193f, 0.23f}, {0.21f, 0.25f}, {0.193f, 0.272f}}, 2),
                       curve({{0.193f, 0.272f}, {0.175f, 0.28f}, {0.168f, 0.30f}}, 2)};
    append(stone, lathe(foot, 24, 1.0f, 1.0f), world_from_column);
    const auto shaft = [&](float u, float v) {
        const float angle = 2.0f * kPi * u;
        const float fade = smooth_step(0.0f, 0.05f, v) * (1.0f - smooth_step(0.95f, 1.0f, v));
        const float flute = std::fabs(std::sin(8.0f * angle + twist * v));
        const float radius = kRadius * (1.0f - 0.14f * v * v) * (1.0f - 0.085f * fade * flute);
        return vec3(radius * std::sin(angle), mix(kFoot, shaft_top, v), radius * std::cos(angle));
    };
    append(model.part("shafts", "limestone"),
           patch(48, twist == 0.0f ? 8 : 16, shaft,
                 [&](float u, float v) { return vec2(u, mix(kFoot, shaft_top, v)); }),
           world_from_column);
    const Profile ring{curve({{0.145f, -0.035f}, {0.17f, -0.015f}, {0.145f, 0.005f}}, 4)};
    const mat4 at_capital = glm::translate(world_from_column, vec3(0, shaft_top, 0));
    append(stone, lathe(ring, 24, 1.0f, 1.0f), at_capital);
    append(stone, capital(0.142f, 0.235f, kCapital), at_capital);
    append(stone, box({-0.30f, height - kAbacus, -0.30f}, {0.30f, height, 0.30f}, 0.015f, 1.0f),
           world_from_column);
}

/// A square pier with base and impost, from y = 0 to `height`.
void add_pier(Model& model, const mat4& world_from_pier, float height) {
    Mesh& stone = model.part("piers", "limestone");
    const auto add = [&](float half, float from, float to) {
        append(stone, box({-half, from, -half}, {half, to, half}, 0.015f, 1.0f), world_from_pier);
    };
    add(0.31f, 0.0f, 0.22f);
    add(0.285f, 0.22f, 0.30f);
    add(kHalfDepth, 0.30f, height - 0.18f);
    add(0.27f, height - 0.18f, height - 0.12f);
    add(0.30f, height - 0.12f, height);
}

void add_supports(Model& model, float floor_y, float height, float twist) {
    const mat4 up = glm::translate(mat4(1.0f), vec3(0.0f, floor_y, 0.0f));
    for (int i = 0; i <= kLongBays; ++i) {
        const mat4 at = up * place(kArcadeX + kBay * static_cast<float>(i), kArcadeZ, false);
        const bool pier = i == 0 || i == kLongBays;
        pier ? add_pier(model, at, height) : add_column(model, at, height, twist);
    }
    for (int i = 1; i <= kShortBays; ++i) {
        const mat4 at = up * place(kArcadeX, kArcadeZ + kBay * static_cast<float>(i), false);
        i == kShortBays ? add_pier(model, at, height) : add_column(model, at, height, twist);
    }
    add_pier(model, up * place(kEndX, kArcadeZ - kGallery, false), height);
    add_pier(model, up * place(kArcadeX - kGallery, kEndZ, false), height);
}

/// Between the supports of one bay of the upper storey; its foot is y = 0.
void add_balustrade(Model& model, const mat4& world_from_bay) {
    Mesh& stone = model.part("balustrades", "limestone");
    append(stone, box({-1.0f, -0.01f, -0.11f}, {1.0f, 0.08f, 0.11f}, 0.012f, 1.0f), world_from_bay);
    append(stone, box({-1.04f, 0.76f, -0.12f}, {1.04f, 0.88f, 0.12f}, 0.02f, 1.0f), world_from_bay);
    const Profile baluster{{{0.070f, 0.08f}, {0.070f, 0.12f}},
                           curve({{0.055f, 0.125f},
                                  {0.040f, 0.15f},
                                  {0.062f, 0.24f},
                                  {0.078f, 0.31f},
                                  {0.062f, 0.41f},
                                  {0.034f, 0.56f},
                                  {0.032f, 0.64f},
                                  {0.045f, 0.66f}},
                                 1),
                           curve({{0.045f, 0.66f}, {0.060f, 0.68f}, {0.045f, 0.70f}}, 1),
                           {{0.068f, 0.70f}, {0.068f, 0.76f}}};
    const Mesh turned = lathe(baluster, 10, 1.0f, 1.0f);
    constexpr int kCount = 7;
    for (int i = 0; i < kCount; ++i) {
        const float x = 0.245f * (static_cast<float>(i) - 0.5f * (kCount - 1));
        append(stone, turned, glm::translate(world_from_bay, vec3(x, 0.0f, 0.0f)));
    }
}

}  // namespace

void add_arcades(Model& model) {
    constexpr float kUpperFoot = kUpperFloor + 0.02f;  // on the string course
    add_supports(model, kLowerFloor, kColumn, 0.0f);
    add_supports(model, kUpperFoot, kUpperColumn, 7.0f);
    float u_offset = 0.0f;
    for (const Bay& bay : all_bays()) {
        add_arch(model, bay, kLowerFloor + kColumn, kUpperFloor - 0.25f, u_offset);
        add_arch(model, bay, kUpperFoot + kUpperColumn, kWallTop, u_offset + 1.7f);
        add_balustrade(model, glm::translate(bay.world_from_bay, vec3(0, kUpperFoot, 0)));
        u_offset += kBay;
    }
}

}  // namespace assets
