#include "assets/lion.h"

#include <array>
#include <cmath>

#include "assets/noise.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// Union with a fillet about k wide (Quilez, "smooth minimum": the quadratic polynomial).
float join(float a, float b, float k) {
    const float h = std::fmax(k - std::fabs(a - b), 0.0f) / k;
    return std::fmin(a, b) - 0.25f * k * h * h;
}

float cut(float solid, float hole, float k) {
    return -join(-solid, hole, k);
}

float ellipsoid(vec3 p, vec3 centre, vec3 radii) {
    const vec3 q = (p - centre) / radii;
    const float length = glm::length(q);
    return length * (length - 1.0f) / std::fmax(glm::length(q / radii), 1e-6f);
}

float capsule(vec3 p, vec3 a, vec3 b, float radius_a, float radius_b) {
    const vec3 along = b - a;
    const float t = saturate(glm::dot(p - a, along) / glm::dot(along, along));
    return glm::length(p - a - along * t) - mix(radius_a, radius_b, t);
}

vec3 turn_y(vec3 p, float angle) {
    const float c = std::cos(angle);
    const float s = std::sin(angle);
    return {c * p.x - s * p.z, p.y, s * p.x + c * p.z};
}

/// Skull, brow, bridge of the nose, cheeks and jaw; q is p with x >= 0.
float skull(vec3 p, vec3 q) {
    float d = ellipsoid(p, {0, 0.14f, -0.02f}, {0.35f, 0.37f, 0.37f});
    d = join(d, ellipsoid(q, {0.19f, -0.03f, 0.17f}, {0.17f, 0.20f, 0.20f}), 0.10f);
    // The flat forehead with its furrow, and brows that overhang the eyes.
    d = join(d, ellipsoid(p, {0, 0.30f, 0.19f}, {0.20f, 0.16f, 0.15f}), 0.08f);
    d = cut(d, capsule(p, {0, 0.25f, 0.385f}, {0, 0.40f, 0.35f}, 0.004f, 0.010f), 0.05f);
    d = join(d, capsule(q, {0.085f, 0.205f, 0.345f}, {0.25f, 0.215f, 0.24f}, 0.050f, 0.040f),
             0.07f);
    // A long, broad bridge that widens to the nose.
    const vec3 narrow(0.62f * p.x, p.y, p.z);
    d = join(d, capsule(narrow, {0, 0.18f, 0.34f}, {0, -0.03f, 0.540f}, 0.078f, 0.072f), 0.07f);
    d = join(d, capsule(q, {0.13f, -0.24f, 0.18f}, {0.09f, -0.30f, 0.34f}, 0.13f, 0.10f), 0.10f);
    return d;
}

/// A ball in its socket, under lids that leave an almond open.
float eyes(float d, vec3 q) {
    constexpr float kBall = 0.080f;
    const vec3 centre(0.162f, 0.112f, 0.318f);
    d = cut(d, ellipsoid(q, centre + vec3(0.0f, 0.005f, 0.085f), {0.100f, 0.070f, 0.080f}), 0.06f);
    // Two arcs through the corners of the eye, extruded towards the viewer.
    constexpr float kHalfLength = 0.080f;
    constexpr float kHalfHeight = 0.038f;
    constexpr float kArc =
        (kHalfLength * kHalfLength + kHalfHeight * kHalfHeight) / (2.0f * kHalfHeight);
    const vec2 slant(0.962f, 0.273f);
    const vec2 off(q.x - centre.x, q.y - centre.y);
    const vec2 in_eye(glm::dot(off, slant), off.y * slant.x - off.x * slant.y);
    const float almond =
        glm::length(vec2(in_eye.x, std::fabs(in_eye.y) + kArc - kHalfHeight)) - kArc;
    const float from_centre = glm::length(q - centre);
    const float lids = cut(from_centre - (kBall + 0.020f), almond, 0.022f);
    d = join(d, lids, 0.035f);
    d = join(d, from_centre - kBall, 0.008f);
    return cut(d, glm::length(q - centre - vec3(-0.004f, 0.010f, kBall + 0.004f)) - 0.021f, 0.008f);
}

float muzzle(float d, vec3 p, vec3 q) {
    d = join(d, ellipsoid(q, {0.095f, -0.135f, 0.475f}, {0.128f, 0.105f, 0.150f}), 0.06f);
    d = join(d, ellipsoid(p, {0, -0.295f, 0.415f}, {0.125f, 0.085f, 0.125f}), 0.045f);
    // The mouth: a line under the pads that turns down at its corner.
    d = cut(d, capsule(q, {0.0f, -0.205f, 0.635f}, {0.105f, -0.238f, 0.575f}, 0.014f, 0.016f),
            0.025f);
    d = cut(d, capsule(q, {0.105f, -0.238f, 0.575f}, {0.215f, -0.225f, 0.40f}, 0.016f, 0.012f),
            0.03f);
    d = cut(d, capsule(p, {0, -0.085f, 0.66f}, {0, -0.20f, 0.645f}, 0.008f, 0.012f), 0.022f);
    // The nose: a broad wedge with nostrils at its sides.
    float nose = ellipsoid(q, {0.040f, -0.035f, 0.600f}, {0.072f, 0.045f, 0.052f});
    nose = join(nose, ellipsoid(p, {0, -0.072f, 0.612f}, {0.042f, 0.038f, 0.040f}), 0.03f);
    nose = cut(nose, ellipsoid(q, {0.064f, -0.062f, 0.640f}, {0.026f, 0.015f, 0.036f}), 0.015f);
    d = join(d, nose, 0.018f);
    return d;
}

