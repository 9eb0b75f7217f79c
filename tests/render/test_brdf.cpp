// Every view against the shading model in double precision, pixel by pixel.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "tests/render/brdf_truth.h"
#include "tests/render/drawing.h"
#include "tests/render/ray_cast.h"
#include "tests/support/srgb_truth.h"
#include "tests/support/temporary_folder.h"

namespace {

using glm::dvec2;
using glm::dvec3;

/// Whole numbers from 0 to 255, dark ones among them.
dvec3 color_bytes(const dvec3& position) {
    return glm::round(127.5 + 127.5 * glm::sin(0.8 * position + dvec3(0.0, 1.0, 2.0)));
}

/// A mesh whose coordinates are floats, so that no number changes on its way through the files.
struct Mesh {
    std::vector<Surface> materials;
    std::vector<Triangle> triangles;

    /// With colours, a vertex has one that depends on its place alone.
    bool colors = false;

    void add(const std::array<dvec3, 3>& positions, const std::array<dvec3, 3>& normals) {
        Triangle triangle{{}, {}, materials.size() - 1};
        for (std::size_t k = 0; k < 3; ++k) {
            triangle.positions[k] = dvec3(glm::vec3(positions[k]));
            triangle.normals[k] = dvec3(glm::vec3(normals[k]));
            if (!colors) continue;
            const dvec3 bytes = color_bytes(triangle.positions[k]);
            for (int c = 0; c < 3; ++c) triangle.colors[k][c] = linear_of_srgb(bytes[c] / 255.0);
        }
        triangles.push_back(triangle);
    }
    void add_quad(const dvec3& center, const dvec3& right, const dvec3& up) {
        const dvec3 n = glm::normalize(glm::cross(right, up));
        add({center - right - up, center + right - up, center + right + up}, {n, n, n});
        add({center - right - up, center + right + up, center - right + up}, {n, n, n});
    }
    void add_sphere(const dvec3& center, double radius, int slices, int rings) {
        const auto normal = [&](int slice, int ring) {
            const double longitude = 2.0 * M_PI * slice / slices;
            const double latitude = M_PI * ring / rings - 0.5 * M_PI;
            return dvec3(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                         std::cos(latitude) * std::cos(longitude));
        };
        const auto add_triangle = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
            add({center + radius * a, center + radius * b, center + radius * c}, {a, b, c});
        };
        for (int ring = 0; ring < rings; ++ring) {
            for (int slice = 0; slice < slices; ++slice) {
                const dvec3 low_left = normal(slice, ring);
                const dvec3 high_right = normal(slice + 1, ring + 1);
                if (ring > 0) add_triangle(low_left, normal(slice + 1, ring), high_right);
                if (ring + 1 < rings) add_triangle(low_left, high_right, normal(slice, ring + 1));
            }
        }
    }

    void write(const std::filesystem::path& obj) const {
        std::filesystem::path mtl_path = obj;
        mtl_path.replace_extension(".mtl");
        std::ofstream mtl(mtl_path);
        for (std::size_t i = 0; i < materials.size(); ++i) {
            mtl << fmt::format("newmtl m{}\nKd {:.9g} {:.9g} {:.9g}\nPr {:.9g}\nPm {:.9g}\n", i,
                               materials[i].color.r, materials[i].color.g, materials[i].color.b,
                               materials[i].roughness, materials[i].metalness);
            const dvec3& emission = materials[i].emission;
            if (emission == dvec3(0.0)) continue;
            mtl << fmt::format("Ke {:.9g} {:.9g} {:.9g}\n", emission.r, emission.g, emission.b);
        }
        std::ofstream file(obj);
        file << "mtllib " << mtl_path.filename().string() << '\n';
        for (const Triangle& triangle : triangles) {
            for (const dvec3& p : triangle.positions) {
                file << fmt::format("v {:.9g} {:.9g} {:.9g}", p.x, p.y, p.z);
                if (colors) {
                    const dvec3 c = color_bytes(p) / 255.0;
                    file << fmt::format(" {:.9g} {:.9g} {:.9g}", c.r, c.g, c.b);
                }
                file << '\n';
            }
            for (const dvec3& n : triangle.normals) {
                file << fmt::format("vn {:.9g} {:.9g} {:.9g}\n", n.x, n.y, n.z);
            }
            file << fmt::format("usemtl m{}\nf -3//-3 -2//-2 -1//-1\n", triangle.material);
        }
    }
};

