#include "cw2-bake/tangent_directions.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>

namespace bake {
namespace {

using glm::vec2;
using glm::vec3;

constexpr std::size_t kFacesPerBlock = 4096;

bool not_zero(float x) {
    return std::abs(x) > FLT_MIN;
}

FaceDirections make_face(const TangentInput& mesh, const std::uint32_t* corners) {
    const vec3& p0 = mesh.positions[corners[0]];
    const vec3& p1 = mesh.positions[corners[1]];
    const vec3& p2 = mesh.positions[corners[2]];
    const vec2 uv1 = mesh.uvs[corners[1]] - mesh.uvs[corners[0]];
    const vec2 uv2 = mesh.uvs[corners[2]] - mesh.uvs[corners[0]];
    const vec3 edge1 = p1 - p0;
    const vec3 edge2 = p2 - p0;
    const float area = uv1.x * uv2.y - uv1.y * uv2.x;

    FaceDirections face{};
    face.s = uv2.y * edge1 - uv1.y * edge2;
    face.t = -uv2.x * edge1 + uv1.x * edge2;
    face.preserving = area > 0.0f;
    face.degenerate = p0 == p1 || p0 == p2 || p1 == p2;
    if (not_zero(area)) {
        const float sign = face.preserving ? 1.0f : -1.0f;
        const float length_s = std::sqrt(glm::dot(face.s, face.s));
        const float length_t = std::sqrt(glm::dot(face.t, face.t));
        if (not_zero(length_s)) face.s = (sign / length_s) * face.s;
        if (not_zero(length_t)) face.t = (sign / length_t) * face.t;
        face.usable = not_zero(length_s / std::abs(area)) && not_zero(length_t / std::abs(area));
    }
    return face;
}

/// (asin(sqrt(z)) / sqrt(z) - 1) / z for z in [0, 1/4], highest power first; Chebyshev fit, off by
/// less than 1e-12.
constexpr double kArcSine[] = {0.028346745231833329, 0.0010675063150363118, 0.01686409027396012,
                               0.016902683886393575, 0.022412417726695433,  0.030379945210024933,
                               0.044642906474584963, 0.074999999534297119,  0.16666666666738632};

/// acos of x in [-1, 1], rounded to float from an error below 1e-12. Inline, it takes a third of
/// the library's time.
float arc_cosine(float x) {
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
void flatten(Lanes& v, const Lanes& n) {
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

struct SpokeBatch {
    Lanes normal;
    Lanes s;
    Lanes t;
    Lanes to_previous;
    Lanes to_next;
    float angle[kLanes];

    void compute() {
        flatten(s, normal);
        flatten(t, normal);
        flatten(to_previous, normal);
        flatten(to_next, normal);
        for (std::size_t i = 0; i < kLanes; ++i) {
            const float cosine = to_previous.x[i] * to_next.x[i] + to_previous.y[i] * to_next.y[i] +
                                 to_previous.z[i] * to_next.z[i];
            angle[i] = arc_cosine(cosine > 1.0f ? 1.0f : cosine < -1.0f ? -1.0f : cosine);
        }
    }
};

}  // namespace

vec3 unit_or_zero(const vec3& v) {
    const float squared = glm::dot(v, v);
    return squared > 0.0f ? (1.0f / std::sqrt(squared)) * v : v;
}

std::vector<FaceDirections> make_face_directions(const TangentInput& mesh) {
    std::vector<FaceDirections> faces(mesh.indices.size() / 3);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), kFacesPerBlock),
                      [&](const auto& block) {
                          for (std::size_t f = block.begin(); f < block.end(); ++f)
                              faces[f] = make_face(mesh, &mesh.indices[3 * f]);
                      });
    return faces;
}

void make_spokes(const TangentInput& mesh, const std::vector<FaceDirections>& faces,
                 std::span<const std::uint32_t> corners, Spoke* spokes) {
    SpokeBatch batch{};
    for (std::size_t begin = 0; begin < corners.size(); begin += kLanes) {
        const std::size_t count = std::min(kLanes, corners.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t corner = corners[begin + i];
            const std::uint32_t vertex = mesh.indices[corner];
            const vec3& here = mesh.positions[vertex];
            batch.normal.set(i, mesh.normals[vertex]);
            batch.s.set(i, faces[corner / 3].s);
            batch.t.set(i, faces[corner / 3].t);
            batch.to_previous.set(i, mesh.positions[mesh.indices[previous_corner(corner)]] - here);
            batch.to_next.set(i, mesh.positions[mesh.indices[next_corner(corner)]] - here);
        }
        batch.compute();
        for (std::size_t i = 0; i < count; ++i) {
            const FaceDirections& face = faces[corners[begin + i] / 3];
            spokes[begin + i] = {batch.s.get(i), batch.t.get(i), batch.angle[i], face.preserving,
                                 face.usable};
        }
    }
}

}  // namespace bake
