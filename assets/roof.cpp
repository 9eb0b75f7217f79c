// The galleries' lean-to roofs of barrel tiles.
#include <cmath>

#include "assets/noise.h"
#include "assets/scene.h"
#include "assets/shapes.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

constexpr float kEave = -0.40f;  // depth of the eave before the arcade's face
constexpr float kRidge = 2.95f;  // depth of the ridge behind it
constexpr float kBase = kWallTop + 0.40f;
constexpr float kPitch = 0.286f;
constexpr float kOverhang = 0.15f;  // past the wing's end

/// One wing's roof: a point is (along, depth, height above the slope). Both wings start at the
/// inner corner, where along = depth = 0; the two slopes meet in the valley along = -+depth.
struct Wing {
    vec3 along;
    vec3 depth;
    float valley_sign;  ///< the valley is at along = valley_sign * depth
    float end;          ///< along at the gable

    vec3 at(float s, float d, float height) const {
        const vec3 corner(kArcadeX + kWallDepth / 2, kBase, kArcadeZ + kWallDepth / 2);
        return corner + along * s + depth * d + vec3(0.0f, kPitch * d + height, 0.0f);
    }
    /// From the valley or the gable, whichever is on the low side of `along`, to the other.
    float low(float d) const { return valley_sign < 0 ? -d : end; }
    float high(float d) const { return valley_sign < 0 ? end : d; }
};

void add_deck(Model& model, const Wing& wing) {
    const auto slope = [&](float height) {
        return [&wing, height](float s, float t) {
            const float d = mix(kEave, kRidge, t);
            return wing.at(mix(wing.low(d), wing.high(d), s), d, height);
        };
    };
    const auto uv = [&](float s, float t) {
        const float d = mix(kEave, kRidge, t);
        return vec2(mix(wing.low(d), wing.high(d), s), d);
    };
    append(model.part("roof", "terracotta"), patch(12, 3, slope(0.0f), uv));
    const auto under = slope(-0.06f);
    append(model.part("roof", "wood"),
           patch(
               12, 3, [&](float s, float t) { return under(1.0f - s, t); },
               [&](float s, float t) { return uv(1.0f - s, t) / 1.2f; }));
    // The boards' edges at eave and gable.
    append(model.part("roof", "wood"), patch(
                                           12, 1,
                                           [&](float s, float t) {
                                               return wing.at(
                                                   mix(wing.low(kEave), wing.high(kEave), s), kEave,
                                                   mix(-0.06f, 0.0f, t));
                                           },
                                           [&](float s, float t) { return vec2(s, 0.05f * t); }));
}

void add_tile(Mesh& mesh, const Wing& wing, float s, float d, Random& random) {
    constexpr float kLength = 0.46f;
    const vec2 offset(random.next(), random.next());
    const float skew = random.range(-0.012f, 0.012f);
    const float lift = random.range(0.0f, 0.012f);
    append(mesh, patch(
                     6, 1,
                     [&](float u, float v) {
                         const float radius = mix(0.108f, 0.086f, v);
                         const float angle = kPi * (1.0f - u);
                         return wing.at(
                             s + radius * std::cos(angle) + skew * v, d + kLength * v,
                             radius * std::sin(angle) - 0.01f + lift + 0.035f * (1.0f - v));
                     },
                     [&](float u, float v) { return offset + vec2(0.35f * u, kLength * v); }));
}

void add_wing(Model& model, const Wing& wing, std::uint32_t seed) {
    constexpr float kSpacing = 0.225f;
    constexpr float kCourse = 0.40f;
    add_deck(model, wing);
    Random random(seed);
    Mesh& tiles = model.part("roof_tiles", "terracotta");
    for (float d = kEave - 0.06f; d < kRidge - 0.3f; d += kCourse) {
        const float low = wing.low(d);
        const float high = wing.high(d);
        // Counted from the gable, so that rows stay in line.
        const int count = static_cast<int>((high - low) / kSpacing);
        for (int i = 0; i <= count; ++i) {
            const float from_end = 0.11f + kSpacing * static_cast<float>(i);
            if (from_end > high - low + 0.05f) continue;
            add_tile(tiles, wing, wing.valley_sign < 0 ? high - from_end : low + from_end, d,
                     random);
        }
    }
    const float length = wing.high(kRidge) - wing.low(kRidge);
    const int count = static_cast<int>(length / 0.42f);
    for (int i = 0; i < count; ++i) {
        const float s = wing.low(kRidge) + length * static_cast<float>(i) / count;
        append(tiles, patch(
                          1, 6,
                          [&](float u, float v) {
                              const float radius = mix(0.14f, 0.125f, u);
                              const float angle = kPi * v;
                              return wing.at(s + 0.47f * u,
                                             kRidge - 0.10f - radius * std::cos(angle),
                                             radius * std::sin(angle) + 0.02f * u +
                                                 kPitch * radius * std::cos(angle));
                          },
                          [&](float u, float v) { return vec2(0.47f * u, 0.4f * v); }));
    }
}

/// The walls above the end arches, up to the slope.
void add_gable(Mesh& mesh, const Wing& wing, bool at_high) {
    const float wall_end = wing.end + (at_high ? -kOverhang : kOverhang);
    append(mesh, patch(
                     3, 1,
                     [&](float s, float t) {
                         const float d = mix(at_high ? 0.0f : 2.8f, at_high ? 2.8f : 0.0f, s);
                         vec3 p = wing.at(wall_end, d, -0.06f);
                         p.y = mix(kWallTop, p.y, t);
                         return p;
                     },
                     [&](float s, float t) { return vec2(s * 2.8f, t * 0.8f) / 3.0f; }));
}

}  // namespace

void add_roof(Model& model) {
    constexpr float kLong = kBay * kLongBays + kOverhang;
    constexpr float kShort = kBay * kShortBays + kOverhang;
    const Wing long_wing{{1, 0, 0}, {0, 0, -1}, -1.0f, kLong};
    const Wing short_wing{{0, 0, -1}, {-1, 0, 0}, 1.0f, -kShort};
    add_wing(model, long_wing, 31);
    add_wing(model, short_wing, 32);
    add_gable(model.part("gables", "plaster"), long_wing, true);
    add_gable(model.part("gables", "plaster"), short_wing, false);
}

}  // namespace assets