/// Roughness from the clamp to 1, metalness 0, 1 and between, every colour channel different.
Surface surface(int i) {
    constexpr double kRoughness[] = {0.045, 0.1, 0.17, 0.25, 0.35, 0.5, 0.65, 0.8, 0.9, 0.999, 1.0};
    constexpr double kMetalness[] = {0.0, 1.0, 0.5};
    const double shade = 0.15 + 0.17 * (i % 5);
    return {{shade, 0.9 - 0.8 * shade, 0.3 + 0.1 * (i % 7)},
            kRoughness[i % std::size(kRoughness)],
            kMetalness[i % std::size(kMetalness)]};
}

Mesh tilted_planes() {
    Mesh mesh;
    for (int i = 0; i < 24; ++i) {
        mesh.materials.push_back(surface(i));
        const dvec3 center((i % 6 - 2.5) * 1.25, (1.5 - i / 6) * 1.25, 0.1 * (i % 5));
        const double yaw = (2.5 - i % 6) * 0.3;
        const double pitch = (i / 6 - 1.5) * 0.35;
        const dvec3 right(std::cos(yaw), 0.0, -std::sin(yaw));
        const dvec3 forward(std::sin(yaw), 0.0, std::cos(yaw));
        const dvec3 up = std::cos(pitch) * dvec3(0.0, 1.0, 0.0) - std::sin(pitch) * forward;
        mesh.add_quad(center, 0.55 * right, 0.55 * up);
    }
    return mesh;
}

Mesh spheres() {
    Mesh mesh;
    for (int i = 0; i < 12; ++i) {
        mesh.materials.push_back(surface(i));
        mesh.add_sphere({(i % 4 - 1.5) * 1.3, (1.0 - i / 4) * 1.3, 0.2 * (i % 3)}, 0.6, 14, 8);
    }
    return mesh;
}

/// Spheres every other one of which emits, with vertex colours.
Mesh colored_spheres() {
    Mesh mesh;
    mesh.colors = true;
    for (int i = 0; i < 12; ++i) {
        mesh.materials.push_back(surface(i));
        if (i % 2 == 0) mesh.materials.back().emission = {0.5 * i, 0.25, 3.0 - 0.25 * i};
        mesh.add_sphere({(i % 4 - 1.5) * 1.3, (1.0 - i / 4) * 1.3, 0.2 * (i % 3)}, 0.6, 14, 8);
    }
    return mesh;
}

/// Strips that run from the camera to the horizon.
Mesh floor() {
    Mesh mesh;
    for (int i = 0; i < 11; ++i) {
        mesh.materials.push_back(surface(i));
        mesh.add_quad({(i - 5) * 1.0, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.0, -10.0});
    }
    return mesh;
}

constexpr dvec3 kSteepCamera(-4.0, 0.5, 18.0);
constexpr dvec3 kSteepLight(4.0, 0.5, 18.0);

/// The steepest lobes: quads about as large as they, each turned so that its centre has the peak.
Mesh steep_quads() {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        const double roughness = i % 4 == 0 ? 0.0 : 0.03 + 0.02 * (i % 4);
        mesh.materials.push_back({{0.9, 0.6, 0.3}, roughness, i < 4 ? 1.0 : 0.0});
        const dvec3 center((i % 4 - 1.5) * 0.08, (0.5 - i / 4) * 0.08, 0.0);
        const dvec3 half = glm::normalize(glm::normalize(kSteepCamera - center) +
                                          glm::normalize(kSteepLight - center));
        const dvec3 right = glm::normalize(glm::cross(dvec3(0.0, 1.0, 0.0), half));
        mesh.add_quad(center, 0.036 * right, 0.036 * glm::cross(half, right));
    }
    return mesh;
}

