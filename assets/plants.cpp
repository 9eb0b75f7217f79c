// Pots, orange trees, palms and ivy.
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

/// A card with its stem's end at `root`: `along` is its v axis, `width` its size across. It bends
/// back by `bend` at the tip; `lit_from` draws its normals, so that a crown shades as one.
void add_card(Mesh& mesh, vec3 root, vec3 along, vec3 face, float width, float bend,
              vec3 lit_from) {
    constexpr std::uint32_t kSteps = 3;
    const float length = glm::length(along);
    const vec3 up = along / length;
    const vec3 across = glm::normalize(glm::cross(up, face));
    const vec3 normal = glm::cross(across, up);
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t j = 0; j <= kSteps; ++j) {
        const float t = static_cast<float>(j) / kSteps;
        const float angle = bend * t;
        const vec3 centre = root + length * (up * (std::sin(angle + 1e-4f) / (bend + 1e-4f)) -
                                             normal * ((1.0f - std::cos(angle)) / (bend + 1e-4f)));
        const vec3 turned = normal * std::cos(angle) + up * std::sin(angle);
        for (const float side : {-1.0f, 1.0f}) {
            const vec3 p = centre + across * (0.5f * side * width);
            const vec3 shaded = glm::normalize(turned + 0.9f * glm::normalize(p - lit_from));
            mesh.vertices.push_back({p, shaded, {0.5f + 0.5f * side, t}});
        }
    }
    for (std::uint32_t j = 0; j < kSteps; ++j) {
        const std::uint32_t k = base + 2 * j;
        mesh.faces.push_back({k, k + 1, k + 3, k + 2});
    }
}

vec3 on_sphere(Random& random) {
    const float y = random.range(-1.0f, 1.0f);
    const float angle = random.range(0.0f, 2.0f * kPi);
    const float r = std::sqrt(1.0f - y * y);
    return {r * std::sin(angle), y, r * std::cos(angle)};
}

/// A thrown pot, `height` high, with soil; its rim is 0.4 of the height in radius.
void add_pot(Model& model, const mat4& world_from_pot, float height) {
    const float h = height;
    const Profile pot{{{0.0f, 0.0f}, {0.24f * h, 0.0f}},
                      curve({{0.24f * h, 0.0f},
                             {0.33f * h, 0.30f * h},
                             {0.39f * h, 0.62f * h},
                             {0.36f * h, 0.84f * h}},
                            2),
                      curve({{0.36f * h, 0.84f * h},
                             {0.44f * h, 0.90f * h},
                             {0.43f * h, 0.98f * h},
                             {0.40f * h, h}},
                            2),
                      {{0.40f * h, h}, {0.36f * h, 0.99f * h}},
                      {{0.36f * h, 0.99f * h}, {0.35f * h, 0.88f * h}}};
    Mesh mesh = lathe(pot, 24, 2.0f, 1.0f);
    append(model.part("pots", "terracotta"), mesh, world_from_pot);
    append(model.part("pots", "soil"),
           lathe({{{0.355f * h, 0.90f * h}, {0.0f, 0.93f * h}}}, 24, 1.0f, 1.0f), world_from_pot);
}

