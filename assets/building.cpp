// Floors, back walls, cornices, ceilings and the low walls of the open sides.
#include <array>

#include "assets/noise.h"
#include "assets/scene.h"
#include "assets/shapes.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

constexpr float kFrontX = kArcadeX + kWallDepth / 2;  // the arcades' faces towards the court
constexpr float kFrontZ = kArcadeZ + kWallDepth / 2;
constexpr float kRightX = kEndX + kWallDepth / 2;  // the wings' end faces
constexpr float kNearZ = kEndZ + kWallDepth / 2;
constexpr float kInnerX = kArcadeX - kGallery + 0.15f;  // the back walls, inside and outside
constexpr float kInnerZ = kArcadeZ - kGallery + 0.15f;
constexpr float kOuterX = kInnerX - 0.30f;
constexpr float kOuterZ = kInnerZ - 0.30f;
constexpr float kCeiling = kUpperFloor - 0.25f;

/// Along the fronts of both wings and their ends, outward to the right.
const std::array<vec3, 5> kFacade{vec3(kOuterX, 0, kNearZ), vec3(kFrontX, 0, kNearZ),
                                  vec3(kFrontX, 0, kFrontZ), vec3(kRightX, 0, kFrontZ),
                                  vec3(kRightX, 0, kOuterZ)};

void add_court_floor(Model& model) {
    Mesh& flags = model.part("court", "flagstone");
    Mesh& border = model.part("court", "azulejo");
    // Nested rectangles: marble, a glazed border, flagstones up to the steps and low walls.
    const auto frame = [](Mesh& mesh, vec2 low, vec2 high, vec2 inner_low, vec2 inner_high,
                          float scale) {
        append(mesh, floor(low, {high.x, inner_low.y}, 0.0f, scale));
        append(mesh, floor({low.x, inner_high.y}, high, 0.0f, scale));
        append(mesh, floor({low.x, inner_low.y}, {inner_low.x, inner_high.y}, 0.0f, scale));
        append(mesh, floor({inner_high.x, inner_low.y}, {high.x, inner_high.y}, 0.0f, scale));
    };
    const vec2 low(-4.8f, -2.4f);
    const vec2 high(7.2f, 4.8f);
    append(model.part("court", "marble_tile"), floor(low, high, 0.0f, 1.0f / 2.4f));
    frame(border, low - 0.2f, high + 0.2f, low, high, 1.0f / 0.8f);
    frame(flags, {kFrontX, kFrontZ}, {kRightX - 0.5f, kNearZ - 0.5f}, low - 0.2f, high + 0.2f,
          1.0f / 2.4f);
}

void add_base(Model& model) {
    const std::array<vec3, 5> outline{vec3(kOuterX, 0, kNearZ), vec3(kRightX, 0, kNearZ),
                                      vec3(kRightX, 0, kOuterZ), vec3(kOuterX, 0, kOuterZ),
                                      vec3(kOuterX, 0, kNearZ)};
    Mesh& stone = model.part("base", "limestone");
    append(stone, extrude(sharp({{0.70f, -0.45f},
                                 {0.70f, -0.315f},
                                 {0.685f, -0.30f},
                                 {0.35f, -0.30f},
                                 {0.35f, -0.165f},
                                 {0.335f, -0.15f},
                                 {0.02f, -0.15f},
                                 {0.02f, -0.015f},
                                 {0.005f, 0.0f},
                                 {-0.5f, 0.0f}}),
                          outline, 1.0f));
    append(stone, floor({kOuterX - 0.7f, kOuterZ - 0.7f}, {kRightX + 0.7f, kNearZ + 0.7f}, -0.45f,
                        1.0f, true));
}

void add_galleries(Model& model) {
    Mesh& pavers = model.part("galleries", "paver");
    Mesh& ceilings = model.part("galleries", "wood");
    constexpr float kLip = 0.6f;  // of the stylobate and the string course over the floor
    for (const float y : {kLowerFloor, kUpperFloor}) {
        append(pavers, floor({kInnerX, kInnerZ}, {kRightX - kLip, kFrontZ - kLip}, y, 1 / 1.8f));
        append(pavers,
               floor({kInnerX, kFrontZ - kLip}, {kFrontX - kLip, kNearZ - kLip}, y, 1 / 1.8f));
    }
    for (const float y : {kCeiling, kWallTop}) {
        append(ceilings, floor({kInnerX, kInnerZ}, {kRightX, kFrontZ}, y, 1 / 1.2f, true));
        append(ceilings, floor({kInnerX, kFrontZ}, {kFrontX, kNearZ}, y, 1 / 1.2f, true));
        for (int i = 0; i < 3 * kLongBays; ++i) {
            const float x = kArcadeX + kBay / 3 * (static_cast<float>(i) + 0.5f);
            append(ceilings, box({x - 0.07f, y - 0.18f, kInnerZ - 0.02f},
                                 {x + 0.07f, y + 0.02f, kArcadeZ - 0.2f}, 0.01f, 1 / 1.2f));
        }
        for (int i = 0; i < 3 * kShortBays; ++i) {
            const float z = kArcadeZ + kBay / 3 * (static_cast<float>(i) + 0.5f);
            append(ceilings, box({kInnerX - 0.02f, y - 0.18f, z - 0.07f},
                                 {kArcadeX - 0.2f, y + 0.02f, z + 0.07f}, 0.01f, 1 / 1.2f));
        }
    }
}