float ears(float d, vec3 q) {
    const vec3 local = turn_y(q - vec3(0.345f, 0.455f, 0.185f), 0.40f);
    float ear = ellipsoid(local, vec3(0.0f), {0.128f, 0.140f, 0.085f});
    ear = cut(ear, ellipsoid(local, {0.0f, 0.005f, 0.075f}, {0.086f, 0.098f, 0.085f}), 0.02f);
    return join(d, ear, 0.04f);
}

/// One lock of the mane: a curve of round cones, chased with strands.
struct Lock {
    static constexpr int kPoints = 6;
    std::array<vec3, kPoints> points;
    std::array<float, kPoints> radii;
    vec3 centre;  ///< of a sphere around it
    float radius;
    vec3 side;  ///< two directions across it, from which the strands are counted
    vec3 other;

    void finish() {
        const vec3 along = glm::normalize(points.back() - points.front());
        side = glm::normalize(glm::cross(along, vec3(0.31f, 0.17f, 0.93f)));
        other = glm::cross(along, side);
        centre = 0.5f * (points.front() + points.back());
        radius = 0.0f;
        for (int i = 0; i < kPoints; ++i) {
            const auto k = static_cast<std::size_t>(i);
            radius = std::fmax(radius, glm::length(points[k] - centre) + radii[k]);
        }
    }

    float distance(vec3 p) const {
        float best = 9.0f;
        float angle = 0.0f;
        float thickness = 0.0f;
        for (std::size_t i = 0; i + 1 < kPoints; ++i) {
            const vec3 along = points[i + 1] - points[i];
            const float t = saturate(glm::dot(p - points[i], along) / glm::dot(along, along));
            const vec3 off = p - points[i] - along * t;
            const float r = mix(radii[i], radii[i + 1], t);
            const float d = glm::length(off) - r;
            if (d >= best) continue;
            best = d;
            thickness = r;
            angle = std::atan2(glm::dot(off, side), glm::dot(off, other));
        }
        return best + 0.065f * thickness * std::cos(6.0f * angle);
    }
};

/// Around the face at angle `turn` from the crown (clockwise seen from the front), `layer` rings
/// behind it.
Lock mane_lock(float turn, int layer, Random& random) {
    const float back = static_cast<float>(layer);
    const float side = turn < 0.0f ? -1.0f : 1.0f;
    const vec3 out(std::sin(turn), std::cos(turn), 0.0f);
    const vec3 down = side * vec3(std::cos(turn), -std::sin(turn), 0.0f);
    const float below = smooth_step(1.9f, 3.0f, std::fabs(turn));
    const float length = (0.40f + 0.05f * back + 0.10f * below) * random.range(0.85f, 1.15f);
    const float wave = random.range(0.030f, 0.055f) * (random.next() < 0.5f ? -1.0f : 1.0f);
    const float thick = random.range(0.070f, 0.092f);
    const vec3 start = vec3(0.0f, 0.06f, 0.155f - 0.165f * back - 0.10f * below) +
                       out * (vec3(0.315f, 0.375f, 0.0f) + 0.055f * back);
    Lock lock{};
    for (std::size_t i = 0; i < Lock::kPoints; ++i) {
        const float t = static_cast<float>(i) / (Lock::kPoints - 1);
        const float swing = wave * std::sin(2.0f * kPi * t * 0.9f);
        lock.points[i] = start + out * (length * (0.72f * t - 0.14f * t * t)) +
                         down * (length * 0.62f * t * t + swing) +
                         vec3(0.0f, -0.06f * t * t, 0.09f * std::sin(kPi * t) - 0.07f * t * t);
        lock.radii[i] = thick * (0.72f + 0.45f * std::sin(kPi * std::pow(t, 0.7f))) *
                            (1.0f - std::pow(t, 4.0f)) +
                        0.014f;
    }
    lock.finish();
    return lock;
}

