// The numbers that a click on the picture reads are those of the views at the same pixel.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "cw2/render/picker.h"
#include "tests/render/drawing.h"
#include "tests/render/loaded_scene.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace {

using Words = std::vector<std::string>;
using glm::vec3;

constexpr int kWidth = 160, kHeight = 90;

/// Picks with the settings that words of the command line say.
class Reader : public LoadedScene {
 public:
    Reader(const std::filesystem::path& path, const Words& words)
        : LoadedScene(path, words, {kWidth, kHeight}) {}

    std::optional<cw2::Pick> pick(int x, int y) {
        return picker_.pick(scene(), settings(), {kWidth, kHeight}, glm::uvec2(x, y));
    }

 private:
    cw2::Picker picker_{device(), layouts(), cw2::built_in_shaders()};
};

Words with_size(Words words) {
    words.insert(words.end(), {"--size", fmt::format("{}x{}", kWidth, kHeight)});
    return words;
}

class Picker : public testing::Test {
 protected:
    std::filesystem::path stage() {
        make_test_scenes(folder_.path());
        return bake_scene(folder_ / "stage.obj");
    }

    /// A wall in the plane z = 0, seen from (0, 0, 2): red and rough left of x = 0, white metal
    /// right of it; nothing beyond |x| = 1.
    std::filesystem::path wall() {
        std::ofstream(folder_ / "wall.mtl") << "newmtl left half\nKd 0.5 0.1 0.1\nPr 0.75\n"
                                               "newmtl right\nKd 1 1 1\nPr 0.25\nPm 1\n";
        std::ofstream(folder_ / "wall.obj")
            << "mtllib wall.mtl\nv -1 -1 0\nv 0 -1 0\nv 1 -1 0\nv -1 1 0\nv 0 1 0\nv 1 1 0\n"
               "vn 0 0 1\nusemtl left half\nf 1//1 2//1 5//1 4//1\n"
               "usemtl right\nf 2//1 3//1 6//1 5//1\n";
        return bake_scene(folder_ / "wall.obj");
    }

    TemporaryFolder folder_;
};

float as_color(float direction) {
    return 0.5f * direction + 0.5f;
}

/// What the view of that name shows where `pick` was read.
vec3 shown(const cw2::Pick& pick, const std::string& view) {
    const auto color = [](const vec3& v) {
        return vec3(as_color(v.x), as_color(v.y), as_color(v.z));
    };
    if (view == "normal") return color(pick.normal);
    if (view == "light-direction") return color(pick.to_light);
    if (view == "view-direction") return color(pick.to_camera);
    if (view == "base-color") return pick.base_color;
    if (view == "vertex-color") return pick.vertex_color;
    if (view == "emission") return pick.emission;
    if (view == "roughness") return vec3(pick.roughness);
    if (view == "metalness") return vec3(pick.metalness);
    if (view == "distribution") return vec3(pick.distribution);
    if (view == "masking") return vec3(pick.masking);
    if (view == "fresnel") return pick.fresnel;
    if (view == "diffuse") return pick.diffuse;
    if (view == "specular") return pick.specular;
    return pick.shaded;
}

void expect_numbers_of_views(const std::filesystem::path& scene, const Words& words) {
    Reader reader(scene, words);
    std::mt19937 random(4);
    std::vector<glm::ivec2> pixels;
    for (int i = 0; i < 60; ++i) pixels.emplace_back(random() % kWidth, random() % kHeight);
    std::vector<std::optional<cw2::Pick>> picks;
    for (const glm::ivec2& pixel : pixels) picks.push_back(reader.pick(pixel.x, pixel.y));
    int surfaces = 0;
    for (const std::string view :
         {"shaded", "normal", "light-direction", "view-direction", "base-color", "vertex-color",
          "emission", "roughness", "metalness", "distribution", "masking", "fresnel", "diffuse",
          "specular"}) {
        Words options = with_size(words);
        options.insert(options.end(), {"--samples", "1", "--view", view});
        const Picture picture = draw_scene(scene, ".exr", options);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const float* const sample = picture.at(pixels[i].x, pixels[i].y);
            ASSERT_EQ(picks[i].has_value(), sample[3] == 1.0f);
            if (!picks[i]) continue;
            ++surfaces;
            const vec3 value = shown(*picks[i], view);
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(value[c], sample[c], 1e-3f * std::max(1.0f, std::abs(sample[c])))
                    << view << " at " << pixels[i].x << ' ' << pixels[i].y;
            }
        }
    }
    EXPECT_GT(surfaces, 14 * 20);
}

