// Curtains, carpets, lanterns, chains and their posts.
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

constexpr float kSpringing = kLowerFloor + kColumn;

/// Bay `i` of an arcade: x runs along it, z into the court, the arch's centre is x = 0.
mat4 long_bay(int i) {
    return glm::translate(mat4(1.0f),
                          vec3(kArcadeX + kBay * (static_cast<float>(i) + 0.5f), 0.0f, kArcadeZ));
}

mat4 short_bay(int i) {
    const mat4 at = glm::translate(
        mat4(1.0f), vec3(kArcadeX, 0.0f, kArcadeZ + kBay * (static_cast<float>(i) + 0.5f)));
    return glm::rotate(at, kPi / 2, vec3(0, 1, 0));
}

/// One half of a pair of curtains, hung from a rod and drawn aside by a tie. `side` is -1 for the
/// left half.
void add_curtain(Model& model, const mat4& world_from_bay, const std::string& cloth, float side,
                 std::uint32_t seed) {
    constexpr float kTop = kSpringing - 0.06f;
    constexpr float kTie = 1.15f;
    constexpr float kHem = kLowerFloor + 0.04f;
    constexpr float kOuter = 0.86f;
    Random random(seed);
    const float phase = random.range(0.0f, 6.0f);
    const float folds = 6.0f;
    const auto position = [=](float u, float v) {
        const float y = mix(kHem, kTop, v);
        const float above = saturate((y - kTie) / (kTop - kTie));
        const float below = saturate((kTie - y) / (kTie - kHem));
        // The inner edge falls from the middle of the rod to the tie, then spreads a little.
        const float width = y > kTie ? mix(0.17f, kOuter - 0.01f, std::pow(above, 1.6f))
                                     : mix(0.17f, 0.36f, std::sqrt(below));
        const float gather = 1.0f - 0.75f * std::exp(-30.0f * (y - kTie) * (y - kTie));
        const float depth = mix(0.075f, 0.035f, above) * gather;
        const float sway = 0.25f * std::sin(5.0f * v + phase) + 0.15f * std::sin(11.0f * v);
        const float fold = std::sin(2.0f * kPi * folds * u + phase + sway) +
                           0.35f * std::sin(2.0f * kPi * 2.3f * folds * u + 2.0f * phase);
        const float x = side * (kOuter - width * (1.0f - u));
        return vec3(x, y, depth * fold + 0.10f * (1.0f - u) * (1.0f - gather));
    };
    const auto point = [=](float u, float v) { return position(side < 0 ? 1.0f - u : u, v); };
    append(model.part("curtains", cloth),
           patch(44, 28, point,
                 [=](float u, float v) {
                     return vec2(1.5f * u, v * (kTop - kHem)) / 0.9f + 0.1f * phase;
                 }),
           world_from_bay);
    // The tie.
    const Profile band{curve({{0.10f, -0.035f}, {0.115f, 0.0f}, {0.10f, 0.035f}}, 2)};
    append(model.part("ties", "brass"), lathe(band, 20, 2.0f, 2.0f),
           glm::translate(world_from_bay, vec3(side * (kOuter - 0.085f), kTie, 0.0f)));
}

void add_curtains(Model& model, const mat4& world_from_bay, const std::string& cloth,
                  std::uint32_t seed) {
    add_curtain(model, world_from_bay, cloth, -1.0f, seed);
    add_curtain(model, world_from_bay, cloth, 1.0f, seed + 1);
    const std::array<vec3, 2> rod{vec3(-0.97f, kSpringing - 0.05f, 0.0f),
                                  vec3(0.97f, kSpringing - 0.05f, 0.0f)};
    append(model.part("rods", "brass"), tube(rod, 0.018f, 0.018f, 10, 1.0f), world_from_bay);
}

