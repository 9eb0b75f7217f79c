// Meshes that reach every rule of MikkTSpace. Their numbers are the same on every machine: the
// generator is std::mt19937 without a library distribution, sines are rounded from double.
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "tests/oracle/corner_mesh.h"

namespace oracle {
namespace {

using glm::vec2;
using glm::vec3;

struct Vertex {
    vec3 position;
    vec3 normal;
    vec2 uv;
};

class Random {
 public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}

    std::uint32_t below(std::uint32_t bound) { return engine_() % bound; }
    float real(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) / 16'777'216.0f;
    }
    vec3 vector() { return {real(-1, 1), real(-1, 1), real(-1, 1)}; }
    vec3 direction() {
        for (;;) {
            const vec3 v = vector();
            const float squared = glm::dot(v, v);
            if (squared > 0.01f && squared <= 1.0f) return v / std::sqrt(squared);
        }
    }

 private:
    std::mt19937 engine_;
};

float sine(double turns) {
    return static_cast<float>(std::sin(2.0 * std::numbers::pi * turns));
}
float cosine(double turns) {
    return static_cast<float>(std::cos(2.0 * std::numbers::pi * turns));
}

void add(CornerMesh& mesh, const Vertex& a, const Vertex& b, const Vertex& c) {
    for (const Vertex* v : {&a, &b, &c}) {
        mesh.positions.push_back(v->position);
        mesh.normals.push_back(v->normal);
        mesh.uvs.push_back(v->uv);
    }
}

/// columns x rows quads over vertex(i, j), 0 <= i <= columns, 0 <= j <= rows.
template <typename MakeVertex>
CornerMesh sheet(const char* name, int columns, int rows, MakeVertex&& vertex) {
    CornerMesh mesh{.name = name, .positions = {}, .normals = {}, .uvs = {}};
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            add(mesh, vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
            add(mesh, vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
        }
    }
    return mesh;
}

/// A point of gentle hills, UVs those of its place in the plane.
Vertex hill(int i, int j) {
    const float slope_x = 0.4f * cosine(i / 9.0);
    const float slope_y = 0.3f * cosine(j / 7.0);
    return {vec3(i, j, 0.5f * sine(i / 9.0) + 0.3f * sine(j / 7.0)),
            glm::normalize(vec3(-slope_x, -slope_y, 1.0f)), vec2(i, j) * 0.125f};
}

CornerMesh mirrored_halves() {
    return sheet("mirrored halves", 16, 6, [](int i, int j) {
        Vertex v = hill(i, j);
        v.uv.x = std::abs(v.uv.x - 1.0f);
        return v;
    });
}

CornerMesh sphere(const char* name, int columns, int rows, bool one_pole) {
    return sheet(name, columns, rows, [=](int i, int j) {
        const float ring = sine(0.5 * j / rows);
        vec3 p(ring * cosine(double(i % columns) / columns),
               ring * sine(double(i % columns) / columns), -cosine(0.5 * j / rows));
        const bool pole = j == 0 || j == rows;
        if (pole) p = vec3(0.0f, 0.0f, j == 0 ? -1.0f : 1.0f);
        return Vertex{p, p, vec2(pole && one_pole ? 0.5f : float(i) / columns, float(j) / rows)};
    });
}

/// A fan of `count` faces about one vertex. Polar UVs have the hub's at one point, so that the
/// faces' directions of u point all the way round. Every second rim vertex is late by `late` steps.
CornerMesh fan(const char* name, int count, float height, bool polar, double late = 0.0) {
    CornerMesh mesh{.name = name, .positions = {}, .normals = {}, .uvs = {}};
    const vec3 up(0.0f, 0.0f, 1.0f);
    const Vertex hub{vec3(0.0f, 0.0f, height), up, polar ? vec2(0.5f, 1.0f) : vec2(0.0f)};
    const auto rim = [&](int i) {
        const double turns = (i % count + (i % 2 == 0 ? 0.0 : late)) / count;
        const vec3 p(cosine(turns), sine(turns), 0.0f);
        return Vertex{p, height == 0.0f ? up : glm::normalize(p + up),
                      polar ? vec2(float(i) / count, 0.0f) : vec2(p)};
    };
    for (int i = 0; i < count; ++i) add(mesh, rim(i), rim(i + 1), hub);
    return mesh;
}

