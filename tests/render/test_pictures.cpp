// What pictures must show whatever a golden says: orientation, colours, bumps, masks, the light's
// way and the camera that nobody chose.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/render/drawing.h"
#include "tests/render/known_textures.h"
#include "tests/support/srgb_truth.h"
#include "tests/support/temporary_folder.h"

namespace {

using glm::dvec2;
using glm::dvec3;
using Options = std::vector<std::string>;

class Pictures : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        make_test_scenes(folder_->path());
    }
    static void TearDownTestSuite() {
        scenes_.clear();
        folder_.reset();
    }

    static Picture draw(const std::string& scene, const std::string& extension,
                        const Options& options) {
        auto [baked, is_new] = scenes_.try_emplace(scene);
        if (is_new) baked->second = bake_scene(*folder_ / (scene + ".obj"));
        return draw_scene(baked->second, extension, options);
    }

    /// Seen from (0, 0, 2); for_each_point() knows which point of the plane z = 0 a pixel shows.
    static Picture draw_frontal(const std::string& scene, const std::string& extension,
                                const std::string& view, Options options = {}) {
        const Options frontal{
            "--view",          view,    "--size", "301x151", "--camera-position", "0,0,2",
            "--camera-target", "0,0,0", "--fov",  "60"};
        options.insert(options.end(), frontal.begin(), frontal.end());
        if (std::find(options.begin(), options.end(), "--samples") == options.end()) {
            options.insert(options.end(), {"--samples", "1"});
        }
        return draw(scene, extension, options);
    }

 private:
    static std::unique_ptr<TemporaryFolder> folder_;
    static std::map<std::string, std::filesystem::path> scenes_;
};

std::unique_ptr<TemporaryFolder> Pictures::folder_;
std::map<std::string, std::filesystem::path> Pictures::scenes_;

/// Calls `look` with the point of the plane and the samples of every pixel that shows a point at
/// most `width` from the middle to the side and `height` upwards.
template <typename Look>
void for_each_point(const Picture& picture, double width, double height, Look look) {
    const double size = 4.0 * std::tan(M_PI / 6.0) / picture.height;
    int seen = 0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const dvec2 point((x + 0.5 - 0.5 * picture.width) * size,
                              (0.5 * picture.height - y - 0.5) * size);
            if (std::abs(point.x) >= width || std::abs(point.y) >= height) continue;
            look(point, picture.at(x, y));
            ++seen;
        }
    }
    ASSERT_GT(seen, 1000);
}

/// The largest difference between two pictures' samples.
double largest_difference(const Picture& a, const Picture& b) {
    EXPECT_EQ(a.samples.size(), b.samples.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < std::min(a.samples.size(), b.samples.size()); ++i) {
        largest = std::max(largest, std::abs(double{a.samples[i]} - b.samples[i]));
    }
    return largest;
}

TEST_F(Pictures, TexturesStandUprightAndKeepTheirBytes) {
    const Picture picture = draw_frontal("quadrants", ".png", "base-color");
    for_each_point(picture, 0.95, 0.95, [](dvec2 point, const float* sample) {
        // Filtering mixes the quarters along their edges.
        if (std::abs(point.x) < 0.05 || std::abs(point.y) < 0.05) return;
        const int* const color = kQuadrants[(point.y > 0.0 ? 2 : 0) + (point.x > 0.0 ? 1 : 0)];
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(sample[c], color[c] / 255.0, kByteStep);
    });
}

TEST_F(Pictures, PngHoldsSrgbAndExrLinearValues) {
    const auto value_at = [](dvec2 point) { return std::floor((point.x + 2.0) / 0.25) / 15.0; };
    const auto at_an_edge = [](dvec2 point) {
        return std::abs(std::remainder(point.x, 0.25)) < 0.02;
    };
    const Picture png = draw_frontal("greys", ".png", "base-color");
    for_each_point(png, 1.99, 0.9, [&](dvec2 point, const float* sample) {
        ASSERT_TRUE(at_an_edge(point) ||
                    std::abs(sample[1] - srgb_of_linear(value_at(point))) < kByteStep);
    });
    const Picture exr = draw_frontal("greys", ".exr", "base-color");
    for_each_point(exr, 1.99, 0.9, [&](dvec2 point, const float* sample) {
        ASSERT_TRUE(at_an_edge(point) || std::abs(sample[2] - value_at(point)) < 1e-6);
    });
}