TEST_F(Picker, ReadsWhatTheViewsShowAtTheSamePixel) {
    const std::filesystem::path scene = stage();
    const Words camera{"--camera-position", "0.3,1.6,4.3", "--camera-target",
                       "0,0.75,0",          "--fov",       "42",
                       "--light-position",  "2.5,3.5,3"};
    expect_numbers_of_views(scene, camera);
    // The same overrides, light and switches as the picture's.
    Words other = camera;
    other.insert(other.end(), {"--time", "0.6", "--light-color", "3,2,1", "--roughness", "0.3",
                               "--normal-strength", "1.7", "--no-alpha-mask"});
    expect_numbers_of_views(scene, other);
}

TEST_F(Picker, KnowsEmissionAndVertexColors) {
    std::ofstream(folder_ / "lamp.mtl") << "newmtl lamp\nKd 1 0.5 1\nKe 4 0.25 0\nPr 0.5\n";
    std::ofstream(folder_ / "lamp.obj")
        << "mtllib lamp.mtl\nv -2 -2 0 1 0 0\nv 2 -2 0 1 1 1\nv 2 2 0 0 0 1\nv -2 2 0 0.2 0.2 0.2\n"
           "vn 0 0 1\nusemtl lamp\nf 1//1 2//1 3//1 4//1\n";
    const std::filesystem::path scene = bake_scene(folder_ / "lamp.obj");
    const Words camera{"--camera-position", "0.1,0.2,2", "--camera-target", "0,0,0"};
    expect_numbers_of_views(scene, camera);
    const auto pick = Reader(scene, camera).pick(80, 45);
    ASSERT_TRUE(pick);
    EXPECT_EQ(pick->emission, vec3(4.0f, 0.25f, 0.0f));
    EXPECT_FALSE(pick->unlit);
    EXPECT_LT(pick->vertex_color.g, 0.9f);
    EXPECT_NEAR(pick->base_color.g, 0.5f * pick->vertex_color.g, 1e-6f);
}

TEST_F(Picker, LeavesOutWhatIsDoneForTheEye) {
    const std::filesystem::path scene = wall();
    Reader plain(scene, {"--camera-position", "0,0,2", "--camera-target", "0,0,0"});
    Reader adapted(scene, {"--camera-position", "0,0,2", "--camera-target", "0,0,0", "--exposure",
                           "3", "--false-color", "auto", "--split", "normal,uv"});
    const auto a = plain.pick(100, 50), b = adapted.pick(100, 50);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->shaded, b->shaded);
    EXPECT_EQ(a->roughness, b->roughness);
}

