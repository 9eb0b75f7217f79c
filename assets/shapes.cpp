#include "assets/shapes.h"

#include <algorithm>
#include <cmath>

#include "assets/noise.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// Quads between nu x nv grid vertices that start at `base`, u fastest.
void connect(Mesh& mesh, std::uint32_t base, int nu, int nv) {
    const auto at = [&](int i, int j) { return base + static_cast<std::uint32_t>(j * nu + i); };
    for (int j = 0; j + 1 < nv; ++j) {
        for (int i = 0; i + 1 < nu; ++i) {
            mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
}

vec2 right_of(vec2 direction) {
    return {direction.y, -direction.x};
}

/// Unit normals at the points of a smooth stroke.
std::vector<vec2> stroke_normals(const Stroke& stroke) {
    std::vector<vec2> normals(stroke.size());
    for (std::size_t i = 0; i < stroke.size(); ++i) {
        vec2 sum(0.0f);
        if (i > 0) sum += glm::normalize(stroke[i] - stroke[i - 1]);
        if (i + 1 < stroke.size()) sum += glm::normalize(stroke[i + 1] - stroke[i]);
        normals[i] = glm::normalize(right_of(sum));
    }
    return normals;
}

/// Faces without the corners that coincide (at a pole).
void drop_degenerate(Mesh& mesh) {
    std::vector<Face> kept;
    for (const Face& face : mesh.faces) {
        std::vector<std::uint32_t> corners;
        for (std::size_t k = 0; k < 4; ++k) {
            const vec3 here = mesh.vertices[face[k]].position;
            const vec3 next = mesh.vertices[face[(k + 1) % 4]].position;
            if (here != next) corners.push_back(face[k]);
        }
        if (corners.size() == 4) {
            kept.push_back(face);
        } else if (corners.size() == 3) {
            kept.push_back({corners[0], corners[1], corners[2], kNoCorner});
        }
    }
    mesh.faces = std::move(kept);
}

}  // namespace

Mesh patch(int nu, int nv, const std::function<vec3(float, float)>& position,
           const std::function<vec2(float, float)>& uv) {
    constexpr float kStep = 1e-3f;
    Mesh mesh;
    for (int j = 0; j <= nv; ++j) {
        for (int i = 0; i <= nu; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(nu);
            const float v = static_cast<float>(j) / static_cast<float>(nv);
            const vec3 du = position(u + kStep, v) - position(u - kStep, v);
            const vec3 dv = position(u, v + kStep) - position(u, v - kStep);
            mesh.vertices.push_back({position(u, v), glm::normalize(glm::cross(du, dv)), uv(u, v)});
        }
    }
    connect(mesh, 0, nu + 1, nv + 1);
    return mesh;
}

Profile sharp(const Stroke& points) {
    Profile profile;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        profile.push_back({points[i], points[i + 1]});
    }
    return profile;
}

Stroke curve(const Stroke& points, int steps) {
    Stroke result{points.front()};
    const auto last = points.size() - 1;
    for (std::size_t i = 0; i < last; ++i) {
        const vec2 a = points[i];
        const vec2 b = points[i + 1];
        const vec2 tangent_a = 0.5f * (b - points[i == 0 ? 0 : i - 1]);
        const vec2 tangent_b = 0.5f * (points[std::min(i + 2, last)] - a);
        for (int step = 1; step <= steps; ++step) {
            const float t = static_cast<float>(step) / static_cast<float>(steps);
            const float s = 1.0f - t;
            result.push_back(step == steps
                                 ? b
                                 : (1.0f + 2.0f * t) * s * s * a + t * s * s * tangent_a +
                                       t * t * (3.0f - 2.0f * t) * b - t * t * s * tangent_b);
        }
    }
    return result;
}

Mesh lathe(const Profile& profile, int segments, float u_repeats, float v_scale) {
    Mesh mesh;
    float along = 0.0f;
    for (const Stroke& stroke : profile) {
        const std::vector<vec2> normals = stroke_normals(stroke);
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::size_t j = 0; j < stroke.size(); ++j) {
            if (j > 0) along += glm::length(stroke[j] - stroke[j - 1]);
            for (int i = 0; i <= segments; ++i) {
                // The seam's last column repeats the first one's angle, so that it closes exactly.
                const float angle =
                    2.0f * kPi * static_cast<float>(i % segments) / static_cast<float>(segments);
                const vec3 out(std::sin(angle), 0.0f, std::cos(angle));
                const float u = static_cast<float>(i) / static_cast<float>(segments);
                mesh.vertices.push_back({out * stroke[j].x + vec3(0.0f, stroke[j].y, 0.0f),
                                         out * normals[j].x + vec3(0.0f, normals[j].y, 0.0f),
                                         {u * u_repeats, along * v_scale}});
            }
        }
        connect(mesh, base, segments + 1, static_cast<int>(stroke.size()));
    }
    drop_degenerate(mesh);
    return mesh;
}