CornerMesh torus(int columns, int rows) {
    return sheet("torus", columns, rows, [=](int i, int j) {
        const double around = double(i % columns) / columns;
        const double about = double(j % rows) / rows;
        const vec3 n(cosine(around) * cosine(about), sine(around) * cosine(about), sine(about));
        return Vertex{vec3(3.0f * cosine(around), 3.0f * sine(around), 0.0f) + n, n,
                      vec2(4.0f * i / columns, 2.0f * j / rows)};
    });
}

/// Rows of constant u, columns of constant v, and one whole corner at one point of the UVs.
CornerMesh collapsed_uvs() {
    return sheet("collapsed UVs", 16, 12, [](int i, int j) {
        Vertex v = hill(i, j);
        if (j % 5 < 2) v.uv.x = 0.25f;
        if (i % 7 < 2) v.uv.y = 0.5f;
        if (i > 12 && j > 9) v.uv = vec2(0.75f);
        return v;
    });
}

/// Every corner one of `count` vertices at random: edges with many faces, either winding, collapsed
/// UVs and corners that coincide, all at once.
CornerMesh pool(const char* name, std::uint32_t seed, int triangles, std::uint32_t count,
                std::uint32_t uv_steps) {
    Random random(seed);
    std::vector<Vertex> vertices;
    for (std::uint32_t i = 0; i < count; ++i)
        vertices.push_back({random.vector(), random.direction(),
                            vec2(random.below(uv_steps), random.below(uv_steps)) * 0.25f});
    CornerMesh mesh{.name = name, .positions = {}, .normals = {}, .uvs = {}};
    for (int i = 0; i < triangles; ++i)
        add(mesh, vertices[random.below(count)], vertices[random.below(count)],
            vertices[random.below(count)]);
    return mesh;
}

/// Triangles between near points of a lattice, whose points are moved by up to `bend`; some corners
/// take UVs of their own.
CornerMesh lattice(const char* name, std::uint32_t seed, int triangles, std::uint32_t size,
                   float bend) {
    Random random(seed);
    CornerMesh mesh{.name = name, .positions = {}, .normals = {}, .uvs = {}};
    for (int i = 0; i < triangles; ++i) {
        const glm::uvec3 cell(random.below(size), random.below(size), random.below(size));
        Vertex corner[3];
        for (Vertex& v : corner) {
            const vec3 p = vec3(cell) + vec3(random.below(2), random.below(2), random.below(2));
            const vec2 shift = random.below(8) == 0 ? vec2(0.5f) : vec2(0.0f);
            const vec3 moved = bend * vec3(sine(0.37 * p.x + 0.11 * p.y + 0.23 * p.z),
                                           sine(0.17 * p.x + 0.31 * p.y + 0.43 * p.z),
                                           sine(0.29 * p.x + 0.19 * p.y + 0.13 * p.z));
            v = {p + moved, glm::normalize(p + vec3(0.25f)),
                 vec2(p.x + 0.5f * p.z, p.y) * 0.5f + shift};
        }
        add(mesh, corner[0], corner[1], corner[2]);
    }
    return mesh;
}

CornerMesh unconnected(const char* name, std::uint32_t seed, int triangles) {
    Random random(seed);
    CornerMesh mesh{.name = name, .positions = {}, .normals = {}, .uvs = {}};
    const auto vertex = [&] {
        return Vertex{random.vector(), random.direction(),
                      vec2(random.real(-2, 2), random.real(-2, 2))};
    };
    for (int i = 0; i < triangles; ++i) {
        const Vertex a = vertex();
        const Vertex b = vertex();
        add(mesh, a, b, vertex());
    }
    return mesh;
}

/// Pages about one edge, some bound the other way round: more than two faces on an edge.
CornerMesh book() {
    CornerMesh mesh{.name = "book", .positions = {}, .normals = {}, .uvs = {}};
    const vec3 out = glm::normalize(vec3(1.0f, 1.0f, 3.0f));
    const Vertex foot{vec3(0.0f, 0.0f, 0.0f), out, vec2(0.0f, 0.0f)};
    const Vertex head{vec3(0.0f, 0.0f, 1.0f), out, vec2(0.0f, 1.0f)};
    for (int i = 0; i < 21; ++i) {
        const vec3 p(cosine(i / 33.0), sine(i / 33.0), 0.1f * (i % 4));
        const Vertex page{p, out, vec2(i % 5 == 4 ? -1.0f : 1.0f, 0.1f * i)};
        if (i % 3 == 2)
            add(mesh, head, foot, page);
        else
            add(mesh, foot, head, page);
    }
    return mesh;
}