/// A carpet over the balustrade's rail.
void add_carpet(Model& model, const mat4& world_from_bay) {
    constexpr float kRail = kUpperFloor + 0.02f + 0.885f;
    constexpr float kHalf = 0.13f;   // of the rail, with some air
    constexpr float kFront = 1.05f;  // how far it hangs in front
    append(model.part("carpets", "carpet"),
           patch(
               24, 44,
               [](float u, float v) {
                   const float s = v * (kFront + 2.0f * kHalf + 0.5f) - kFront;
                   const float x = (u - 0.5f) * 1.15f;
                   const float wave = 0.012f * std::sin(9.0f * x + 4.0f * v) * saturate(-3.0f * s);
                   const float ease = 0.02f;  // rounds the rail's edges
                   const float over = saturate(s / (2.0f * kHalf));
                   const float angle = kPi * over;
                   if (s < 0.0f) return vec3(x, kRail + s, kHalf + ease + wave);
                   if (s > 2.0f * kHalf) {
                       return vec3(x, kRail - (s - 2.0f * kHalf), -kHalf - ease);
                   }
                   return vec3(x, kRail + 0.035f * std::sin(angle),
                               (kHalf + ease) * std::cos(angle));
               },
               [](float u, float v) { return vec2(u, v * 1.5f); }),
           world_from_bay);
}

/// A chain along a path: two crossed cards. One repeat of the texture is `pitch` long and wide.
void add_chain(Model& model, const std::vector<vec3>& path, float pitch) {
    Mesh& mesh = model.part("chains", "chain");
    for (int card = 0; card < 2; ++card) {
        float along = 0.5f * static_cast<float>(card);
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::size_t i = 0; i < path.size(); ++i) {
            const vec3 before = path[i == 0 ? 0 : i - 1];
            const vec3 after = path[std::min(i + 1, path.size() - 1)];
            const vec3 direction = glm::normalize(after - before);
            if (i > 0) along += glm::length(path[i] - before) / pitch;
            const vec3 level = std::fabs(direction.y) > 0.95f
                                   ? vec3(1, 0, 0)
                                   : glm::normalize(glm::cross(direction, vec3(0, 1, 0)));
            const vec3 across = card == 0 ? glm::normalize(glm::cross(level, direction)) : level;
            const vec3 normal = glm::cross(across, direction);
            constexpr float kHalf = 0.26f;  // of the texture's width that the links take
            for (const float end : {-kHalf, kHalf}) {
                mesh.vertices.push_back(
                    {path[i] + across * (end * pitch), normal, {0.5f + end, along}});
            }
            if (i == 0) continue;
            const auto k = base + 2 * static_cast<std::uint32_t>(i);
            mesh.faces.push_back({k - 2, k - 1, k + 1, k});
        }
    }
}

/// Hangs between two points, `sag` below their middle.
std::vector<vec3> swag(vec3 from, vec3 to, float sag) {
    constexpr int kSteps = 20;
    std::vector<vec3> path;
    for (int i = 0; i <= kSteps; ++i) {
        const float t = static_cast<float>(i) / kSteps;
        path.push_back(glm::mix(from, to, t) - vec3(0.0f, 4.0f * sag * t * (1.0f - t), 0.0f));
    }
    return path;
}

/// A lantern of pierced brass whose ring is at the origin; 0.62 high.
void add_lantern(Model& model, const mat4& world_from_lantern) {
    const Profile cap{
        {{0.17f, -0.225f}, {0.175f, -0.21f}},
        curve({{0.175f, -0.21f}, {0.11f, -0.16f}, {0.05f, -0.09f}, {0.03f, -0.05f}}, 4),
        curve({{0.03f, -0.05f}, {0.04f, -0.03f}, {0.0f, 0.0f}}, 3)};
    const Profile foot{curve({{0.0f, -0.64f}, {0.025f, -0.61f}, {0.015f, -0.585f}}, 3),
                       curve({{0.015f, -0.585f}, {0.06f, -0.56f}, {0.13f, -0.50f}}, 3),
                       {{0.13f, -0.50f}, {0.13f, -0.485f}}};
    const Profile body{
        curve({{0.125f, -0.49f}, {0.165f, -0.42f}, {0.182f, -0.33f}, {0.168f, -0.222f}}, 4)};
    const Profile glass{curve(
        {{0.0f, -0.50f}, {0.09f, -0.46f}, {0.115f, -0.36f}, {0.08f, -0.25f}, {0.0f, -0.22f}}, 4)};
    append(model.part("lanterns", "brass"), lathe(cap, 20, 1.0f, 2.0f), world_from_lantern);
    append(model.part("lanterns", "brass"), lathe(foot, 20, 1.0f, 2.0f), world_from_lantern);
    append(model.part("lanterns", "pierced_brass"), lathe(body, 24, 2.0f, 3.3f),
           world_from_lantern);
    append(model.part("lanterns", "lamp_glass"), lathe(glass, 12, 1.0f, 1.0f), world_from_lantern);
}