void add_orange_tree(Model& model, vec3 at, float scale, std::uint32_t seed) {
    Random random(seed);
    const float pot = 0.62f * scale;
    add_pot(model, glm::translate(mat4(1.0f), at), pot);
    const vec3 crown = at + vec3(random.range(-0.04f, 0.04f), pot + 0.95f * scale, 0.0f);
    std::vector<vec3> trunk;
    for (int i = 0; i <= 6; ++i) {
        const float t = static_cast<float>(i) / 6.0f;
        trunk.push_back(glm::mix(at + vec3(0, 0.9f * pot, 0), crown, t) +
                        vec3(0.025f * std::sin(7.0f * t), 0.0f, 0.02f * std::sin(5.0f * t)));
    }
    append(model.part("trunks", "wood"), tube(trunk, 0.045f * scale, 0.022f * scale, 9, 0.8f));
    Mesh& leaves = model.part("trees", "laurel");
    const float radius = 0.46f * scale;
    for (int i = 0; i < 300; ++i) {
        const vec3 out = on_sphere(random);
        const float depth = random.range(0.35f, 0.80f);
        const vec3 root = crown + out * radius * depth * vec3(1.0f, 0.92f, 1.0f);
        const vec3 along = glm::normalize(out + 0.8f * on_sphere(random) + vec3(0.0f, 0.1f, 0.0f));
        const vec3 face = glm::normalize(out + 0.3f * on_sphere(random) + vec3(0.01f, 0.4f, 0.0f));
        const float size = scale * random.range(0.19f, 0.27f);
        add_card(leaves, root, along * size, face, size, random.range(0.2f, 0.8f), crown);
    }
    const Mesh orange = lathe(
        {curve({{0.0f, -0.042f}, {0.03f, -0.03f}, {0.044f, 0.0f}, {0.03f, 0.03f}, {0.0f, 0.040f}},
               1)},
        10, 1.0f, 1.0f);
    for (int i = 0; i < 11; ++i) {
        const vec3 out = glm::normalize(on_sphere(random) - vec3(0.0f, 0.15f, 0.0f));
        append(model.part("trees", "orange_peel"), orange,
               glm::scale(glm::translate(mat4(1.0f), crown + out * radius * 1.04f), vec3(scale)));
    }
}

void add_palm(Model& model, vec3 at, float scale, std::uint32_t seed) {
    Random random(seed);
    const float pot = 0.46f * scale;
    add_pot(model, glm::translate(mat4(1.0f), at), pot);
    const vec3 heart = at + vec3(0.0f, 0.9f * pot, 0.0f);
    Mesh& fronds = model.part("palms", "frond");
    constexpr int kFronds = 17;
    for (int i = 0; i < kFronds; ++i) {
        const float angle = 2.39996f * static_cast<float>(i) + random.range(-0.2f, 0.2f);
        const float age = static_cast<float>(i) / (kFronds - 1.0f);
        const vec3 out(std::sin(angle), 0.0f, std::cos(angle));
        const float lean = mix(0.15f, 0.95f, age);
        const float length = scale * random.range(0.75f, 0.95f);
        const vec3 start = heart + out * 0.03f * scale;
        const auto spine = [=](float t) {
            const float bend = lean + 0.62f * t * (0.5f + age);
            return start + length * t * (out * std::sin(bend) + vec3(0, std::cos(bend), 0));
        };
        const vec3 side = glm::cross(out, vec3(0, 1, 0));
        // Two halves folded along the spine.
        append(fronds, patch(
                           4, 9,
                           [=](float u, float v) {
                               const float across = 2.0f * u - 1.0f;
                               const float fold = 0.10f * std::fabs(across) * length;
                               return spine(v) + side * (0.30f * length * across) -
                                      vec3(0.0f, fold, 0.0f);
                           },
                           [](float u, float v) { return vec2(u, v); }));
    }
}

/// Ivy that climbs a wall from `root`: cards along random walks in the plane of `right` and up,
/// facing `out`, no further than half_width aside.
void add_ivy(Model& model, vec3 root, vec3 right, vec3 out, float half_width, float reach,
             int stems, std::uint32_t seed) {
    Random random(seed);
    Mesh& leaves = model.part("ivy", "ivy");
    for (int stem = 0; stem < stems; ++stem) {
        vec2 at(random.range(-half_width, half_width), 0.15f);
        float heading = random.range(-0.75f, 0.75f);
        const float end = reach * random.range(0.45f, 1.0f);
        for (float gone = 0.0f; gone < end; gone += 0.10f) {
            heading = 0.93f * heading + random.range(-0.28f, 0.28f);
            at += 0.10f * vec2(std::sin(heading), std::cos(heading));
            if (std::fabs(at.x) > half_width) heading = -0.5f * heading;
            at.x = glm::clamp(at.x, -half_width, half_width);
            const float thin = mix(1.0f, 0.55f, gone / end);
            const float size = thin * random.range(0.24f, 0.36f);
            const vec3 p =
                root + right * at.x + vec3(0.0f, at.y, 0.0f) + out * random.range(0.025f, 0.09f);
            const float roll = random.range(-2.4f, 2.4f);
            const vec3 along =
                glm::normalize(right * std::sin(roll) + vec3(0, std::cos(roll), 0) + 0.25f * out);
            const vec3 face = glm::normalize(out + 0.35f * on_sphere(random));
            add_card(leaves, p - 0.4f * size * along, along * size, face, size,
                     random.range(0.1f, 0.5f), p - 0.5f * out);
        }
    }
}