struct Shot {
    const char* name;
    Mesh (*mesh)();
    PinholeCamera camera;
    dvec3 light;
};

void PrintTo(const Shot& shot, std::ostream* out) {
    *out << shot.name;
}

// Sizes are odd here and there, so that no symmetry hides a pixel that is one off.
const Shot kShots[] = {
    {"tilted_planes",
     tilted_planes,
     {{0.25, 0.5, 7.0}, {0.0, 0.0, 0.0}, 42, 225, 141},
     {1.5, 2.0, 5.0}},
    {"spheres", spheres, {{0.5, 0.75, 5.0}, {0.0, 0.0, 0.0}, 50, 224, 150}, {2.0, 3.0, 4.0}},
    {"colors_and_emission",
     colored_spheres,
     {{0.5, 0.75, 5.0}, {0.0, 0.0, 0.0}, 50, 224, 150},
     {2.0, 3.0, 4.0}},
    {"light_behind", spheres, {{-0.5, 0.25, 5.0}, {0.0, 0.0, 0.0}, 50, 224, 150}, {1.0, 2.0, -4.0}},
    {"grazing", floor, {{0.25, 0.375, 11.0}, {0.0, 0.0, 0.0}, 60, 223, 121}, {0.5, 0.25, -9.0}},
    {"from_below", floor, {{0.25, -1.5, 8.0}, {0.0, 0.0, 0.0}, 60, 160, 91}, {0.5, 3.0, -2.0}},
    {"steep_lobes", steep_quads, {kSteepCamera, {0.0, 0.0, 0.0}, 1.0, 300, 161}, kSteepLight},
};

const Illumination kIllumination{{2.0, 1.5, 0.75}, {0.03, 0.05, 0.125}};

std::string text_of(const dvec3& v) {
    return fmt::format("{},{},{}", v.x, v.y, v.z);
}

/// What a view shows, where the vectors are unit vectors at a point of the surface.
struct Fragment {
    Surface surface;
    dvec3 normal, to_light, to_camera, vertex_color;
    Terms terms;
};

dvec3 encoded(const dvec3& v) {
    return 0.5 * v + 0.5;
}

struct ViewTruth {
    const char* name;
    dvec3 (*value)(const Fragment&);
};

const ViewTruth kViews[] = {
    {"shaded", [](const Fragment& f) { return f.terms.shaded; }},
    {"diffuse", [](const Fragment& f) { return f.terms.diffuse; }},
    {"specular", [](const Fragment& f) { return f.terms.specular; }},
    {"distribution", [](const Fragment& f) { return dvec3(f.terms.distribution); }},
    {"masking", [](const Fragment& f) { return dvec3(f.terms.masking); }},
    {"fresnel", [](const Fragment& f) { return f.terms.fresnel; }},
    {"normal", [](const Fragment& f) { return encoded(f.normal); }},
    {"vertex-normal", [](const Fragment& f) { return encoded(f.normal); }},
    {"view-direction", [](const Fragment& f) { return encoded(f.to_camera); }},
    {"light-direction", [](const Fragment& f) { return encoded(f.to_light); }},
    {"vertex-color", [](const Fragment& f) { return f.vertex_color; }},
    {"emission", [](const Fragment& f) { return f.surface.emission; }},
    {"base-color", [](const Fragment& f) { return f.surface.color; }},
    {"roughness", [](const Fragment& f) { return dvec3(f.surface.roughness); }},
    {"metalness", [](const Fragment& f) { return dvec3(f.surface.metalness); }},
};

Fragment fragment_at(const Shot& shot, const Mesh& mesh, std::size_t triangle, double x, double y) {
    const Hit point = hit(mesh.triangles[triangle], shot.camera, x, y);
    Fragment fragment{mesh.materials[mesh.triangles[triangle].material],
                      point.normal,
                      glm::normalize(shot.light - point.position),
                      glm::normalize(shot.camera.position - point.position),
                      point.color,
                      {}};
    fragment.surface.color *= point.color;
    fragment.terms = evaluate(fragment.surface, kIllumination, fragment.normal, fragment.to_light,
                              fragment.to_camera);
    return fragment;
}

