// make_test_scenes: writes the scenes of the render tests, always the same bytes.
//
// Usage: make_test_scenes FOLDER
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tests/render/gltf_scenes.h"
#include "tests/render/known_textures.h"
#include "tests/render/scene_writer.h"
#include "tests/support/image.h"

namespace {

namespace fs = std::filesystem;
using glm::dvec2;
using glm::dvec3;

constexpr int kSize = 128;  // texels a side

/// The centre of texel (x, y), v up.
dvec2 uv_of(int x, int y) {
    return {(x + 0.5) / kSize, 1.0 - (y + 0.5) / kSize};
}

bool in_box(dvec2 p, double left, double bottom, double right, double top) {
    return p.x > left && p.x < right && p.y > bottom && p.y < top;
}

/// An F, with another colour in each corner: which way is up and right can be seen.
std::vector<double> letter(dvec2 p) {
    if (in_box(p, 0.34, 0.2, 0.46, 0.8) || in_box(p, 0.34, 0.68, 0.72, 0.8) ||
        in_box(p, 0.34, 0.44, 0.62, 0.56)) {
        return {0.08, 0.08, 0.1};
    }
    if (in_box(p, 0.0, 0.8, 0.2, 1.0)) return {0.85, 0.15, 0.1};
    if (in_box(p, 0.8, 0.8, 1.0, 1.0)) return {0.1, 0.6, 0.15};
    if (in_box(p, 0.0, 0.0, 0.2, 0.2)) return {0.1, 0.25, 0.8};
    if (in_box(p, 0.8, 0.0, 1.0, 0.2)) return {0.9, 0.8, 0.1};
    return {0.8, 0.78, 0.72};
}

std::vector<double> encoded(const std::array<double, 3>& normal) {
    return {0.5 + 0.5 * normal[0], 0.5 + 0.5 * normal[1], 0.5 + 0.5 * normal[2]};
}

void write_textures(const fs::path& folder) {
    const auto write = [&](const char* name, int channels, const auto& paint) {
        write_picture(folder / name, painted(kSize, kSize, channels,
                                             [&](int x, int y) { return paint(uv_of(x, y)); }));
    };
    write("letter.png", 3, letter);
    write("bumps.png", 3, [](dvec2 p) { return encoded(bump_normal(p.x, p.y)); });
    // -bm 16.64 makes a step from 0 to 1 as high as 16.64 texels, 0.13 of the width.
    write("heights.png", 1,
          [](dvec2 p) { return std::vector{0.5 + bump_height(p.x, p.y) / 0.13}; });
    write("leaf_mask.png", 1, [](dvec2 p) { return std::vector{in_leaf(p.x, p.y) ? 1.0 : 0.0}; });
    write("leaf.png", 4, [](dvec2 p) {
        const double vein = std::abs(p.x - 0.5) < 0.03 ? 0.5 : 1.0;
        return std::vector{0.25 * vein, 0.55 * vein, 0.2 * vein, in_leaf(p.x, p.y) ? 1.0 : 0.0};
    });
    write("rough.png", 1, [](dvec2 p) { return std::vector{p.y < 0.5 ? 0.25 : 0.7}; });
    write("metal.png", 1,
          [](dvec2 p) { return std::vector{std::fmod(p.x * 8.0, 1.0) < 0.5 ? 0.0 : 1.0}; });
    write("quadrants.png", 3, [](dvec2 p) {
        const int* const color = kQuadrants[(p.y > 0.5 ? 2 : 0) + (p.x > 0.5 ? 1 : 0)];
        return std::vector{color[0] / 255.0, color[1] / 255.0, color[2] / 255.0};
    });
}

/// A plate 2 * width wide and `height` high whose right half shows the texture, the left half its
/// mirror image.
void mirrored_plate(SceneWriter& scene, dvec3 foot, double width, double height) {
    const auto half = [&](double side) {
        const dvec3 n(0.0, 0.0, 1.0);
        const dvec3 outer = foot + dvec3(side * width, 0.0, 0.0);
        const dvec3 up(0.0, height, 0.0);
        std::vector<Corner> corners{{foot, {0.0, 0.0}, n},
                                    {outer, {1.0, 0.0}, n},
                                    {outer + up, {1.0, 1.0}, n},
                                    {foot + up, {0.0, 1.0}, n}};
        if (side < 0.0) std::swap(corners[1], corners[3]);
        scene.polygon(corners);
    };
    half(1.0);
    half(-1.0);
}

void spheres(SceneWriter& scene) {
    const auto add = [&](const char* name, std::vector<std::string> lines, dvec3 center) {
        scene.material(name, lines);
        scene.sphere(center, 0.42, 24, 12);
    };
    add("red", {"Kd 0.7 0.05 0.04", "Pr 0.2"}, {-2.3, 0.42, 0.9});
    add("gold", {"Kd 1.0 0.71 0.29", "Pr 0.45", "Pm 1"}, {-1.35, 0.42, 1.1});
    add("white", {"Kd 0.8 0.8 0.8", "Pr 0.9"}, {-0.4, 0.42, 1.2});
    add("mixed", {"Kd 0.6 0.65 0.7", "map_Pr rough.png", "map_Pm metal.png"}, {0.55, 0.42, 1.1});
    // No normals and no UVs: one smooth, one faceted.
    scene.material("bare", {"Kd 0.3 0.5 0.6", "Ns 40"});
    scene.line("s 1");
    scene.sphere({1.4, 0.42, 0.9}, 0.42, 10, 6, Attributes::positions);
    scene.line("s off");
    scene.sphere({2.3, 0.42, 0.7}, 0.42, 8, 5, Attributes::positions);
}

/// Every feature in one picture.
void write_stage(const fs::path& folder, const std::string& name,
                 const std::function<dvec3(dvec3)>& turn = {}) {
    SceneWriter scene(folder, name, turn);
    scene.material("floor", {"map_Kd letter.png", "Pr 0.6"});
    scene.quad({-3.2, 0.0, 2.2}, {6.4, 0.0, 0.0}, {0.0, 0.0, -4.4}, {6.4, 4.4});
    scene.material("wall", {"Kd 0.55 0.5 0.45", "Pr 0.35", "norm bumps.png"});
    mirrored_plate(scene, {0.0, 0.0, -2.2}, 2.2, 2.2);
    spheres(scene);
    scene.material("cube", {"map_Kd letter.png", "Pr 0.3"});
    scene.cube({1.0, 0.55, -0.8}, 0.55, 30.0);
    scene.material("cut_by_map_d", {"map_Kd leaf.png", "map_d leaf_mask.png", "Pr 0.5"});
    scene.quad({0.9, 0.0, 0.15}, {1.0, 0.0, 0.25}, {0.0, 1.3, 0.0});
    scene.material("cut_by_alpha", {"map_Kd leaf.png", "Pr 0.5", "norm bumps.png"});
    scene.quad({-2.4, 0.0, -0.3}, {1.1, 0.0, -0.3}, {0.0, 1.5, 0.0});
    scene.material("heights", {"Kd 0.5 0.55 0.6", "Pr 0.4", "map_Bump -bm 16.64 heights.png"});
    scene.quad({-1.2, 0.0, -1.0}, {1.3, 0.0, 0.3}, {0.0, 1.3, -0.3});
}

/// What emits and what has vertex colours.
void write_glow(const fs::path& folder) {
    SceneWriter scene(folder, "glow");
    scene.material("floor", {"Kd 0.9 0.9 0.9", "Pr 0.8"});
    const dvec3 up(0.0, 1.0, 0.0);
    scene.polygon({{{-3.0, 0.0, 2.0}, {0, 0}, up, dvec3(1.0, 0.1, 0.1)},
                   {{3.0, 0.0, 2.0}, {1, 0}, up, dvec3(0.1, 0.9, 0.2)},
                   {{3.0, 0.0, -2.0}, {1, 1}, up, dvec3(0.2, 0.3, 1.0)},
                   {{-3.0, 0.0, -2.0}, {0, 1}, up, dvec3(1.0, 1.0, 1.0)}});
    scene.material("lamp", {"Kd 0.2 0.2 0.2", "Pr 0.4", "Ke 0.9 0.5 0.1"});
    scene.sphere({-1.4, 0.5, 0.4}, 0.5, 24, 12);
    scene.material("sign", {"Kd 0.3 0.3 0.3", "Pr 0.5", "map_Ke letter.png"});
    scene.cube({0.2, 0.5, -0.3}, 0.5, 25.0);
    scene.material("glowing_leaf", {"Kd 0.1 0.3 0.1", "Pr 0.5", "Ke 0.3 1 0.2", "map_Ke leaf.png",
                                    "map_d leaf_mask.png"});
    scene.quad({1.0, 0.0, 0.2}, {1.0, 0.0, 0.2}, {0.0, 1.3, 0.0});

    SceneWriter screen(folder, "screen");
    screen.material(
        "screen", {"Kd 0.5 0.5 0.5", "Ke 2 1 0.25", "map_Ke quadrants.png", "map_d leaf_mask.png"});
    screen.quad({-1.0, -1.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0});
}

void write_plates(const fs::path& folder) {
    SceneWriter plate(folder, "plate");
    plate.material("bumps", {"Kd 0.6 0.6 0.6", "Pr 0.4", "norm bumps.png"});
    mirrored_plate(plate, {0.0, -1.0, 0.0}, 2.0, 2.0);

    SceneWriter heights(folder, "heights");
    heights.material("heights", {"Kd 0.6 0.6 0.6", "map_Bump -bm 16.64 heights.png"});
    mirrored_plate(heights, {0.0, -1.0, 0.0}, 2.0, 2.0);

    SceneWriter quadrants(folder, "quadrants");
    quadrants.material("quadrants", {"map_Kd quadrants.png"});
    quadrants.quad({-1.0, -1.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0});

    SceneWriter leaf(folder, "leaf");
    leaf.material("leaf", {"Kd 1 1 1", "map_d leaf_mask.png"});
    leaf.quad({-1.0, -1.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0});
}

/// 16 stripes from left to right, of base colours k / 15.
void write_greys(const fs::path& folder) {
    SceneWriter greys(folder, "greys");
    for (int k = 0; k < 16; ++k) {
        const double value = k / 15.0;
        greys.material(fmt::format("grey{}", k),
                       {fmt::format("Kd {0:.6f} {0:.6f} {0:.6f}", value)});
        greys.quad({(k - 8) * 0.25, -1.0, 0.0}, {0.25, 0.0, 0.0}, {0.0, 2.0, 0.0});
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        fmt::print(stderr, "usage: make_test_scenes FOLDER\n");
        return 2;
    }
    try {
        const fs::path folder(argv[1]);
        fs::create_directories(folder);
        write_textures(folder);
        write_stage(folder, "stage");
        write_stage(folder, "stage_z_up", [](dvec3 p) { return dvec3(p.x, -p.z, p.y); });
        write_glow(folder);
        write_plates(folder);
        write_greys(folder);
        write_gltf_scenes(folder);
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "make_test_scenes: {}\n", error.what());
        return 1;
    }
}
