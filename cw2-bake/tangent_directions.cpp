#include "cw2-bake/tangent_directions.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>

#include "mesh-format/every_cpu.h"

namespace bake {
namespace {

using glm::vec2;
using glm::vec3;

constexpr std::size_t kFacesPerBlock = 8192;

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

/// Spokes are made kLanes at a time, in loops that compilers turn into vector instructions.
constexpr std::size_t kLanes = 16;

struct Lanes {
    float x[kLanes];
    float y[kLanes];
    float z[kLanes];

    void set(std::size_t i, const vec3& v) {
        x[i] = v.x;
        y[i] = v.y;
        z[i] = v.z;
    }
    vec3 get(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Projects v onto the plane of the normal n, and normalises what has a length.
CW2_INLINE void flatten(Lanes& v, const Lanes& n) {
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float height = n.x[i] * v.x[i] + n.y[i] * v.y[i] + n.z[i] * v.z[i];
        const float x = v.x[i] - height * n.x[i];
        const float y = v.y[i] - height * n.y[i];
        const float z = v.z[i] - height * n.z[i];
        const float squared = x * x + y * y + z * z;
        const float scale = 1.0f / std::sqrt(squared > 0.0f ? squared : 1.0f);
        v.x[i] = x * scale;
        v.y[i] = y * scale;
        v.z[i] = z * scale;
    }
}

/// The directions of growing u and v, by face.
struct FaceLanes {
    Lanes edge1, edge2;  ///< from corner 0 to corners 1 and 2
    float u1[kLanes], v1[kLanes], u2[kLanes], v2[kLanes];
    Lanes s, t;  ///< in unit length, as far as the UVs allow
    float area[kLanes];
    float usable[kLanes];  ///< 1 or 0

    void load(std::size_t i, const SourceScene& scene, const Corner* face) {
        const vec3& p0 = scene.positions[face[0].position];
        edge1.set(i, scene.positions[face[1].position] - p0);
        edge2.set(i, scene.positions[face[2].position] - p0);
        const vec2& uv0 = scene.uvs[face[0].uv];
        const vec2 uv1 = scene.uvs[face[1].uv] - uv0;
        const vec2 uv2 = scene.uvs[face[2].uv] - uv0;
        u1[i] = uv1.x;
        v1[i] = uv1.y;
        u2[i] = uv2.x;
        v2[i] = uv2.y;
    }

    CW2_INLINE void compute() {
        for (std::size_t i = 0; i < kLanes; ++i) {
            area[i] = u1[i] * v2[i] - v1[i] * u2[i];
            const float size = std::abs(area[i]);
            const float sign = area[i] > 0.0f ? 1.0f : -1.0f;
            const float sx = v2[i] * edge1.x[i] - v1[i] * edge2.x[i];
            const float sy = v2[i] * edge1.y[i] - v1[i] * edge2.y[i];
            const float sz = v2[i] * edge1.z[i] - v1[i] * edge2.z[i];
            const float tx = -u2[i] * edge1.x[i] + u1[i] * edge2.x[i];
            const float ty = -u2[i] * edge1.y[i] + u1[i] * edge2.y[i];
            const float tz = -u2[i] * edge1.z[i] + u1[i] * edge2.z[i];
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
            const bool spans = has_area && length_s / size > FLT_MIN && length_t / size > FLT_MIN;
            usable[i] = spans ? 1.0f : 0.0f;
        }
    }
};

struct SpokeBatch {
    FaceLanes face;
    Lanes normal;
    Lanes to_previous;
    Lanes to_next;
    float angle[kLanes];

    void load(std::size_t i, const SourceScene& scene, std::uint32_t corner) {
        const Corner* corners = &scene.corners[corner - corner % 3];
        face.load(i, scene, corners);
        const std::uint32_t k = corner % 3;
        const vec3& here = scene.positions[corners[k].position];
        normal.set(i, scene.normals[corners[k].normal]);
        to_previous.set(i, scene.positions[corners[k == 0 ? 2 : k - 1].position] - here);
        to_next.set(i, scene.positions[corners[k == 2 ? 0 : k + 1].position] - here);
    }

    CW2_INLINE void compute() {
        face.compute();
        flatten(face.s, normal);
        flatten(face.t, normal);
        flatten(to_previous, normal);
        flatten(to_next, normal);
        for (std::size_t i = 0; i < kLanes; ++i) {
            const float cosine = to_previous.x[i] * to_next.x[i] + to_previous.y[i] * to_next.y[i] +
                                 to_previous.z[i] * to_next.z[i];
            angle[i] = arc_cosine(cosine > 1.0f ? 1.0f : cosine < -1.0f ? -1.0f : cosine);
        }
    }
};

CW2_EVERY_CPU void compute(FaceLanes& faces) {
    faces.compute();
}

CW2_EVERY_CPU void compute(SpokeBatch& spokes) {
    spokes.compute();
}

}  // namespace

vec3 unit_or_zero(const vec3& v) {
    const float squared = glm::dot(v, v);
    return squared > 0.0f ? (1.0f / std::sqrt(squared)) * v : v;
}

void make_spokes(const SourceScene& scene, std::span<const std::uint32_t> corners, Spoke* spokes) {
    SpokeBatch batch{};
    for (std::size_t begin = 0; begin < corners.size(); begin += kLanes) {
        const std::size_t count = std::min(kLanes, corners.size() - begin);
        for (std::size_t i = 0; i < count; ++i) batch.load(i, scene, corners[begin + i]);
        compute(batch);
        for (std::size_t i = 0; i < count; ++i) {
            spokes[begin + i] = {batch.face.s.get(i), batch.face.t.get(i), batch.angle[i],
                                 batch.face.area[i] > 0.0f, batch.face.usable[i] > 0.0f};
        }
    }
}

std::vector<std::uint32_t> find_unusable_faces(const SourceScene& scene) {
    const std::size_t face_count = scene.corners.size() / 3;
    std::vector<std::vector<std::uint32_t>> found(face_count / kFacesPerBlock + 1);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t block) {
        const std::size_t end = std::min(face_count, (block + 1) * kFacesPerBlock);
        FaceLanes lanes{};
        for (std::size_t begin = block * kFacesPerBlock; begin < end; begin += kLanes) {
            const std::size_t count = std::min(kLanes, end - begin);
            for (std::size_t i = 0; i < count; ++i)
                lanes.load(i, scene, &scene.corners[3 * (begin + i)]);
            compute(lanes);
            for (std::size_t i = 0; i < count; ++i)
                if (lanes.usable[i] == 0.0f)
                    found[block].push_back(static_cast<std::uint32_t>(begin + i));
        }
    });
    std::vector<std::uint32_t> faces;
    for (const auto& part : found) faces.insert(faces.end(), part.begin(), part.end());
    return faces;
}

}  // namespace bake