void add_back_walls(Model& model) {
    const auto inside = [&](const char* material, float from, float to, float scale) {
        Mesh& mesh = model.part("back_walls", material);
        append(mesh, wall({kInnerX, from, kEndZ}, {kInnerX, to, kInnerZ}, scale));
        append(mesh, wall({kInnerX, from, kInnerZ}, {kEndX, to, kInnerZ}, scale));
    };
    constexpr float kDado = 1.35f;
    inside("azulejo", kLowerFloor, kDado, 1 / 0.8f);
    inside("plaster", kDado, kCeiling, 1 / 3.0f);
    inside("plaster", kUpperFloor, kWallTop, 1 / 3.0f);
    const std::array<vec3, 3> path{vec3(kInnerX, 0, kEndZ), vec3(kInnerX, 0, kInnerZ),
                                   vec3(kEndX, 0, kInnerZ)};
    const Profile rail{{{0.0f, 1.33f}, {0.03f, 1.34f}},
                       curve({{0.03f, 1.34f}, {0.045f, 1.365f}, {0.03f, 1.39f}}, 3),
                       {{0.03f, 1.39f}, {0.0f, 1.41f}}};
    append(model.part("back_walls", "limestone"), extrude(rail, path, 1.0f));

    Mesh& outside = model.part("outer_walls", "brick");
    constexpr float kTop = 8.50f;
    append(outside, wall({kEndX, 0, kOuterZ}, {kOuterX, kTop, kOuterZ}, 1 / 1.44f));
    append(outside, wall({kOuterX, 0, kOuterZ}, {kOuterX, kTop, kEndZ}, 1 / 1.44f));
}

void add_courses(Model& model) {
    Mesh& stone = model.part("courses", "limestone");
    append(
        stone,
        extrude(sharp({{0.12f, 0.0f}, {0.12f, 0.13f}, {0.10f, kLowerFloor}, {-0.6f, kLowerFloor}}),
                kFacade, 1.0f));
    // The string course between the storeys, whose top carries the balustrade.
    const float y = kCeiling;
    const Profile string{
        {{0.0f, y - 0.16f}, {0.04f, y - 0.14f}},
        {{0.04f, y - 0.14f}, {0.04f, y - 0.08f}},
        curve({{0.04f, y - 0.08f}, {0.07f, y - 0.02f}, {0.14f, y + 0.03f}, {0.17f, y + 0.09f}}, 3),
        {{0.17f, y + 0.09f}, {0.20f, y + 0.09f}},
        {{0.20f, y + 0.09f}, {0.20f, y + 0.25f}},
        {{0.20f, y + 0.25f}, {0.18f, y + 0.27f}},
        {{0.18f, y + 0.27f}, {-0.6f, y + 0.27f}},
        {{-0.6f, y + 0.27f}, {-0.6f, y + 0.2f}}};
    append(stone, extrude(string, kFacade, 1.0f));
    const float t = kWallTop;
    const Profile cornice{{{0.0f, t - 0.10f}, {0.03f, t - 0.08f}},
                          {{0.03f, t - 0.08f}, {0.03f, t}},
                          curve({{0.03f, t}, {0.13f, t + 0.05f}, {0.17f, t + 0.15f}}, 4),
                          {{0.17f, t + 0.15f}, {0.20f, t + 0.15f}},
                          {{0.20f, t + 0.15f}, {0.20f, t + 0.25f}},
                          {{0.20f, t + 0.25f}, {-0.1f, t + 0.25f}}};
    append(stone, extrude(cornice, kFacade, 1.0f));
}

/// A tiled bench wall along an edge of the court, from `low` to `high` in plan.
void add_bench(Model& model, vec2 low, vec2 high) {
    append(model.part("benches", "azulejo"),
           box({low.x, 0.06f, low.y}, {high.x, 0.48f, high.y}, 0.008f, 1 / 0.8f));
    Mesh& stone = model.part("benches", "limestone");
    append(stone, box({low.x - 0.03f, -0.01f, low.y - 0.03f},
                      {high.x + 0.03f, 0.08f, high.y + 0.03f}, 0.012f, 1.0f));
    append(stone, box({low.x - 0.05f, 0.47f, low.y - 0.05f},
                      {high.x + 0.05f, 0.55f, high.y + 0.05f}, 0.02f, 1.0f));
}

}  // namespace

void add_walls_and_floors(Model& model) {
    add_base(model);
    add_court_floor(model);
    add_galleries(model);
    add_back_walls(model);
    add_courses(model);
    constexpr float kBenchZ = kNearZ - 0.45f;
    add_bench(model, {-5.2f, kBenchZ}, {-0.4f, kNearZ - 0.05f});
    add_bench(model, {2.8f, kBenchZ}, {7.6f, kNearZ - 0.05f});
}

}  // namespace assets