/// A pixel's fragment, and those that it may show as well: a rasteriser rounds the corners of
/// triangles to 1/256 of a pixel.
struct PixelFragments {
    Coverage coverage;
    std::array<Fragment, 5> fragments;
};

std::vector<PixelFragments> fragments_of(const Shot& shot, const Mesh& mesh) {
    constexpr dvec2 kOffsets[] = {{0.0, 0.0}, {-1.0, -1.0}, {-1.0, 1.0}, {1.0, -1.0}, {1.0, 1.0}};
    std::vector<PixelFragments> pixels;
    for (const PixelTruth& truth : cast_rays(mesh.triangles, shot.camera)) {
        const auto i = static_cast<int>(pixels.size());
        PixelFragments& pixel = pixels.emplace_back();
        pixel.coverage = truth.coverage;
        if (truth.coverage != Coverage::surface) continue;
        for (std::size_t k = 0; k < pixel.fragments.size(); ++k) {
            const double x = i % shot.camera.width + 0.5 + kOffsets[k].x / 256.0;
            const double y = i / shot.camera.width + 0.5 + kOffsets[k].y / 256.0;
            pixel.fragments[k] = fragment_at(shot, mesh, truth.triangle, x, y);
        }
    }
    return pixels;
}

Picture draw(const Shot& shot, const std::filesystem::path& scene, const std::string& view) {
    return draw_scene(
        scene, ".exr",
        {"--samples", "1", "--view", view, "--size",
         fmt::format("{}x{}", shot.camera.width, shot.camera.height), "--camera-position",
         text_of(shot.camera.position), "--camera-target", text_of(shot.camera.target), "--fov",
         fmt::format("{}", shot.camera.vertical_fov), "--light-position", text_of(shot.light),
         "--light-color", text_of(kIllumination.light), "--ambient",
         text_of(kIllumination.ambient)});
}

/// How far a picture is from the truth.
struct Comparison {
    int compared = 0;      ///< pixels
    int strict = 0;        ///< of those, pixels where 1/256 of a pixel makes no more than the bound
    double error = 0.0;    ///< largest of error / allowed error
    double largest = 0.0;  ///< value in the picture
    int wrong_cover = 0;   ///< pixels with another alpha or background than they should have
};

/// A value may be off by 1e-3 of itself, or by as much as 1/256 of a pixel makes, or by 1e-6.
void compare_surface(const float* sample, const PixelFragments& pixel, const ViewTruth& view,
                     Comparison& result) {
    ++result.compared;
    bool strict = true;
    for (int c = 0; c < 3; ++c) {
        const double truth = view.value(pixel.fragments[0])[c];
        double spread = 0.0;
        for (const Fragment& other : pixel.fragments) {
            spread = std::max(spread, std::abs(view.value(other)[c] - truth));
        }
        const double bound = std::max(1e-3 * std::abs(truth), 1e-6);
        strict = strict && spread <= bound;
        result.error =
            std::max(result.error, std::abs(double{sample[c]} - truth) / std::max(bound, spread));
        result.largest = std::max(result.largest, double{sample[c]});
    }
    if (strict) ++result.strict;
}

Comparison compare(const Picture& picture, const std::vector<PixelFragments>& pixels,
                   const ViewTruth& view) {
    Comparison result;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const float* const sample = &picture.samples[4 * i];
        const bool background =
            sample[3] == 0.0f && sample[0] == 0.1f && sample[1] == 0.1f && sample[2] == 0.1f;
        const bool surface = sample[3] == 1.0f;
        switch (pixels[i].coverage) {
            case Coverage::background:
                if (!background) ++result.wrong_cover;
                break;
            case Coverage::surface:
                if (!surface) ++result.wrong_cover;
                compare_surface(sample, pixels[i], view, result);
                break;
            case Coverage::edge:
                if (!surface && !background) ++result.wrong_cover;
                break;
        }
    }
    return result;
}

int count_not_finite(const Picture& picture) {
    return static_cast<int>(std::count_if(picture.samples.begin(), picture.samples.end(),
                                          [](float sample) { return !std::isfinite(sample); }));
}

