// What a material's emission, a mesh's colours and the absence of light show, pixel by pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/render/drawing.h"
#include "tests/render/known_textures.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/process.h"
#include "tests/support/srgb_truth.h"
#include "tests/support/temporary_folder.h"

namespace {

using Options = std::vector<std::string>;

/// What a file holds of a vertex colour's channel.
double stored(double linear) {
    return linear_of_srgb(std::round(255.0 * srgb_of_linear(linear)) / 255.0);
}

/// The square from (-1, -1, 0) to (1, 1, 0), which fills the picture.
Picture draw_square(const std::filesystem::path& scene, const std::string& view,
                    Options options = {}) {
    const Options frontal{"--view",
                          view,
                          "--size",
                          "121x121",
                          "--samples",
                          "1",
                          "--fov",
                          "90",
                          "--camera-position",
                          "0,0,1",
                          "--camera-target",
                          "0,0,0"};
    options.insert(options.end(), frontal.begin(), frontal.end());
    return draw_scene(scene, ".exr", options);
}

/// Calls `look` with u and v of a pixel's centre and its samples.
template <typename Look>
void for_each_point(const Picture& picture, Look look) {
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            look((x + 0.5) / picture.width, 1.0 - (y + 0.5) / picture.height, picture.at(x, y));
        }
    }
}

/// Whether filtering may mix texels here: near an edge of the leaf, of a quarter, or of the image.
bool at_an_edge(double u, double v) {
    if (std::abs(u - 0.5) < 0.02 || std::abs(v - 0.5) < 0.02) return true;
    if (std::max(std::abs(u - 0.5), std::abs(v - 0.5)) > 0.48) return true;
    for (const double du : {-0.02, 0.0, 0.02}) {
        for (const double dv : {-0.02, 0.0, 0.02}) {
            if (in_leaf(u + du, v + dv) != in_leaf(u, v)) return true;
        }
    }
    return false;
}

class Materials : public testing::Test {
 protected:
    std::filesystem::path screen() {
        make_test_scenes(folder_.path());
        return bake_scene(folder_ / "screen.obj");
    }