TEST_F(Pictures, PngIsTheExrEncoded) {
    const Options options{"--size", "160x90", "--samples", "1", "--exposure", "0"};
    const Picture png = draw("stage", ".png", options);
    const Picture exr = draw("stage", ".exr", options);
    ASSERT_EQ(png.channels, 3);
    ASSERT_EQ(exr.channels, 4);
    for (int y = 0; y < png.height; ++y) {
        for (int x = 0; x < png.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double linear = std::clamp(double{exr.at(x, y)[c]}, 0.0, 1.0);
                ASSERT_NEAR(png.at(x, y)[c], srgb_of_linear(linear), kByteStep);
            }
        }
    }
}

TEST_F(Pictures, AlphaIsTheShareOfSamplesThatShowGeometry) {
    const Picture picture =
        draw("stage", ".exr", {"--size", "160x90", "--background", "0.25,0.5,2"});
    std::map<float, int> alphas;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const float* const sample = picture.at(x, y);
            ++alphas[sample[3]];
            if (sample[3] == 0.0f) {
                ASSERT_EQ(sample[0], 0.25f);
                ASSERT_EQ(sample[1], 0.5f);
                ASSERT_EQ(sample[2], 2.0f);
            }
        }
    }
    EXPECT_EQ(alphas.size(), 5u);
    for (const float alpha : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) EXPECT_GT(alphas[alpha], 0) << alpha;
}

TEST_F(Pictures, AFlatWallShowsItsExactNormal) {
    const Picture picture = draw_frontal("quadrants", ".exr", "normal");
    for_each_point(picture, 0.99, 0.99, [](dvec2, const float* sample) {
        ASSERT_NEAR(sample[0], 0.5, 1e-6);
        ASSERT_NEAR(sample[1], 0.5, 1e-6);
        ASSERT_NEAR(sample[2], 1.0, 1e-6);
    });
}

/// The plate's left half is the right half's mirror image, and so are its bumps, whose slopes are
/// multiplied by `strength`.
void expect_bumps(const Picture& picture, double tolerance, double strength = 1.0) {
    double largest = 0.0;
    for_each_point(picture, 1.9, 0.95, [&](dvec2 point, const float* sample) {
        if (std::abs(point.x) < 0.03) return;
        const double side = point.x > 0.0 ? 1.0 : -1.0;
        const auto normal = bump_normal(std::abs(point.x) / 2.0, (point.y + 1.0) / 2.0);
        const dvec3 shown(2.0 * sample[0] - 1.0, 2.0 * sample[1] - 1.0, 2.0 * sample[2] - 1.0);
        const dvec3 truth =
            glm::normalize(dvec3(side * strength * normal[0], strength * normal[1], normal[2]));
        largest = std::max(largest, glm::length(shown - truth));
    });
    fmt::print("largest error of a normal: {:.4f}\n", largest);
    EXPECT_LT(largest, tolerance);
}

TEST_F(Pictures, NormalMapsShowTheNormalsOfTheirHeightField) {
    // An 8-bit normal is off by up to sqrt(3) / 255, and filtering cuts curvature.
    expect_bumps(draw_frontal("plate", ".exr", "normal"), 0.03);
}

TEST_F(Pictures, NormalStrengthMultipliesTheSlopes) {
    for (const std::string strength : {"0.5", "2"}) {
        const double factor = std::stod(strength);
        expect_bumps(draw_frontal("plate", ".exr", "normal", {"--normal-strength", strength}),
                     0.03 * std::max(1.0, factor), factor);
    }
    const Options seen{"--size", "160x90", "--samples", "1"};
    Options flat = seen, without = seen;
    flat.insert(flat.end(), {"--normal-strength", "0"});
    without.push_back("--no-normal-map");
    EXPECT_LE(largest_difference(draw("stage", ".exr", flat), draw("stage", ".exr", without)),
              1e-5);
}