void add_hanging_lantern(Model& model, const mat4& world_from_bay, float top, float length) {
    const vec3 hook(world_from_bay * glm::vec4(0.0f, top, 0.0f, 1.0f));
    add_chain(model, {hook, hook - vec3(0, length / 2, 0), hook - vec3(0, length, 0)}, 0.12f);
    add_lantern(model, glm::translate(world_from_bay, vec3(0.0f, top - length, 0.0f)));
}

/// Stone posts along the open side at +x with chains between them.
void add_posts(Model& model) {
    constexpr float kHeight = 1.0f;
    const float x = kEndX;
    const Profile post{
        {{0.20f, 0.0f}, {0.20f, 0.14f}},
        curve({{0.20f, 0.14f}, {0.15f, 0.17f}, {0.135f, 0.22f}}, 3),
        curve({{0.135f, 0.22f}, {0.12f, 0.50f}, {0.105f, 0.76f}}, 3),
        curve({{0.105f, 0.76f}, {0.15f, 0.79f}, {0.105f, 0.82f}}, 3),
        curve({{0.105f, 0.82f}, {0.13f, 0.90f}, {0.09f, 0.98f}, {0.0f, kHeight}}, 4)};
    const Mesh stone = lathe(post, 24, 1.0f, 1.0f);
    const Mesh ring =
        lathe({curve({{0.118f, 0.70f}, {0.128f, 0.72f}, {0.118f, 0.74f}}, 3)}, 24, 1.0f, 2.0f);
    std::vector<vec3> hooks;
    for (int i = 1; i <= kShortBays; ++i) {
        const vec3 at(x, 0.0f, kArcadeZ + kBay * static_cast<float>(i));
        append(model.part("posts", "limestone"), stone, glm::translate(mat4(1.0f), at));
        append(model.part("posts", "iron"), ring, glm::translate(mat4(1.0f), at));
        hooks.push_back(at + vec3(0.0f, 0.72f, 0.0f));
    }
    hooks.insert(hooks.begin(), vec3(x, 0.87f, kArcadeZ + 0.27f));
    for (std::size_t i = 0; i + 1 < hooks.size(); ++i) {
        add_chain(model, swag(hooks[i], hooks[i + 1], 0.30f), 0.22f);
    }
}

}  // namespace

void add_furnishings(Model& model) {
    add_curtains(model, long_bay(1), "curtain_red", 51);
    add_curtains(model, long_bay(3), "curtain_teal", 53);
    add_curtains(model, long_bay(5), "curtain_red", 55);
    add_curtains(model, short_bay(1), "curtain_teal", 57);
    add_curtains(model, short_bay(3), "curtain_red", 59);
    add_carpet(model, long_bay(2));
    add_carpet(model, short_bay(2));
    constexpr float kCrown = kSpringing + kArchRadius;
    for (const int i : {0, 2, 4}) add_hanging_lantern(model, long_bay(i), kCrown, 0.55f);
    for (const int i : {0, 2}) add_hanging_lantern(model, short_bay(i), kCrown, 0.55f);
    constexpr float kUpperCrown = kUpperFloor + 0.02f + kUpperColumn + kArchRadius;
    for (const int i : {1, 4}) add_hanging_lantern(model, long_bay(i), kUpperCrown, 0.4f);
    add_hanging_lantern(model, short_bay(3), kUpperCrown, 0.4f);
    add_posts(model);
}

}  // namespace assets
