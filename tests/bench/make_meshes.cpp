// make_meshes KIND SIZE >FILE.obj
//
// Meshes for the benchmarks, the same on every machine with this library's random numbers:
//   sheet  a wavy one of SIDE^2 x 2 triangles, all smooth
//   shuffled  the same, its triangles and vertices in no order
//   noise  a ball of SIDE^2 x 2 triangles under seven octaves of noise, its vertices jittered; its
//          normals are those of its triangles, by area
//   scan   heights with noise in them, SIDE^2 x 2 triangles, no UVs; normals the same
//   cad    boxes and cylinders of SIZE triangles, most of them along the axes
//   cards  SIZE leaves of two triangles, each with one of eight parts of a texture
//   rooms  SIZE bumpy balls of 707^2 x 2 triangles, side by side, all smooth
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <numeric>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

namespace {

constexpr double kPi = std::numbers::pi;

struct Vector {
    double x, y, z;
};
Vector operator+(Vector a, Vector b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vector operator-(Vector a, Vector b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vector operator*(double s, Vector a) {
    return {s * a.x, s * a.y, s * a.z};
}
Vector cross(Vector a, Vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(Vector a, Vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector unit(Vector a) {
    const double length = std::sqrt(dot(a, a));
    return length > 0 ? 1 / length * a : a;
}

std::mt19937 generator(7);
double random01() {
    return std::uniform_real_distribution<>(0, 1)(generator);
}

std::uint32_t hash(std::uint32_t x) {
    x = (x ^ x >> 16) * 0x7feb352d;
    x = (x ^ x >> 15) * 0x846ca68b;
    return x ^ x >> 16;
}

/// Between -1 and 1, smooth, of a wavelength of about 2.
double noise(Vector p) {
    const double cell[] = {std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    const double at[] = {p.x - cell[0], p.y - cell[1], p.z - cell[2]};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::uint32_t key = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double t = at[axis];
            const double smooth = t * t * t * (t * (6 * t - 15) + 10);
            const int side = corner >> axis & 1;
            weight *= side ? smooth : 1 - smooth;
            key = hash(key + static_cast<std::uint32_t>(static_cast<int>(cell[axis]) + side));
        }
        sum += (key / 4294967295.0 * 2 - 1) * weight;
    }
    return sum;
}
double octaves(Vector p, int count) {
    double sum = 0;
    double amplitude = 0.5;
    for (int i = 0; i < count; ++i, amplitude *= 0.5, p = 2.03 * p) sum += amplitude * noise(p);
    return sum;
}

void print_position(Vector p) {
    std::printf("v %.6f %.6f %.6f\n", p.x, p.y, p.z);
}
void print_normal(Vector n) {
    std::printf("vn %.6f %.6f %.6f\n", n.x, n.y, n.z);
}
void print_uv(double u, double v) {
    std::printf("vt %.6f %.6f\n", u, v);
}

/// Two triangles, cut along one of the two diagonals, for each cell of a grid.
template <typename Print>
void for_each_triangle(int side, const Print& print) {
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const int a = y * (side + 1) + x;
            const int b = a + 1;
            const int c = a + side + 1;
            const int d = c + 1;
            if (hash(static_cast<std::uint32_t>(a)) & 1) {
                print(std::array{a, b, c});
                print(std::array{b, d, c});
            } else {
                print(std::array{a, b, d});
                print(std::array{a, d, c});
            }
        }
    }
}

/// Of vertices behind the first `before`.
void print_smooth_behind(int before, const std::array<int, 3>& t) {
    std::printf("f");
    for (const int i : t) std::printf(" %d/%d/%d", before + i + 1, before + i + 1, before + i + 1);
    std::printf("\n");
}
void print_smooth(const std::array<int, 3>& t) {
    print_smooth_behind(0, t);
}

void make_sheet(int side, bool shuffled) {
    const auto vertices = static_cast<std::size_t>((side + 1) * (side + 1));
    std::vector<int> order(vertices);
    std::iota(order.begin(), order.end(), 0);
    if (shuffled) std::shuffle(order.begin(), order.end(), generator);
    std::vector<int> place(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
        place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
        const double u = static_cast<double>(order[i] % (side + 1)) / side;
        const double v = static_cast<double>(order[i] / (side + 1)) / side;
        print_position({10 * u, 0.1 * std::sin(9 * u) * std::cos(7 * v), -10 * v});
        print_uv(u, v);
        print_normal(unit({-0.9 * std::cos(9 * u) * std::cos(7 * v), 1,
                           -0.7 * std::sin(9 * u) * std::sin(7 * v)}));
    }
    std::vector<std::array<int, 3>> triangles;
    for_each_triangle(side, [&](std::array<int, 3> t) {
        for (int& i : t) i = place[static_cast<std::size_t>(i)];
        triangles.push_back(t);
    });
    if (shuffled) std::shuffle(triangles.begin(), triangles.end(), generator);
    for (const auto& t : triangles) print_smooth(t);
}

/// The sum of each vertex's triangles' normals, each as long as two times the area.
std::vector<Vector> normals_of(const std::vector<Vector>& positions, int side) {
    std::vector<Vector> normals(positions.size());
    for_each_triangle(side, [&](const std::array<int, 3>& t) {
        const Vector& p = positions[static_cast<std::size_t>(t[0])];
        const Vector n = cross(positions[static_cast<std::size_t>(t[1])] - p,
                               positions[static_cast<std::size_t>(t[2])] - p);
        for (const int i : t)
            normals[static_cast<std::size_t>(i)] = normals[static_cast<std::size_t>(i)] + n;
    });
    return normals;
}

void make_noise(int side) {
    std::vector<Vector> positions;
    for (int y = 0; y <= side; ++y) {
        for (int x = 0; x <= side; ++x) {
            const double jitter = x > 0 && x < side && y > 0 && y < side ? 0.5 : 0;
            const double u = (x + jitter * (random01() - 0.5)) / side;
            const double v = (y + jitter * (random01() - 0.5)) / side;
            const double polar = kPi * (0.02 + 0.96 * v);
            const double around = 2 * kPi * u;
            const Vector d{std::sin(polar) * std::cos(around), std::cos(polar),
                           std::sin(polar) * std::sin(around)};
            positions.push_back((1 + 0.35 * octaves(2.5 * d + Vector{5, 5, 5}, 7)) * d);
            print_position(positions.back());
            print_uv(u, 1 - v);
        }
    }
    for (const Vector& normal : normals_of(positions, side)) print_normal(unit(normal));
    for_each_triangle(side, print_smooth);
}

void make_scan(int side) {
    std::vector<Vector> positions;
    for (int y = 0; y <= side; ++y) {
        for (int x = 0; x <= side; ++x) {
            const double u = (x + 0.7 * (random01() - 0.5)) / side;
            const double v = (y + 0.7 * (random01() - 0.5)) / side;
            const double error = 0.0003 * (random01() + random01() - 1);
            positions.push_back({u, 0.3 * octaves({4 * u, 4 * v, 3}, 8) + error, v});
        }
    }
    const std::vector<Vector> normals = normals_of(positions, side);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        print_position(positions[i]);
        print_normal(unit(-1.0 * normals[i]));
    }
    for_each_triangle(side, [](const std::array<int, 3>& t) {
        std::printf("f %d//%d %d//%d %d//%d\n", t[0] + 1, t[0] + 1, t[2] + 1, t[2] + 1, t[1] + 1,
                    t[1] + 1);
    });
}

/// A quad of corners and normals, UVs from 0 to (width, height); `first` is its first vertex.
void print_quad(const std::array<Vector, 4>& corners, const std::array<Vector, 4>& normals,
                double width, double height, int first) {
    for (const Vector& corner : corners) print_position(corner);
    for (const Vector& normal : normals) print_normal(normal);
    print_uv(0, 0);
    print_uv(width, 0);
    print_uv(width, height);
    print_uv(0, height);
    for (const std::array<int, 3>& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        std::printf("f");
        for (const int i : t) std::printf(" %d/%d/%d", first + i + 1, first + i + 1, first + i + 1);
        std::printf("\n");
    }
}

void make_cad(int triangles) {
    int vertices = 0;
    const auto quad = [&](const std::array<Vector, 4>& corners,
                          const std::array<Vector, 4>& normals, double width, double height) {
        print_quad(corners, normals, width, height, vertices);
        vertices += 4;
    };
    const auto whole = [](int most) { return std::floor(1 + random01() * most); };
    while (vertices < 2 * triangles) {
        const Vector o{random01() * 100, random01() * 100, random01() * 20};
        Vector x{1, 0, 0};
        Vector y{0, 1, 0};
        Vector z{0, 0, 1};
        if (random01() < 0.3) {
            const double turn = std::floor(random01() * 12) * kPi / 6;
            x = {std::cos(turn), std::sin(turn), 0};
            y = {-std::sin(turn), std::cos(turn), 0};
        }
        if (random01() < 0.3) std::swap(x, z);
        if (random01() < 0.6) {
            const double sizes[] = {0.25 * whole(40), 0.25 * whole(40), 0.25 * whole(20)};
            const Vector axes[] = {x, y, z};
            for (int axis = 0; axis < 3; ++axis) {
                const int second = (axis + 1) % 3;
                const int third = (axis + 2) % 3;
                const Vector p = sizes[second] * axes[second];
                const Vector q = sizes[third] * axes[third];
                const Vector far = o + sizes[axis] * axes[axis];
                const Vector n = axes[axis];
                const Vector m = -1.0 * n;
                quad({far, far + p, far + p + q, far + q}, {n, n, n, n}, sizes[second],
                     sizes[third]);
                quad({o, o + q, o + p + q, o + p}, {m, m, m, m}, sizes[third], sizes[second]);
            }
        } else {
            const double radius = 0.1 * whole(20);
            const Vector along = 0.25 * whole(40) * z;
            const int sides = 8 * static_cast<int>(whole(4));
            for (int i = 0; i < sides; ++i) {
                const auto direction = [&](int k) {
                    const double angle = 2 * kPi * k / sides;
                    return std::cos(angle) * x + std::sin(angle) * y;
                };
                const Vector a = direction(i);
                const Vector b = direction(i + 1);
                quad({o + radius * a, o + radius * b, o + radius * b + along,
                      o + radius * a + along},
                     {a, b, b, a}, 1.0 / sides, std::sqrt(dot(along, along)));
            }
        }
    }
}

void make_cards(int count) {
    for (int i = 0; i < count; ++i) {
        const Vector o{random01() * 10, random01() * 6, random01() * 10};
        const Vector n = unit({random01() * 2 - 1, random01() * 2 - 0.3, random01() * 2 - 1});
        const Vector t =
            unit(cross(n, unit({random01() - 0.5, random01() - 0.5, random01() - 0.5})));
        const double size = 0.05 + 0.1 * random01();
        const Vector p = size * t;
        const Vector q = 1.5 * size * cross(n, t);
        const std::uint32_t part = static_cast<std::uint32_t>(generator()) % 8;
        const double u = part % 4 * 0.25;
        const double v = part / 4 * 0.5;
        for (const Vector& corner : {o, o + p, o + p + q, o + q}) print_position(corner);
        print_normal(n);
        print_uv(u, v);
        print_uv(u + 0.25, v);
        print_uv(u + 0.25, v + 0.5);
        print_uv(u, v + 0.5);
        for (const std::array<int, 3>& corners : {std::array{1, 2, 3}, std::array{1, 3, 4}}) {
            std::printf("f");
            for (const int k : corners) std::printf(" %d/%d/%d", 4 * i + k, 4 * i + k, i + 1);
            std::printf("\n");
        }
    }
}

void make_rooms(int count) {
    constexpr int kRoomSide = 707;
    constexpr int kRoomVertices = (kRoomSide + 1) * (kRoomSide + 1);
    const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int room = 0; room < count; ++room) {
        std::printf("o room%d\n", room);
        const Vector corner{3.0 * (room % columns), 0, 3.0 * (room / columns)};
        for (int y = 0; y <= kRoomSide; ++y) {
            for (int x = 0; x <= kRoomSide; ++x) {
                const double polar = kPi * (0.01 + 0.98 * y / kRoomSide);
                const double around = 2 * kPi * x / kRoomSide;
                const Vector n{std::sin(polar) * std::cos(around), std::cos(polar),
                               std::sin(polar) * std::sin(around)};
                print_position(corner + (1.2 + 0.05 * std::sin(9 * around) * std::sin(7 * polar) +
                                         0.01 * std::sin(61 * around + 43 * polar)) *
                                            n);
                print_uv(static_cast<double>(x) / kRoomSide, static_cast<double>(y) / kRoomSide);
                print_normal(n);
            }
        }
        for_each_triangle(kRoomSide, [&](const std::array<int, 3>& t) {
            print_smooth_behind(room * kRoomVertices, t);
        });
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view kind = argc == 3 ? argv[1] : "";
    const int size = argc == 3 ? std::atoi(argv[2]) : 0;
    if (size < 1) return 2;
    std::printf("mtllib meshes.mtl\nusemtl m\n");  // without one gltfpack makes no tangents
    if (kind == "sheet" || kind == "shuffled") {
        make_sheet(size, kind == "shuffled");
    } else if (kind == "noise") {
        make_noise(size);
    } else if (kind == "scan") {
        make_scan(size);
    } else if (kind == "cad") {
        make_cad(size);
    } else if (kind == "cards") {
        make_cards(size);
    } else if (kind == "rooms") {
        make_rooms(size);
    } else {
        return 2;
    }
}
