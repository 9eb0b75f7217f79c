// A round pool in the middle of the court, in it a plinth with the lion's head.
#include <glm/gtc/matrix_transform.hpp>

#include "assets/lion.h"
#include "assets/noise.h"
#include "assets/scene.h"
#include "assets/shapes.h"

namespace assets {
namespace {

using glm::mat4;
using glm::vec2;
using glm::vec3;

constexpr float kPoolRadius = 2.05f;
constexpr float kPlinthTop = 1.38f;
constexpr float kLionScale = 1.05f;

void add_pool(Model& model, const mat4& world_from_pool) {
    const float r = kPoolRadius;
    Mesh& stone = model.part("pool", "limestone");
    const Profile foot{{{r + 0.16f, 0.0f}, {r + 0.16f, 0.07f}},
                       curve({{r + 0.16f, 0.07f}, {r + 0.12f, 0.11f}, {r + 0.08f, 0.13f}}, 3)};
    const Profile rim{{{r + 0.08f, 0.36f}, {r + 0.11f, 0.37f}},
                      curve({{r + 0.11f, 0.37f}, {r + 0.16f, 0.41f}, {r + 0.11f, 0.45f}}, 4),
                      {{r + 0.11f, 0.45f}, {r - 0.16f, 0.45f}},
                      curve({{r - 0.16f, 0.45f}, {r - 0.19f, 0.43f}, {r - 0.16f, 0.40f}}, 3),
                      {{r - 0.16f, 0.40f}, {r - 0.16f, 0.29f}}};
    append(stone, lathe(foot, 64, 14.0f, 1.0f), world_from_pool);
    append(stone, lathe(rim, 64, 14.0f, 1.0f), world_from_pool);
    // Sixteen tiles of the glaze's pattern go around, one and a quarter up.
    append(model.part("pool", "azulejo"),
           lathe({{{r + 0.08f, 0.13f}, {r + 0.08f, 0.36f}}}, 64, 17.0f, 1.25f), world_from_pool);
    Mesh& water = model.part("pool", "water");
    append(water,
           patch(
               64, 5,
               [&](float u, float v) {
                   const float angle = 2.0f * kPi * u;
                   const float radius = mix(r - 0.15f, 0.45f, v);
                   return vec3(radius * std::sin(angle), 0.33f, radius * std::cos(angle));
               },
               [&](float u, float v) {
                   const float angle = 2.0f * kPi * u;
                   const float radius = mix(r - 0.15f, 0.45f, v);
                   return radius * vec2(std::sin(angle), -std::cos(angle)) / 1.5f;
               }),
           world_from_pool);
}

/// An eight-sided pedestal with mouldings; its flat faces are turned to the lion's.
void add_plinth(Model& model, const mat4& world_from_plinth) {
    std::vector<vec3> outline;
    for (int i = 0; i <= 8; ++i) {
        const float angle = 2.0f * kPi * (static_cast<float>(i % 8) + 0.5f) / 8.0f;
        outline.push_back(vec3(std::sin(angle), 0.0f, std::cos(angle)) * 0.52f);
    }
    const auto moulding = [&](const Profile& profile, const char* material, float scale) {
        append(model.part("plinth", material), extrude(profile, outline, scale), world_from_plinth);
    };
    const float t = kPlinthTop;
    moulding({{{0.20f, 0.20f}, {0.20f, 0.42f}},
              curve({{0.20f, 0.42f}, {0.12f, 0.46f}, {0.06f, 0.54f}}, 4),
              {{0.06f, 0.54f}, {0.02f, 0.56f}}},
             "limestone", 1.0f);
    moulding({{{0.0f, 0.56f}, {0.0f, t - 0.26f}}}, "azulejo", 1 / 0.8f);
    moulding({{{0.02f, t - 0.26f}, {0.05f, t - 0.24f}},
              curve({{0.05f, t - 0.24f}, {0.08f, t - 0.15f}, {0.17f, t - 0.10f}}, 4),
              {{0.17f, t - 0.10f}, {0.19f, t - 0.10f}},
              {{0.19f, t - 0.10f}, {0.19f, t - 0.02f}},
              {{0.19f, t - 0.02f}, {0.17f, t}},
              {{0.17f, t}, {-0.30f, t}}},
             "limestone", 1.0f);
    append(model.part("plinth", "limestone"),
           lathe({{{0.0f, t - 0.002f}, {0.3f, t - 0.002f}}}, 8, 1.0f, 1.0f), world_from_plinth);
}

}  // namespace

void add_sculpture(Model& model) {
    const mat4 at = glm::translate(mat4(1.0f), kSculpture);
    add_pool(model, at);
    // The lion looks out of the court's open corner.
    const mat4 turned = glm::rotate(at, kPi / 4, vec3(0, 1, 0));
    add_plinth(model, turned);
    const mat4 on_plinth = glm::scale(
        glm::translate(turned, vec3(0.0f, kPlinthTop + kLionScale * kLionBottom - 0.01f, 0.0f)),
        vec3(kLionScale));
    append(model.part("lion", "bronze"), lion_head(), on_plinth);
}

}  // namespace assets