TEST_F(Pictures, RoughnessAndMetalnessCanBeOneForEveryMaterial) {
    for (const std::string view : {"roughness", "metalness"}) {
        const Options size{"--size", "160x90", "--samples", "1", "--view", view};
        Options overridden = size;
        overridden.insert(overridden.end(), {"--" + view, "0.375"});
        const Picture own = draw("stage", ".exr", size);
        const Picture one = draw("stage", ".exr", overridden);
        int geometry = 0, changed = 0;
        for (int y = 0; y < one.height; ++y) {
            for (int x = 0; x < one.width; ++x) {
                if (one.at(x, y)[3] == 0.0f) continue;
                ASSERT_EQ(one.at(x, y)[0], 0.375f) << view;
                ++geometry;
                changed += own.at(x, y)[0] != 0.375f;
            }
        }
        EXPECT_GT(geometry, 1000) << view;
        EXPECT_GT(changed, 1000) << view;
    }
}

TEST_F(Pictures, HeightMapsShowTheNormalsOfTheirHeightField) {
    // A step of 1/255 between two texels that are two apart is a slope of 16.64 / 255 / 2 = 0.033.
    expect_bumps(draw_frontal("heights", ".exr", "normal"), 0.07);
}

TEST_F(Pictures, MirroredHalvesAreLitAsMirrorImages) {
    for (const std::string scene : {"plate", "heights"}) {
        for (const std::string samples : {"1", "4"}) {
            const Picture picture = draw_frontal(
                scene, ".png", "shaded", {"--light-position", "0,1.5,1.5", "--samples", samples});
            Picture mirrored = picture;
            for (int y = 0; y < picture.height; ++y) {
                for (int x = 0; x < picture.width; ++x) {
                    std::copy_n(picture.at(picture.width - 1 - x, y), 3, mirrored.at(x, y));
                }
            }
            EXPECT_LE(largest_difference(picture, mirrored), 2.0 * kByteStep) << scene;
        }
    }
}

TEST_F(Pictures, BumpsAreBrightTowardsTheLightAndDentsAway) {
    const dvec3 light(3.0, 3.0, 2.0);
    for (const std::string scene : {"plate", "heights"}) {
        const Picture picture =
            draw_frontal(scene, ".exr", "shaded",
                         {"--light-position", fmt::format("{},{},{}", light.x, light.y, light.z)});
        const auto brightness = [&](dvec2 where) {
            double sum = 0.0;
            for_each_point(picture, 1.9, 0.95, [&](dvec2 point, const float* sample) {
                if (glm::length(point - where) < 0.05) sum += sample[1];
            });
            return sum;
        };
        for (const Bump& bump : kBumps) {
            for (const double side : {-1.0, 1.0}) {
                const dvec2 center(side * 2.0 * bump.u, 2.0 * bump.v - 1.0);
                const dvec2 step = bump.radius * glm::normalize(dvec2(light) - center);
                const double towards = brightness(center + step);
                const double away = brightness(center - step);
                EXPECT_EQ(towards > away, bump.height > 0.0)
                    << scene << " at " << center.x << ' ' << center.y;
            }
        }
    }
}

TEST_F(Pictures, MasksCutWhatTheyShow) {
    const Picture cut = draw_frontal("leaf", ".exr", "shaded");
    int wrong = 0;
    for_each_point(cut, 0.99, 0.99, [&](dvec2 point, const float* sample) {
        const dvec2 uv = 0.5 * (point + 1.0);
        // Within a texel of its edge the mask is filtered.
        const double texel = 1.0 / 128.0;
        const bool inside = in_leaf(uv.x, uv.y);
        for (const double dx : {-texel, texel}) {
            for (const double dy : {-texel, texel}) {
                if (in_leaf(uv.x + dx, uv.y + dy) != inside) return;
            }
        }
        if (sample[3] != (inside ? 1.0f : 0.0f)) ++wrong;
    });
    EXPECT_EQ(wrong, 0);
    const Picture whole = draw_frontal("leaf", ".exr", "shaded", {"--no-alpha-mask"});
    for_each_point(whole, 0.99, 0.99,
                   [](dvec2, const float* sample) { ASSERT_EQ(sample[3], 1.0f); });
}

