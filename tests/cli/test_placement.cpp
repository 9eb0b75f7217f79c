// Where a scene lies and how large it is changes nothing about its picture.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/scene_folder.h"

namespace {

using nlohmann::json;

constexpr int kGrid = 12;

/// Hills of an extent of about `size`, moved by (x, y, z), as the text of an OBJ.
std::string hills(double x, double y, double z, double size) {
    std::string text;
    char line[160];
    for (int j = 0; j <= kGrid; ++j) {
        for (int i = 0; i <= kGrid; ++i) {
            const double u = double(i) / kGrid, w = double(j) / kGrid;
            const double height = 0.15 * std::sin(7.0 * u) * std::cos(5.0 * w);
            std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", x + size * u,
                          y + size * height, z + size * w);
            text += line;
        }
    }
    for (int j = 0; j < kGrid; ++j) {
        for (int i = 0; i < kGrid; ++i) {
            const int a = j * (kGrid + 1) + i + 1, b = a + kGrid + 1;
            std::snprintf(line, sizeof line, "f %d %d %d %d\n", a, b, b + 1, a + 1);
            text += line;
        }
    }
    return text;
}

class Placement : public SceneFolder {
 protected:
    Picture draw(const std::string& scene, std::vector<std::string> options) {
        options.insert(options.begin(), {CW2_PROGRAM, scene, "--output", "picture.png", "--size",
                                         "240x160", "--samples", "1", "--validation"});
        const Outcome outcome = run(options, {{}, folder_.path()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return read_picture(here("picture.png"));
    }

    /// The tolerance of golden pictures.
    static void expect_same(const Picture& a, const Picture& b) {
        ASSERT_EQ(a.samples.size(), b.samples.size());
        const auto channels = static_cast<std::size_t>(a.channels);
        std::size_t beyond = 0;
        bool empty = true;
        for (std::size_t i = 0; i < a.samples.size(); i += channels) {
            float worst = 0.0f;
            for (std::size_t k = i; k < i + channels; ++k) {
                worst = std::max(worst, std::abs(a.samples[k] - b.samples[k]));
                empty &= a.samples[k] == a.samples[k % channels];
            }
            beyond += worst > 0.02f;
        }
        EXPECT_FALSE(empty);
        EXPECT_LE(static_cast<double>(beyond),
                  0.001 * static_cast<double>(a.samples.size() / channels));
    }
};

TEST_F(Placement, ASceneInAMapsCoordinatesLooksLikeItsLocalTwin) {
    write("local.obj", hills(0, 0, 0, 1.0));
    write("far.obj", hills(500'000.125, 120.5, 4'600'000.25, 1.0));
    bake_well({"local.obj"});
    bake_well({"far.obj"});
    expect_same(draw("local.cw2mesh", {}), draw("far.cw2mesh", {}));
    // Camera and light are stated in the scene's own coordinates.
    expect_same(draw("local.cw2mesh", {"--camera-position", "1.5,0.75,-0.25", "--camera-target",
                                       "0.5,0,0.5", "--light-position", "-1,2,1"}),
                draw("far.cw2mesh", {"--camera-position", "500001.625,121.25,4600000",
                                     "--camera-target", "500000.625,120.5,4600000.75",
                                     "--light-position", "499999.125,122.5,4600001.25"}));
}

TEST_F(Placement, ANodeFarAwayLooksLikeItsLocalTwin) {
    write("local.obj", hills(0, 0, 0, 1.0));
    bake_well({"local.obj", "-o", "local.gltf"});
    json gltf = json::parse(read("local.gltf"));
    gltf["nodes"][0]["translation"] = {500'000.123, 4'600'000.457, -17.25};
    write("far.gltf", gltf.dump());
    bake_well({"local.gltf"});
    bake_well({"far.gltf"});
    expect_same(draw("local.cw2mesh", {}), draw("far.cw2mesh", {}));
    // And once more through a file of its own.
    bake_well({"far.cw2mesh", "-o", "again.glb"});
    bake_well({"again.glb"});
    expect_same(draw("local.cw2mesh", {}), draw("again.cw2mesh", {}));
    const auto low = [&](const char* file) {
        const json inspected = json::parse(bake({"--inspect", file, "--json"}).out);
        return inspected["origin"][1].get<double>() + inspected["bounds_min"][1].get<double>();
    };
    EXPECT_NEAR(low("again.cw2mesh"), low("far.cw2mesh"), 1e-4);
}

TEST_F(Placement, ATurnToYUpTurnsTheOrigin) {
    write("far.obj", hills(500'000.0, -4'600'000.0, 100.0, 1.0));
    bake_well({"far.obj", "--up", "z"});
    const Outcome outcome = bake({"--inspect", "far.cw2mesh", "--json"});
    const json inspected = json::parse(outcome.out);
    ASSERT_TRUE(inspected.contains("origin")) << outcome.out;
    const std::vector<double> origin = inspected["origin"];
    const std::vector<double> low = inspected["bounds_min"], high = inspected["bounds_max"];
    EXPECT_NEAR(origin[0] + low[0], 500'000.0, 1e-4);
    EXPECT_NEAR(origin[1] + low[1], 100.0, 1e-4);
    EXPECT_NEAR(origin[2] + high[2], 4'600'000.0, 0.2);
}

TEST_F(Placement, AnyFiniteSizeFillsThePicture) {
    write("one.obj", hills(0, 0, 0, 1.0));
    bake_well({"one.obj"});
    const Picture one = draw("one.cw2mesh", {});
    for (const char* size : {"1e-12", "1e-5", "4e7", "1e12"}) {
        SCOPED_TRACE(size);
        write("sized.obj", hills(0, 0, 0, std::stod(size)));
        bake_well({"sized.obj"});
        expect_same(one, draw("sized.cw2mesh", {}));
    }
}

}  // namespace