/// Hangs down from height y at angle `turn` around the vertical from the front; `reach` is how far
/// from the axis, at the sides and at the front.
Lock hanging_lock(float turn, vec2 reach, float y, Random& random) {
    const vec3 out(std::sin(turn), 0.0f, std::cos(turn));
    const float length = random.range(0.30f, 0.40f);
    const float wave = random.range(0.025f, 0.05f) * (random.next() < 0.5f ? -1.0f : 1.0f);
    const vec3 side(std::cos(turn), 0.0f, -std::sin(turn));
    Lock lock{};
    for (std::size_t i = 0; i < Lock::kPoints; ++i) {
        const float t = static_cast<float>(i) / (Lock::kPoints - 1);
        lock.points[i] =
            vec3(0.0f, y - length * t, -0.08f) +
            out * (vec3(reach.x, 0.0f, reach.y) + 0.05f * std::sin(kPi * t) - 0.06f * t) +
            side * (wave * std::sin(2.0f * kPi * t * 0.9f));
        lock.radii[i] =
            0.080f * (0.70f + 0.45f * std::sin(kPi * std::pow(t, 0.7f))) * (1.0f - t * t * t) +
            0.012f;
    }
    lock.finish();
    return lock;
}

std::vector<Lock> mane_locks() {
    Random random(1001);
    std::vector<Lock> locks;
    for (int layer = 0; layer < 4; ++layer) {
        const int count = 17 + 2 * layer;
        for (int i = 0; i < count; ++i) {
            const float turn = 2.0f * kPi * (static_cast<float>(i) + 0.5f * (layer % 2)) /
                                   static_cast<float>(count) -
                               kPi + random.range(-0.05f, 0.05f);
            const float ear = std::fabs(std::fabs(turn) - 0.72f);
            if (layer == 0 && ear < 0.22f) continue;
            locks.push_back(mane_lock(turn, layer, random));
        }
    }
    for (int row = 0; row < 3; ++row) {
        const int count = 11 - row;
        for (int i = 0; i < count; ++i) {
            const float turn =
                2.0f * kPi * (static_cast<float>(i) + 0.5f * (row % 2)) / static_cast<float>(count);
            const float reach = 0.36f - 0.03f * static_cast<float>(row);
            locks.push_back(hanging_lock(turn, {1.25f * reach, reach},
                                         -0.30f - 0.16f * static_cast<float>(row), random));
        }
    }
    for (int row = 0; row < 3; ++row) {
        for (int i = 0; i < 7; ++i) {
            const float turn = kPi + 0.36f * (static_cast<float>(i) - 3.0f + 0.5f * (row % 2));
            locks.push_back(hanging_lock(turn, {0.32f + 0.06f * row, 0.50f + 0.02f * row},
                                         0.42f - 0.26f * static_cast<float>(row), random));
        }
    }
    return locks;
}

float head(vec3 p, const std::vector<Lock>& locks) {
    const vec3 q(std::fabs(p.x), p.y, p.z);
    float d = ellipsoid(p, {0, 0.02f, -0.30f}, {0.50f, 0.56f, 0.40f});
    d = join(d, ellipsoid(p, {0, -0.60f, -0.12f}, {0.40f, 0.50f, 0.32f}), 0.12f);
    constexpr float kFillet = 0.045f;
    for (const Lock& lock : locks) {
        // Beyond the fillet a lock changes nothing.
        if (glm::length(p - lock.centre) - 1.1f * lock.radius > d + kFillet) continue;
        d = join(d, lock.distance(p), kFillet);
    }
    float face = skull(p, q);
    face = muzzle(face, p, q);
    face = eyes(face, q);
    d = ears(join(d, face, 0.035f), q);
    return std::fmax(d, -kLionBottom - p.y);
}

/// Around a sphere; copies the vertices of the seam at the back, where u starts again.
void add_uvs(Mesh& mesh) {
    constexpr float kAround = 6.0f;
    constexpr float kUp = 3.0f;
    for (Vertex& vertex : mesh.vertices) {
        const vec3 p = vertex.position + vec3(0.0f, 0.0f, 0.1f);
        vertex.uv = {kAround * (0.5f + std::atan2(p.x, p.z) / (2.0f * kPi)),
                     kUp * (0.5f + std::asin(p.y / glm::length(p)) / kPi)};
    }
    for (Face& face : mesh.faces) {
        float high = 0.0f;
        for (const std::uint32_t corner : face) high = std::fmax(high, mesh.vertices[corner].uv.x);
        for (std::uint32_t& corner : face) {
            if (mesh.vertices[corner].uv.x > high - 0.5f * kAround) continue;
            Vertex copy = mesh.vertices[corner];
            copy.uv.x += kAround;
            corner = static_cast<std::uint32_t>(mesh.vertices.size());
            mesh.vertices.push_back(copy);
        }
    }
}

}  // namespace

Field lion_field() {
    return [locks = mane_locks()](vec3 p) { return head(p, locks); };
}

Mesh lion_head() {
    // The planes are close where the face is.
    constexpr float kFine = 0.0145f;
    constexpr float kCoarse = 0.034f;
    const std::vector<float> x = planes(-1.1f, 1.1f, -0.28f, 0.28f, kFine, kCoarse);
    const std::vector<float> y = planes(-kLionBottom - 0.05f, 1.05f, -0.34f, 0.30f, kFine, kCoarse);
    const std::vector<float> z = planes(-1.0f, 0.75f, 0.30f, 0.75f, kFine, kCoarse);
    Mesh mesh = polygonise(lion_field(), x, y, z);
    add_uvs(mesh);
    return mesh;
}

}  // namespace assets