    /// The leaf, its alpha a mask, with vertex colours: kLeft on the left, kRight on the right.
    std::filesystem::path colored_leaf(bool unlit) {
        screen();
        GltfWriter gltf = square_gltf();
        std::vector<float> colors;
        for (const auto* const color : {&kLeft, &kRight, &kRight, &kLeft}) {
            for (const float channel : *color) colors.push_back(channel);
        }
        gltf.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
            gltf.accessor<float>(colors, kFloat, "VEC4");
        gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
        gltf.root["images"] = {{{"uri", "leaf.png"}}};
        gltf.root["textures"] = {{{"source", 0}}};
        gltf.root["materials"] = {
            {{"alphaMode", "MASK"},
             {"pbrMetallicRoughness",
              {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}}};
        if (unlit) {
            gltf.root["materials"][0]["extensions"]["KHR_materials_unlit"] =
                nlohmann::json::object();
            gltf.root["extensionsUsed"] = {"KHR_materials_unlit"};
        }
        gltf.write_glb(folder_ / "leaf.glb");
        return bake_scene(folder_ / "leaf.glb");
    }

    static constexpr std::array<float, 4> kLeft{0.2f, 0.5f, 1.0f, 0.0f};  ///< linear
    static constexpr std::array<float, 4> kRight{1.0f, 0.02f, 0.3f, 1.0f};

    TemporaryFolder folder_;
};

TEST_F(Materials, EmissionIsFactorTimesMapWhereTheMaskLeavesIt) {
    constexpr double kFactor[] = {2.0, 1.0, 0.25};
    const std::filesystem::path scene = screen();
    const auto expect_emission = [&](const std::string& view, const Options& options, double scale,
                                     bool masked) {
        int seen = 0;
        const Picture picture = draw_square(scene, view, options);
        for_each_point(picture, [&](double u, double v, const float* sample) {
            if (at_an_edge(u, v)) return;
            const bool covered = !masked || in_leaf(u, v);
            ASSERT_EQ(sample[3], covered ? 1.0f : 0.0f) << view << ' ' << u << ' ' << v;
            if (!covered) return;
            ++seen;
            const int* const bytes = kQuadrants[(v > 0.5 ? 2 : 0) + (u > 0.5 ? 1 : 0)];
            for (int c = 0; c < 3; ++c) {
                // Rasterisers may decode sRGB textures by polynomials.
                const double encoded = srgb_of_linear(sample[c] / (scale * kFactor[c]));
                ASSERT_NEAR(255.0 * encoded, bytes[c], 1.0) << view << ' ' << c;
            }
        });
        EXPECT_GT(seen, 2000);
    };
    expect_emission("emission", {}, 1.0, true);
    expect_emission("emission", {"--no-alpha-mask"}, 1.0, false);
    expect_emission("shaded", {"--light-color", "0,0,0", "--ambient", "0,0,0"}, 1.0 / M_PI, true);
}

TEST_F(Materials, TheMaskOfWhatEmitsIsAView) {
    const Picture picture = draw_square(screen(), "alpha-mask", {"--no-alpha-mask"});
    for_each_point(picture, [](double u, double v, const float* sample) {
        if (at_an_edge(u, v)) return;
        ASSERT_EQ(sample[0], in_leaf(u, v) ? 1.0f : 0.0f) << u << ' ' << v;
    });
}

TEST_F(Materials, VertexColorsAreInterpolatedInLinearLightAndCutByTheirAlpha) {
    const Picture picture = draw_square(colored_leaf(false), "vertex-color");
    int seen = 0;
    for_each_point(picture, [&](double u, double v, const float* sample) {
        if (at_an_edge(u, v)) return;
        // Alpha grows from 0 on the left to 1 on the right.
        const bool covered = in_leaf(u, v) && u > 0.5;
        ASSERT_EQ(sample[3], covered ? 1.0f : 0.0f) << u << ' ' << v;
        if (!covered) return;
        ++seen;
        for (std::size_t c = 0; c < 3; ++c) {
            const double left = stored(kLeft[c]), right = stored(kRight[c]);
            ASSERT_NEAR(sample[c], left + (right - left) * u, 1e-3) << u << ' ' << v << ' ' << c;
        }
    });
    EXPECT_GT(seen, 1000);
}

TEST_F(Materials, UnlitShowsItsBaseColorWhateverTheLight) {
    const std::filesystem::path scene = colored_leaf(true);
    const Picture color = draw_square(scene, "base-color");
    for (const Options& light : {Options{"--light-color", "0,0,0", "--ambient", "0,0,0"},
                                 Options{"--light-color", "9,9,9", "--ambient", "3,3,3"}}) {
        const Picture shaded = draw_square(scene, "shaded", light);
        int seen = 0;
        for (int y = 0; y < shaded.height; ++y) {
            for (int x = 0; x < shaded.width; ++x) {
                if (color.at(x, y)[3] == 0.0f) continue;
                ++seen;
                for (int c = 0; c < 3; ++c) {
                    const double truth = color.at(x, y)[c] / M_PI;
                    ASSERT_NEAR(shaded.at(x, y)[c], truth, 1e-6) << x << ' ' << y;
                }
            }
        }
        EXPECT_GT(seen, 1000);
    }
    const Outcome pixel =
        run({CW2_PROGRAM, scene, "--size", "121x121", "--fov", "90", "--camera-position", "0,0,1",
             "--camera-target", "0,0,0", "--pixel", "75,60"});
    const nlohmann::json numbers = nlohmann::json::parse(pixel.out);
    EXPECT_EQ(numbers["unlit"], true);
    EXPECT_NEAR(numbers["shaded"][0].get<double>(), color.at(75, 60)[0] / M_PI, 1e-6);
    const Picture lit = draw_square(colored_leaf(false), "shaded", {"--light-color", "9,9,9"});
    EXPECT_GT(lit.at(75, 60)[0], color.at(75, 60)[0] / M_PI + 0.01);
}

/// A ball whose faces have one UV each, in the middle of one of 8 x 8 fields of a palette; every
/// fourth has none. All maps are palettes; some faces have a mask, some emit.
std::filesystem::path palette_ball(const std::filesystem::path& folder) {
    constexpr int kFields = 8, kTexels = 16, kFaces = 24;  // a side; a field's side; a turn
    const auto palette = [&](const char* name, int channels, int seed) {
        write_picture(folder / name,
                      painted(kFields * kTexels, kFields * kTexels, channels, [&](int x, int y) {
                          const int field = x / kTexels + kFields * (y / kTexels);
                          std::vector<double> texel;
                          for (int c = 0; c < channels; ++c)
                              texel.push_back(0.5 + 0.49 * std::sin(seed + 7 * field + 2 * c));
                          return texel;
                      }));
    };
    palette("color.png", 3, 0);
    palette("rough.png", 1, 1);
    palette("metal.png", 1, 2);
    palette("glow.png", 3, 3);
    palette("mask.png", 1, 4);
    write_picture(folder / "normal.png", painted(4, 4, 3, [](int, int) {
                      return std::vector{0.6, 0.45, 0.98};
                  }));
    std::ofstream mtl(folder / "ball.mtl");
    const std::string maps =
        "map_Kd color.png\nmap_Pr rough.png\nmap_Pm metal.png\nnorm normal.png\n";
    mtl << "newmtl plain\n"
        << maps << "newmtl cut\nmap_d mask.png\n"
        << maps << "newmtl glow\nKe 1 1 1\nmap_Ke glow.png\n"
        << maps;
    std::ofstream obj(folder / "ball.obj");
    obj << "mtllib ball.mtl\n";
    const auto corner = [&](int down, int round) {
        const double polar = M_PI * down / kFaces, turn = 2.0 * M_PI * round / kFaces;
        obj << "v " << std::sin(polar) * std::cos(turn) << ' ' << std::cos(polar) << ' '
            << std::sin(polar) * std::sin(turn) << '\n';
    };
    for (int down = 2; down < kFaces - 2; ++down) {
        for (int round = 0; round < kFaces; ++round) {
            for (const int right : {0, 1}) {
                corner(down, round + right);
                corner(down + 1, round + right);
            }
            const int face = down * kFaces + round;
            obj << "vt " << (face % kFields + 0.5) / kFields << ' '
                << (face / kFields % kFields + 0.5) / kFields << "\nusemtl "
                << (face % 3 == 0   ? "plain"
                    : face % 3 == 1 ? "cut"
                                    : "glow")
                << '\n'
                << (face % 4 == 0 ? "f -4 -2 -1 -3\n" : "f -4/-1 -2/-1 -1/-1 -3/-1\n");
        }
    }
    obj.close();
    mtl.close();
    return bake_scene(folder / "ball.obj");
}

TEST_F(Materials, AnisotropyChangesNothingWhereUvsDoNot) {
    const std::filesystem::path ball = palette_ball(folder_.path());
    for (const std::string view : {"shaded", "alpha-mask"}) {
        const auto draw = [&](const std::string& anisotropy) {
            return draw_scene(ball, ".exr",
                              {"--view", view, "--size", "160x160", "--samples", "1",
                               "--anisotropy", anisotropy});
        };
        const Picture without = draw("1"), with = draw("16");
        int seen = 0;
        for (std::size_t i = 0; i < with.samples.size(); ++i) {
            const float truth = without.samples[i];
            ASSERT_NEAR(with.samples[i], truth, 1e-3 * std::max(1.0f, truth)) << view << ' ' << i;
            seen += i % 4 == 3 && truth == 1.0f;
        }
        EXPECT_GT(seen, 5000);
    }
}

}  // namespace