/// Ivy that hangs from a box along `right`.
void add_hanging_ivy(Model& model, vec3 from, vec3 to, vec3 out, float drop, int stems,
                     std::uint32_t seed) {
    Random random(seed);
    Mesh& leaves = model.part("ivy", "ivy");
    for (int stem = 0; stem < stems; ++stem) {
        vec3 at = glm::mix(from, to, random.next());
        const float end = drop * random.range(0.35f, 1.0f);
        for (float gone = 0.0f; gone < end; gone += 0.09f) {
            at += vec3(random.range(-0.03f, 0.03f), -0.09f, random.range(-0.03f, 0.03f));
            const float size = random.range(0.20f, 0.30f);
            const vec3 face = glm::normalize(out + 0.6f * on_sphere(random));
            const vec3 along = glm::normalize(vec3(0, -1, 0) + 0.5f * on_sphere(random));
            add_card(leaves, at + out * random.range(0.02f, 0.07f), along * size, face, size,
                     random.range(0.1f, 0.6f), at - 0.4f * out);
        }
    }
}

}  // namespace

void add_plants(Model& model) {
    const float front_x = kArcadeX + kWallDepth / 2;
    const float front_z = kArcadeZ + kWallDepth / 2;
    add_orange_tree(model, {-4.1f, 0.0f, -1.75f}, 1.25f, 61);
    add_orange_tree(model, {-4.1f, 0.0f, 4.1f}, 1.25f, 62);
    add_orange_tree(model, {6.4f, 0.0f, -1.75f}, 1.25f, 63);
    add_orange_tree(model, {6.4f, 0.0f, 4.1f}, 1.15f, 64);
    const float pot_z = front_z + 0.55f;
    const float pot_x = front_x + 0.55f;
    for (int i = 1; i < kLongBays; ++i) {
        add_palm(model, {kArcadeX + kBay * static_cast<float>(i), 0.0f, pot_z},
                 i % 2 == 0 ? 1.05f : 0.85f, 70 + static_cast<std::uint32_t>(i));
    }
    for (int i = 1; i < kShortBays; ++i) {
        add_palm(model, {pot_x, 0.0f, kArcadeZ + kBay * static_cast<float>(i)},
                 i % 2 == 0 ? 0.85f : 1.0f, 80 + static_cast<std::uint32_t>(i));
    }
    // In the court's inner corner, up the end pier, and over the balustrades.
    add_ivy(model, {front_x + 0.2f, 0.0f, front_z}, {1, 0, 0}, {0, 0, 1}, 0.5f, 4.4f, 12, 91);
    add_ivy(model, {front_x, 0.0f, front_z + 0.2f}, {0, 0, -1}, {1, 0, 0}, 0.5f, 4.2f, 12, 92);
    add_ivy(model, {kEndX, 0.15f, front_z}, {1, 0, 0}, {0, 0, 1}, 0.16f, 3.4f, 5, 93);
    const float ledge = kUpperFloor + 0.08f;
    const float x = kArcadeX + kBay * 4;
    add_hanging_ivy(model, {x + 0.3f, ledge, front_z + 0.2f}, {x + 2.1f, ledge, front_z + 0.2f},
                    {0, 0, 1}, 1.3f, 22, 94);
    const float z = kArcadeZ + kBay;
    add_hanging_ivy(model, {front_x + 0.2f, ledge, z + 0.3f}, {front_x + 0.2f, ledge, z + 2.1f},
                    {1, 0, 0}, 1.2f, 20, 95);
}

}  // namespace assets