std::filesystem::path baked(const Mesh& mesh, const TemporaryFolder& folder) {
    mesh.write(folder / "scene.obj");
    return bake_scene(folder / "scene.obj", {"--tangent-frame", "f32", "--positions", "f32"});
}

class Brdf : public testing::TestWithParam<Shot> {};

TEST_P(Brdf, EveryViewMatchesTheShadingModel) {
    const Shot& shot = GetParam();
    const Mesh mesh = shot.mesh();
    const TemporaryFolder folder;
    const auto scene = baked(mesh, folder);
    const std::vector<PixelFragments> pixels = fragments_of(shot, mesh);
    for (const ViewTruth& view : kViews) {
        SCOPED_TRACE(view.name);
        const Picture picture = draw(shot, scene, view.name);
        const Comparison result = compare(picture, pixels, view);
        fmt::print("{:13} {:15} {:6} pixels, {:3.0f} % strict, error {:.3f} of the bound\n",
                   shot.name, view.name, result.compared, 100.0 * result.strict / result.compared,
                   result.error);
        EXPECT_EQ(count_not_finite(picture), 0);
        EXPECT_EQ(result.wrong_cover, 0);
        EXPECT_LE(result.error, 1.0);
        EXPECT_GT(result.compared, picture.width * picture.height / 5);
        EXPECT_GT(result.strict, result.compared / 2);
        if (shot.mesh == steep_quads && view.name == std::string("distribution")) {
            EXPECT_GT(result.largest, 77'000.0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Shots, Brdf, testing::ValuesIn(kShots),
                         [](const auto& shot) { return std::string(shot.param.name); });

/// A plate at z = 0, and plates whose normals lie in their plane or vanish in their middle.
Mesh degenerate_plates() {
    Mesh mesh;
    for (const double roughness : {0.0, 1.0}) {
        mesh.materials.push_back({{0.8, 0.5, 0.2}, roughness, roughness});
        const double y = 1.1 * roughness;
        mesh.add_quad({0.0, y, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.5, 0.0});
        const auto triangle = [&](double x, const dvec3& left, const dvec3& right) {
            mesh.add({dvec3(x - 0.5, y - 0.5, 0.0), {x + 0.5, y - 0.5, 0.0}, {x, y + 0.5, 0.0}},
                     {left, right, glm::normalize(left + right + dvec3(0.0, 1e-3, 0.0))});
        };
        triangle(-1.1, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0});
        triangle(1.1, {1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0});
    }
    return mesh;
}

struct NamedLight {
    const char* name;
    dvec3 position;
};

void PrintTo(const NamedLight& light, std::ostream* out) {
    *out << light.name;
}

class DegenerateLight : public testing::TestWithParam<NamedLight> {};

TEST_P(DegenerateLight, LeavesEveryPixelFinite) {
    // The picture's size is odd, so that the middle pixel's ray is the z axis.
    const Shot shot{"",
                    degenerate_plates,
                    {{0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}, 40, 161, 121},
                    GetParam().position};
    const TemporaryFolder folder;
    const auto scene = baked(shot.mesh(), folder);
    for (const char* const view : {"shaded", "diffuse", "specular", "distribution", "masking",
                                   "fresnel", "light-direction", "normal"}) {
        SCOPED_TRACE(view);
        const Picture picture = draw(shot, scene, view);
        EXPECT_EQ(count_not_finite(picture), 0);
        EXPECT_EQ(picture.at(80, 60)[3], 1.0f);
    }
}

INSTANTIATE_TEST_SUITE_P(Positions, DegenerateLight,
                         testing::Values(NamedLight{"on_the_surface", {0.0, 0.0, 0.0}},
                                         NamedLight{"in_the_plane", {5.0, 0.0, 0.0}},
                                         NamedLight{"opposite_the_camera", {0.0, 0.0, -5.0}},
                                         NamedLight{"at_the_camera", {0.0, 0.0, 5.0}},
                                         NamedLight{"far_away", {1e30, 1e30, 1e30}}),
                         [](const auto& light) { return std::string(light.param.name); });

}  // namespace