CornerMesh changed(CornerMesh mesh, const char* name, auto&& change_corner) {
    mesh.name = name;
    for (std::size_t c = 0; c < mesh.positions.size(); ++c)
        change_corner(c, mesh.positions[c], mesh.normals[c], mesh.uvs[c]);
    return mesh;
}

CornerMesh random_windings() {
    CornerMesh mesh = sheet("random windings", 12, 8, hill);
    Random random(5);
    for (std::size_t c = 0; c < mesh.positions.size(); c += 3) {
        if (random.below(3) != 0) continue;
        std::swap(mesh.positions[c], mesh.positions[c + 1]);
        std::swap(mesh.normals[c], mesh.normals[c + 1]);
        std::swap(mesh.uvs[c], mesh.uvs[c + 1]);
    }
    return mesh;
}

/// Neighbours at one position, so that whole faces have no area.
CornerMesh pinched() {
    return sheet("pinched", 14, 9, [](int i, int j) {
        Vertex v = hill(i, j);
        if (i % 4 == 1 && j % 3 != 0) v.position = hill(i - 1, j).position;
        if (i > 11 && j > 6) v.position = hill(12, 7).position;
        return v;
    });
}

}  // namespace

std::vector<CornerMesh> small_meshes() {
    const CornerMesh hills = sheet("hills", 12, 8, hill);
    std::vector<CornerMesh> meshes{
        hills,
        mirrored_halves(),
        random_windings(),
        collapsed_uvs(),
        pinched(),
        book(),
        torus(18, 9),
        sphere("sphere", 20, 10, false),
        sphere("sphere, UVs of a pole shared", 20, 10, true),
        fan("cone", 48, 2.0f, true),
        fan("cone, odd", 33, 0.7f, true),
        fan("disc, polar UVs", 40, 0.0f, true),
        fan("disc, flat UVs", 40, 0.0f, false),
        pool("pool", 1, 500, 40, 16),
        pool("pool, coarse UVs", 2, 500, 60, 3),
        lattice("lattice", 3, 500, 3, 0.0f),
        unconnected("unconnected", 4, 120),
    };
    const CornerMesh uneven = fan("disc, polar UVs, uneven", 40, 0.0f, true, 0.4);
    meshes.push_back(uneven);
    meshes.push_back(changed(uneven, "disc, polar UVs turned, uneven",
                             [](std::size_t, auto&, auto&, vec2& uv) { uv = vec2(uv.y, -uv.x); }));
    meshes.push_back(
        changed(hills, "UVs differ at shared points", [](std::size_t c, auto&, auto&, vec2& uv) {
            if (c / 18 % 3 == 0) uv = vec2(uv.y + 3.0f, -uv.x);
            if (c / 18 % 3 == 1) uv = vec2(-uv.x, uv.y);
        }));
    meshes.push_back(
        changed(hills, "normals of any length", [](std::size_t, vec3& p, vec3& n, auto&) {
            n *= static_cast<float>(static_cast<int>(p.x + 2.0f * p.y) % 4) * 0.5f;
        }));
    meshes.push_back(changed(hills, "normals along the tangent",
                             [](std::size_t, auto&, vec3& n, auto&) { n = vec3(1, 0, 0); }));
    meshes.push_back(
        changed(hills, "no UVs", [](std::size_t, auto&, auto&, vec2& uv) { uv = vec2(0.0f); }));
    meshes.push_back(changed(hills, "very small", [](std::size_t, vec3& p, auto&, vec2& uv) {
        p *= 1e-6f;
        uv *= 1e-6f;
    }));
    meshes.push_back(changed(hills, "very large", [](std::size_t, vec3& p, auto&, vec2& uv) {
        p *= 1e6f;
        uv *= 1e6f;
    }));
    meshes.push_back(
        changed(hills, "UV areas below FLT_MIN",
                [](std::size_t, vec3& p, auto&, vec2& uv) { uv *= p.x > 6.0f ? 1e-19f : 1e-18f; }));
    return meshes;
}

std::vector<CornerMesh> large_meshes() {
    return {
        unconnected("100,000 triangles, unconnected", 11, 100'000),
        lattice("30,000 triangles, lattice", 12, 30'000, 16, 0.25f),
        pool("20,000 triangles, pool", 13, 20'000, 400, 64),
        fan("fan of 600, polar UVs", 600, 0.5f, true),
        fan("fan of 2,000, flat UVs", 2'000, 0.0f, false),
        sphere("sphere of 40,000", 200, 100, true),
    };
}

}  // namespace oracle