TEST_F(Picker, ReadsTheSideOfASplitThatThePixelIsOn) {
    const std::filesystem::path scene = stage();
    const Words camera{"--camera-position", "0.3,1.6,4.3", "--camera-target", "0,0.75,0"};
    const auto with = [&](const Words& more) {
        Words words = camera;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    Reader mapped(scene, camera), flat(scene, with({"--no-normal-map"}));
    Reader split(scene, with({"--split", "shaded:no-normal-map,shaded", "--divider", "0.5"}));
    int bumps[2] = {};
    for (int y = 5; y < kHeight; y += 10) {
        for (const int x : {10, 40, 70, kWidth / 2 - 1, kWidth / 2, 90, 120, 150}) {
            const bool is_right = x >= kWidth / 2;
            const auto a = mapped.pick(x, y), b = flat.pick(x, y), c = split.pick(x, y);
            if (!a || !b || !c) continue;
            EXPECT_EQ(c->normal, is_right ? a->normal : b->normal) << x << ' ' << y;
            bumps[is_right] += a->normal != b->normal;
        }
    }
    EXPECT_GT(bumps[0], 3);
    EXPECT_GT(bumps[1], 3);
}

TEST_F(Picker, KnowsPlaceAndMaterial) {
    Reader reader(wall(), {"--camera-position", "0,0,2", "--camera-target", "0,0,0"});
    const float size = 4.0f * std::tan(static_cast<float>(M_PI) / 6.0f) / kHeight;
    int surfaces = 0, backgrounds = 0;
    for (int y = 2; y < kHeight; y += 7) {
        for (int x = 1; x < kWidth; x += 5) {
            const vec3 truth((static_cast<float>(x) + 0.5f - 0.5f * kWidth) * size,
                             (0.5f * kHeight - static_cast<float>(y) - 0.5f) * size, 0.0f);
            const auto pick = reader.pick(x, y);
            const bool hits = std::abs(truth.x) < 1.0f && std::abs(truth.y) < 1.0f;
            ASSERT_EQ(pick.has_value(), hits) << x << ' ' << y;
            ++(hits ? surfaces : backgrounds);
            if (!hits) continue;
            // Positions are stored on a lattice.
            EXPECT_LT(glm::distance(vec3(pick->position), truth), 1e-3f) << x << ' ' << y;
            EXPECT_EQ(reader.scene().material_names()[pick->material],
                      truth.x < 0.0f ? "left half" : "right");
            EXPECT_NEAR(pick->roughness, truth.x < 0.0f ? 0.75f : 0.25f, 1e-6f);
            const vec3 l = glm::normalize(reader.settings().light.position - truth);
            const vec3 v = glm::normalize(vec3(0.0f, 0.0f, 2.0f) - truth);
            EXPECT_NEAR(pick->n_dot_l(), l.z, 1e-3f);
            EXPECT_NEAR(pick->n_dot_v(), v.z, 1e-3f);
            EXPECT_NEAR(pick->n_dot_h(), glm::normalize(l + v).z, 1e-3f);
            EXPECT_NEAR(pick->v_dot_h(), glm::dot(v, glm::normalize(l + v)), 1e-3f);
        }
    }
    EXPECT_GT(surfaces, 100);
    EXPECT_GT(backgrounds, 100);
}

/// What --pixel prints.
nlohmann::json printed(const std::filesystem::path& scene, const Words& words, int x, int y) {
    Words command{CW2_PROGRAM, scene, "--validation", "--pixel", fmt::format("{},{}", x, y)};
    for (const std::string& word : with_size(words)) command.push_back(word);
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    return nlohmann::json::parse(outcome.out);
}

TEST_F(Picker, PixelPrintsTheNumbersOfTheViews) {
    const std::filesystem::path scene = stage();
    const Words camera{"--camera-position", "0.3,1.6,4.3", "--camera-target", "0,0.75,0",
                       "--light-color",     "3,2,1",       "--time",          "0.6"};
    const glm::ivec2 places[] = {{80, 70}, {40, 80}, {120, 60}};
    std::vector<nlohmann::json> pixels;
    for (const glm::ivec2& place : places) {
        pixels.push_back(printed(scene, camera, place.x, place.y));
        EXPECT_EQ(pixels.back()["pixel"], nlohmann::json({place.x, place.y}));
        ASSERT_TRUE(pixels.back()["material"].is_string());
        const auto normal = pixels.back()["normal"];
        EXPECT_NEAR(
            std::hypot(normal[0].get<double>(), normal[1].get<double>(), normal[2].get<double>()),
            1.0, 1e-6);
    }
    for (const auto& [view, key] : {std::pair{"shaded", "shaded"},
                                    {"base-color", "base_color"},
                                    {"vertex-color", "vertex_color"},
                                    {"emission", "emission"},
                                    {"specular", "specular"},
                                    {"fresnel", "fresnel"}}) {
        Words options = with_size(camera);
        options.insert(options.end(), {"--samples", "1", "--view", view});
        const Picture picture = draw_scene(scene, ".exr", options);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const float* const sample = picture.at(places[i].x, places[i].y);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(pixels[i][key][c].get<float>(), sample[c],
                            1e-3f * std::max(1.0f, std::abs(sample[c])))
                    << view;
            }
        }
    }
    // Nothing but the pixel is known of the background.
    const nlohmann::json background = printed(scene, camera, 2, 2);
    EXPECT_EQ(background, nlohmann::json({{"pixel", {2, 2}}, {"material", nullptr}}));
}

TEST_F(Picker, PixelIsThatOfThePictureWrittenBesideIt) {
    const std::filesystem::path scene = wall();
    const std::filesystem::path picture = folder_ / "beside.png";
    const Outcome outcome =
        run({CW2_PROGRAM, scene, "--pixel", "10,45", "--size", "160x90", "--camera-position",
             "0,0,1", "--camera-target", "0,0,0", "--output", picture});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["material"], "left half");
    EXPECT_TRUE(std::filesystem::exists(picture));
}

}  // namespace