Mesh extrude(const Profile& profile, std::span<const vec3> path, float uv_scale) {
    const bool closed = path.front() == path.back();
    const std::size_t edges = path.size() - 1;
    const auto outward = [&](std::size_t edge) {
        return glm::normalize(glm::cross(path[edge + 1] - path[edge], vec3(0.0f, 1.0f, 0.0f)));
    };
    // Moving outward by the profile's x along the mitre of two edges.
    const auto mitre = [&](std::size_t before, std::size_t after) {
        const vec3 sum = outward(before) + outward(after);
        return sum * (2.0f / glm::dot(sum, sum));
    };
    Mesh mesh;
    float from = 0.0f;
    for (std::size_t edge = 0; edge < edges; ++edge) {
        const bool first = edge == 0 && !closed;
        const bool last = edge + 1 == edges && !closed;
        const std::array<vec3, 2> out{
            first ? outward(edge) : mitre((edge + edges - 1) % edges, edge),
            last ? outward(edge) : mitre(edge, (edge + 1) % edges)};
        const vec3 direction = glm::normalize(path[edge + 1] - path[edge]);
        float along = 0.0f;
        for (const Stroke& stroke : profile) {
            const std::vector<vec2> normals = stroke_normals(stroke);
            const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
            for (std::size_t j = 0; j < stroke.size(); ++j) {
                if (j > 0) along += glm::length(stroke[j] - stroke[j - 1]);
                for (std::size_t end = 0; end < 2; ++end) {
                    const vec3 point =
                        path[edge + end] + out[end] * stroke[j].x + vec3(0.0f, stroke[j].y, 0.0f);
                    const vec3 normal =
                        outward(edge) * normals[j].x + vec3(0.0f, normals[j].y, 0.0f);
                    const float u = from + glm::dot(point - path[edge], direction);
                    mesh.vertices.push_back({point, normal, vec2(u, along) * uv_scale});
                }
            }
            connect(mesh, base, 2, static_cast<int>(stroke.size()));
        }
        from += glm::length(path[edge + 1] - path[edge]);
    }
    drop_degenerate(mesh);
    return mesh;
}

Mesh tube(std::span<const vec3> path, float radius_from, float radius_to, int sides,
          float uv_scale) {
    Mesh mesh;
    float along = 0.0f;
    vec3 side(0.0f);
    for (std::size_t i = 0; i < path.size(); ++i) {
        const vec3 before = path[i == 0 ? 0 : i - 1];
        const vec3 direction = glm::normalize(path[std::min(i + 1, path.size() - 1)] - before);
        if (i == 0) {
            side = std::abs(direction.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
        } else {
            along += glm::length(path[i] - before);
        }
        side = glm::normalize(side - direction * glm::dot(side, direction));
        const vec3 other = glm::cross(direction, side);
        const float t = static_cast<float>(i) / static_cast<float>(path.size() - 1);
        const float radius = mix(radius_from, radius_to, t);
        for (int k = 0; k <= sides; ++k) {
            const float angle =
                2.0f * kPi * static_cast<float>(k % sides) / static_cast<float>(sides);
            const vec3 out = side * std::cos(angle) + other * std::sin(angle);
            const float u = static_cast<float>(k) / static_cast<float>(sides);
            mesh.vertices.push_back({path[i] + out * radius, out, {u, along * uv_scale}});
        }
    }
    connect(mesh, 0, sides + 1, static_cast<int>(path.size()));
    drop_degenerate(mesh);
    return mesh;
}

Mesh floor(vec2 low, vec2 high, float y, float uv_scale, bool facing_down) {
    const vec2 size = high - low;
    const int nx = std::max(1, static_cast<int>(size.x));
    const int nz = std::max(1, static_cast<int>(size.y));
    const auto position = [&](float s, float t) {
        return facing_down ? vec3(low.x + s * size.x, y, low.y + t * size.y)
                           : vec3(low.x + s * size.x, y, high.y - t * size.y);
    };
    return patch(nx, nz, position, [&](float s, float t) {
        const vec3 p = position(s, t);
        return vec2(p.x, facing_down ? p.z : -p.z) * uv_scale;
    });
}

Mesh wall(vec3 from, vec3 to, float uv_scale) {
    const vec3 flat(to.x - from.x, 0.0f, to.z - from.z);
    const float length = glm::length(flat);
    const float height = to.y - from.y;
    return patch(
        std::max(1, static_cast<int>(length)), std::max(1, static_cast<int>(height)),
        [&](float s, float t) { return from + flat * s + vec3(0.0f, height * t, 0.0f); },
        [&](float s, float t) { return vec2(s * length, from.y + t * height) * uv_scale; });
}

}  // namespace assets
