#include "cw2-bake/geometry/tangent_directions.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <iterator>
#include <numbers>

#include "common/every_cpu.h"

namespace bake {
namespace {

using glm::vec2;
using glm::vec3;

/// (asin(sqrt(z)) / sqrt(z) - 1) / z for z in [0, 1/4], highest power first; Chebyshev fit, off by
/// less than 1e-12.
constexpr double kArcSine[] = {0.028346745231833329, 0.0010675063150363118, 0.01686409027396012,
                               0.016902683886393575, 0.022412417726695433,  0.030379945210024933,
                               0.044642906474584963, 0.074999999534297119,  0.16666666666738632};

/// acos of x in [-1, 1], rounded to float from an error below 1e-12. Inline, it takes a third of
/// the library's time.
CW2_INLINE float arc_cosine(float x) {
    constexpr double kPi = std::numbers::pi;
    const double size = std::abs(static_cast<double>(x));
    const bool outer = size > 0.5;  // acos(x) = 2 asin(sqrt((1 - x) / 2)), else pi/2 - asin(x)
    const double z = outer ? 0.5 - 0.5 * size : size * size;
    double series = kArcSine[0];
    for (std::size_t i = 1; i < std::size(kArcSine); ++i) series = series * z + kArcSine[i];
    const double root = outer ? std::sqrt(z) : size;
    const double arc = root + root * z * series;
    const double of_size = outer ? 2.0 * arc : kPi / 2 - arc;
    return static_cast<float>(x < 0.0f ? kPi - of_size : of_size);
}

/// Projects v onto the plane of the normal n, and normalises what has a length.
CW2_INLINE void flatten(const Lanes& v, const Lanes& n, Lanes& result) {
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float height = n.x[i] * v.x[i] + n.y[i] * v.y[i] + n.z[i] * v.z[i];
        const float x = v.x[i] - height * n.x[i];
        const float y = v.y[i] - height * n.y[i];
        const float z = v.z[i] - height * n.z[i];
        const float squared = x * x + y * y + z * z;
        const float scale = 1.0f / std::sqrt(squared > 0.0f ? squared : 1.0f);
        result.x[i] = x * scale;
        result.y[i] = y * scale;
        result.z[i] = z * scale;
    }
}

/// Points as they are copied the fastest.
struct PointLanes {
    vec2 xy[kLanes];
    float z[kLanes];

    void set(std::size_t i, const vec3& v) {
        xy[i] = vec2(v);
        z[i] = v.z;
    }
};

/// The directions of growing u and v, by face.
struct FaceLanes {
    PointLanes position[3];
    vec2 uv[3][kLanes];
    Lanes s, t;                        ///< in unit length, as far as the UVs allow
    std::uint32_t preserving[kLanes];  ///< 1 or 0
    std::uint32_t usable[kLanes];      ///< 1 or 0

    void set(std::size_t i, std::size_t k, const SourceScene& scene, const Corner& corner) {
        position[k].set(i, scene.positions[corner.position]);
        uv[k][i] = scene.uvs[corner.uv];
    }

    CW2_INLINE void compute() {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const float u1 = uv[1][i].x - uv[0][i].x, v1 = uv[1][i].y - uv[0][i].y;
            const float u2 = uv[2][i].x - uv[0][i].x, v2 = uv[2][i].y - uv[0][i].y;
            const float x1 = position[1].xy[i].x - position[0].xy[i].x;
            const float y1 = position[1].xy[i].y - position[0].xy[i].y;
            const float z1 = position[1].z[i] - position[0].z[i];
            const float x2 = position[2].xy[i].x - position[0].xy[i].x;
            const float y2 = position[2].xy[i].y - position[0].xy[i].y;
            const float z2 = position[2].z[i] - position[0].z[i];
            const float area = u1 * v2 - v1 * u2;
            const float size = std::abs(area);
            const float sign = area > 0.0f ? 1.0f : -1.0f;
            const float sx = v2 * x1 - v1 * x2;
            const float sy = v2 * y1 - v1 * y2;
            const float sz = v2 * z1 - v1 * z2;
            const float tx = -u2 * x1 + u1 * x2;
            const float ty = -u2 * y1 + u1 * y2;
            const float tz = -u2 * z1 + u1 * z2;
            const float length_s = std::sqrt(sx * sx + sy * sy + sz * sz);
            const float length_t = std::sqrt(tx * tx + ty * ty + tz * tz);
            const bool has_area = size > FLT_MIN;
            const float scale_s = has_area && length_s > FLT_MIN ? sign / length_s : 1.0f;
            const float scale_t = has_area && length_t > FLT_MIN ? sign / length_t : 1.0f;
            s.x[i] = scale_s * sx;
            s.y[i] = scale_s * sy;
            s.z[i] = scale_s * sz;
            t.x[i] = scale_t * tx;
            t.y[i] = scale_t * ty;
            t.z[i] = scale_t * tz;
            // length / size > FLT_MIN, without divisions, which this loop has too many of.
            constexpr float kUp = 0x1p64f, kDown = 0x1p-62f;
            const bool spans =
                has_area && length_s * kUp > size * kDown && length_t * kUp > size * kDown;
            usable[i] = spans ? 1 : 0;
            preserving[i] = area > 0.0f ? 1 : 0;
        }
    }
};