TEST_F(Pictures, ALightOnTheSurfaceShinesStraightDownOnThatPoint) {
    // Seen from so near that the positions of many pixels round to the light's.
    const TemporaryFolder folder;
    std::ofstream(folder / "near.obj") << "v 15 15 0\nv 17 15 0\nv 17 17 0\nv 15 17 0\nf 1 2 3 4\n";
    const auto scene = bake_scene(folder / "near.obj", {"--positions", "f32"});
    const auto draw_view = [&](const std::string& view) {
        return draw_scene(
            scene, ".exr",
            {"--view", view, "--size", "64x64", "--samples", "1", "--fov", "1", "--camera-position",
             "16,16,0.0005", "--camera-target", "16,16,0", "--light-position", "16,16,0"});
    };
    const Picture direction = draw_view("light-direction");
    int straight_down = 0;
    for (std::size_t i = 0; i < direction.samples.size(); i += 4) {
        const float* const sample = &direction.samples[i];
        straight_down += sample[0] == 0.5f && sample[1] == 0.5f && sample[2] == 1.0f;
    }
    EXPECT_GT(straight_down, 0);
    const Picture shaded = draw_view("shaded");
    for (const float sample : shaded.samples) ASSERT_TRUE(std::isfinite(sample));
}

TEST_F(Pictures, TheLightTurnsAboutZThroughTheCentre) {
    // The plate's centre is the origin.
    const dvec3 start(1.0, 0.5, 2.0);
    const double time = 2.5;
    const dvec3 turned(std::cos(time) * start.x - std::sin(time) * start.y,
                       std::sin(time) * start.x + std::cos(time) * start.y, start.z);
    const auto text = [](const dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    const Picture orbited = draw_frontal("plate", ".exr", "light-direction",
                                         {"--light-position", text(start), "--time", "2.5"});
    const Picture placed =
        draw_frontal("plate", ".exr", "light-direction", {"--light-position", text(turned)});
    EXPECT_LE(largest_difference(orbited, placed), 1e-6);
}

/// Four radii of the plate's bounding sphere from its centre, the origin, along 0.75 v + 0.55 u -
/// 0.45 r, as an option.
std::string over_left_shoulder(const dvec3& v, const dvec3& u, const dvec3& r) {
    const dvec3 light = 4.0 * std::sqrt(5.0) * glm::normalize(0.75 * v + 0.55 * u - 0.45 * r);
    return fmt::format("{},{},{}", light.x, light.y, light.z);
}

TEST_F(Pictures, TheDefaultLightIsOverTheLeftShoulderOfTheCamera) {
    const dvec3 v = glm::normalize(dvec3(1.0, 0.5, 1.0));
    const dvec3 r = glm::normalize(glm::cross(dvec3(0.0, 1.0, 0.0), v));
    const struct {
        Options camera;
        std::string light;
    } table[] = {
        {{}, over_left_shoulder(v, glm::cross(v, r), r)},
        {{"--camera-position", "0,0,2", "--camera-target", "0,0,0"},
         over_left_shoulder({0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0})},
        {{"--camera-position", "0,5,0", "--camera-target", "0,0,0"},
         over_left_shoulder({0.0, 1.0, 0.0}, {0.0, 0.0, -1.0}, {1.0, 0.0, 0.0})},
    };
    for (const auto& [camera, light] : table) {
        Options options{"--view", "light-direction", "--size", "160x90", "--samples", "1"};
        options.insert(options.end(), camera.begin(), camera.end());
        const Picture by_default = draw("plate", ".exr", options);
        options.insert(options.end(), {"--light-position", light});
        EXPECT_LE(largest_difference(by_default, draw("plate", ".exr", options)), 1e-6) << light;
    }
}

TEST_F(Pictures, WhitePaperThatFacesTheLightIsWhite) {
    const TemporaryFolder folder;
    std::ofstream(folder / "paper.mtl") << "newmtl paper\nKd 1 1 1\nPr 1\n";
    std::ofstream(folder / "paper.obj") << "mtllib paper.mtl\nusemtl paper\nv -1 -1 0\nv 1 -1 0\n"
                                           "v 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    const auto scene = bake_scene(folder / "paper.obj");
    const auto middle = [&](const std::string& extension, Options options) {
        options.insert(options.end(),
                       {"--size", "33x33", "--samples", "1", "--camera-position", "0,0,3",
                        "--camera-target", "0,0,0", "--light-position", "0,0,9"});
        return double{draw_scene(scene, extension, options).at(16, 16)[1]};
    };
    EXPECT_EQ(middle(".png", {}), 1.0);
    // 0.96 of the light is left for the diffuse term, 1 / 100 of it shines: D = 1 / pi, F = 0.04.
    const double lit = 0.96 / M_PI + 0.01 / M_PI;
    EXPECT_NEAR(middle(".exr", {"--ambient", "0,0,0"}), lit, 1e-5);
    EXPECT_NEAR(middle(".png", {"--ambient", "0,0,0", "--exposure", "0"}), srgb_of_linear(lit),
                kByteStep);
    EXPECT_NEAR(middle(".png", {"--ambient", "0,0,0", "--light-color", "0.5,0.5,0.5"}),
                srgb_of_linear(0.5 * M_PI * lit), kByteStep);
    // No other view is brightened.
    EXPECT_NEAR(middle(".png", {"--view", "diffuse"}), srgb_of_linear(0.96 / M_PI), kByteStep);
}

TEST_F(Pictures, TheDefaultCameraSeesTheWholeSceneFromTheSide) {
    for (const std::string size : {"161x91", "91x161"}) {
        const Picture picture =
            draw("plate", ".exr", {"--view", "view-direction", "--samples", "1", "--size", size});
        int border = 0;
        for (int y = 0; y < picture.height; ++y) {
            for (int x = 0; x < picture.width; ++x) {
                const bool at_border =
                    x == 0 || y == 0 || x == picture.width - 1 || y == picture.height - 1;
                if (at_border && picture.at(x, y)[3] != 0.0f) ++border;
            }
        }
        EXPECT_EQ(border, 0);
        const float* const middle = picture.at(picture.width / 2, picture.height / 2);
        EXPECT_EQ(middle[3], 1.0f);
        const dvec3 direction = glm::normalize(dvec3(1.0, 0.5, 1.0));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(middle[c], 0.5 * direction[c] + 0.5, 1e-4);
    }
}

TEST_F(Pictures, AnySizeGivesTheSamePicture) {
    const TemporaryFolder folder;
    const auto draw_scaled = [&](double scale) {
        const std::string name = fmt::format("scaled_{}.obj", scale);
        {
            std::ofstream obj(folder / name);
            for (const dvec3 corner :
                 {dvec3(-1.0, 0.0, -1.0), dvec3(1.0, 0.0, -1.0), dvec3(1.0, 0.0, 1.0),
                  dvec3(-1.0, 0.0, 1.0), dvec3(0.3, 1.5, 0.1)}) {
                obj << fmt::format("v {} {} {}\n", scale * corner.x, scale * corner.y,
                                   scale * corner.z);
            }
            obj << "f 4 3 2 1\nf 1 5 4\nf 4 5 3\nf 3 5 2\nf 2 5 1\n";
        }
        return draw_scene(bake_scene(folder / name), ".exr",
                          {"--size", "160x120", "--samples", "1"});
    };
    const Picture plain = draw_scaled(1.0);
    int surfaces = 0;
    for (std::size_t i = 3; i < plain.samples.size(); i += 4) surfaces += plain.samples[i] == 1.0f;
    EXPECT_GT(surfaces, 2000);
    for (const int power : {-40, -23, 25, 40}) {  // 1e-12 to 1e12
        EXPECT_LE(largest_difference(plain, draw_scaled(std::exp2(power))), 1e-5) << power;
    }
}

}  // namespace