/// The spokes of faces, at corners with these normals and edges, which it flattens.
CW2_INLINE void make_spokes(const FaceLanes& face, const Lanes& normal, Lanes& to_previous,
                            Lanes& to_next, SpokeLanes& spokes) {
    flatten(face.s, normal, spokes.s);
    flatten(face.t, normal, spokes.t);
    flatten(to_previous, normal, to_previous);
    flatten(to_next, normal, to_next);
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float cosine = to_previous.x[i] * to_next.x[i] + to_previous.y[i] * to_next.y[i] +
                             to_previous.z[i] * to_next.z[i];
        const float angle = arc_cosine(cosine > 1.0f ? 1.0f : cosine < -1.0f ? -1.0f : cosine);
        spokes.weighted_s.x[i] = angle * spokes.s.x[i];
        spokes.weighted_s.y[i] = angle * spokes.s.y[i];
        spokes.weighted_s.z[i] = angle * spokes.s.z[i];
        spokes.preserving[i] = face.preserving[i];
        spokes.usable[i] = face.usable[i];
    }
}

/// What the spokes of whole faces are made of.
struct FaceBatch {
    FaceLanes face;
    Lanes normal[3];

    /// Returns whether the face is degenerate.
    bool load(std::size_t i, const SourceScene& scene, const FramedTriangles& triangles,
              std::size_t index) {
        std::uint32_t at[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const Corner& corner = triangles.vertices[triangles.indices[3 * index + k]].corner;
            at[k] = corner.position;
            face.set(i, k, scene, corner);
            normal[k].set(i, scene.normals[corner.normal]);
        }
        // Not ||: no processor foresees such faces.
        return (at[0] == at[1]) | (at[1] == at[2]) | (at[2] == at[0]);
    }

    CW2_INLINE void compute_at(std::size_t corner, SpokeLanes& spokes) const {
        const PointLanes& here = face.position[corner];
        const PointLanes& next = face.position[(corner + 1) % 3];
        const PointLanes& previous = face.position[(corner + 2) % 3];
        Lanes to_previous, to_next;
        for (std::size_t i = 0; i < kLanes; ++i) {
            to_previous.x[i] = previous.xy[i].x - here.xy[i].x;
            to_previous.y[i] = previous.xy[i].y - here.xy[i].y;
            to_previous.z[i] = previous.z[i] - here.z[i];
            to_next.x[i] = next.xy[i].x - here.xy[i].x;
            to_next.y[i] = next.xy[i].y - here.xy[i].y;
            to_next.z[i] = next.z[i] - here.z[i];
        }
        make_spokes(face, normal[corner], to_previous, to_next, spokes);
    }
};

CW2_EVERY_CPU void compute(FaceBatch& batch, SpokeLanes* at_corner) {
    batch.face.compute();
    for (std::size_t k = 0; k < 3; ++k) batch.compute_at(k, at_corner[k]);
}

/// What spokes are made of.
struct CornerLanes {
    FaceLanes face;
    std::uint32_t corner[kLanes];  ///< 0, 1 or 2: of the face's
    Lanes normal;
    Lanes to_previous;
    Lanes to_next;

    void load(std::size_t i, const SourceScene& scene, const FramedTriangles& triangles,
              const Slot& slot) {
        for (std::size_t k = 0; k < 3; ++k)
            face.set(i, k, scene,
                     triangles.vertices[triangles.indices[3 * std::size_t{slot.face} + k]].corner);
        corner[i] = slot.corner - 3 * slot.face;
        normal.set(i, scene.normals[triangles.vertices[slot.own].corner.normal]);
    }

    CW2_INLINE void compute_edges() {
        const PointLanes* p = face.position;
        const auto edges = [&](std::size_t i, float p0, float p1, float p2, float& previous,
                               float& next) __attribute__((always_inline)) {
            const bool is_0 = corner[i] == 0;
            const bool is_1 = corner[i] == 1;
            const float here = is_0 ? p0 : is_1 ? p1 : p2;
            previous = (is_0 ? p2 : is_1 ? p0 : p1) - here;
            next = (is_0 ? p1 : is_1 ? p2 : p0) - here;
        };
        for (std::size_t i = 0; i < kLanes; ++i) {
            edges(i, p[0].xy[i].x, p[1].xy[i].x, p[2].xy[i].x, to_previous.x[i], to_next.x[i]);
            edges(i, p[0].xy[i].y, p[1].xy[i].y, p[2].xy[i].y, to_previous.y[i], to_next.y[i]);
            edges(i, p[0].z[i], p[1].z[i], p[2].z[i], to_previous.z[i], to_next.z[i]);
        }
    }

    CW2_INLINE void compute(SpokeLanes& spokes) {
        face.compute();
        compute_edges();
        make_spokes(face, normal, to_previous, to_next, spokes);
    }
};

CW2_EVERY_CPU void compute(CornerLanes& corners, SpokeLanes& spokes) {
    corners.compute(spokes);
}

}  // namespace

void FaceSpokes::make(const SourceScene& scene, const FramedTriangles& triangles,
                      std::size_t first_face, std::size_t count) {
    FaceBatch batch;
    if (count < kLanes) batch = {};
    for (std::size_t i = 0; i < count; ++i)
        degenerate_[i] = batch.load(i, scene, triangles, first_face + i);
    compute(batch, at_corner_);
}

void Spokes::make(const SourceScene& scene, const FramedTriangles& triangles,
                  std::span<const Slot> slots) {
    lanes_.resize((slots.size() + kLanes - 1) / kLanes);
    CornerLanes batch{};
    for (std::size_t begin = 0; begin < slots.size(); begin += kLanes) {
        const std::size_t count = std::min(kLanes, slots.size() - begin);
        for (std::size_t i = 0; i < count; ++i) batch.load(i, scene, triangles, slots[begin + i]);
        compute(batch, lanes_[begin / kLanes]);
    }
}

}  // namespace bake
