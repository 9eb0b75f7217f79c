// Foliage keeps its coverage when it shrinks: a far picture shows as much of it as a picture of the
// same view with so many pixels that the mask is drawn at its full resolution.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/render/drawing.h"
#include "tests/render/known_textures.h"
#include "tests/render/scene_writer.h"
#include "tests/support/temporary_folder.h"

namespace {

using Options = std::vector<std::string>;

/// Small leaves in a mask with soft edges, on a plane that reaches beyond every view.
std::filesystem::path bake_hedge(const TemporaryFolder& folder, const Options& options) {
    constexpr int kSize = 256;
    struct Leaf {
        double u, v, size;
        bool covers(double x, double y) const {
            x -= u + std::round(x - u);  // it goes on at the other side
            y -= v + std::round(y - v);
            return std::abs(x) < 0.5 * size && std::abs(y) < 0.5 * size &&
                   in_leaf(x / size + 0.5, y / size + 0.5);
        }
    };
    std::mt19937 random(7);
    const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<Leaf> leaves(40);
    for (Leaf& leaf : leaves) leaf = {number(), number(), 0.08 + 0.12 * number()};
    write_picture(folder / "leaves.png", painted(kSize, kSize, 1, [&](int x, int y) {
                      int inside = 0;
                      for (int i = 0; i < 16; ++i) {
                          const double u = (x + 0.125 + 0.25 * (i % 4)) / kSize;
                          const double v = (y + 0.125 + 0.25 * (i / 4)) / kSize;
                          inside += std::ranges::any_of(
                              leaves, [&](const Leaf& leaf) { return leaf.covers(u, v); });
                      }
                      return std::vector{inside / 16.0};
                  }));
    {
        SceneWriter scene(folder.path(), "hedge");
        scene.material("leaves", {"Kd 1 1 1", "map_d leaves.png"});
        scene.quad({-20.0, -20.0, 0.0}, {40.0, 0.0, 0.0}, {0.0, 40.0, 0.0}, {60.0, 60.0});
    }  // the files are whole once it is gone
    return bake_scene(folder / "hedge.obj", options);
}

/// The share of the picture that shows geometry.
double coverage(const std::filesystem::path& scene, int size, Options options) {
    const std::string side = std::to_string(size);
    const Options common{"--view", "base-color", "--size", side + "x" + side, "--samples", "1"};
    options.insert(options.end(), common.begin(), common.end());
    const Picture picture = draw_scene(scene, ".exr", options);
    double sum = 0.0;
    for (std::size_t i = 3; i < picture.samples.size(); i += 4) sum += picture.samples[i];
    return sum / (static_cast<double>(size) * size);
}

TEST(Coverage, OfFoliageStaysWithinAFewPercentAtEveryDistance) {
    // Three repeats fill the view, so that no edge of it counts; or it goes on to the far left.
    const Options frontal{"--camera-position", "0,0,2", "--camera-target", "0,0,0", "--fov",
                          "53.1301024"};
    const Options oblique{"--camera-position", "3,0,1.5", "--camera-target",
                          "0,0.5,0",           "--fov",   "40"};
    for (const char* mode : {"bc", "lossless"}) {
        const TemporaryFolder folder;
        const std::filesystem::path scene = bake_hedge(folder, {"--textures", mode});
        for (const auto& [view, sizes] :
             {std::pair(frontal, std::vector{384, 300, 192, 150, 96, 75}),
              std::pair(oblique, std::vector{384, 300, 192, 150})}) {
            const double truth = coverage(scene, 1536, view);
            EXPECT_GT(truth, 0.2);
            EXPECT_LT(truth, 0.6);
            // From the front 128 to 25 pixels a repeat, leaves of 25 to 2 pixels.
            for (const int size : sizes) {
                EXPECT_NEAR(coverage(scene, size, view) / truth, 1.0, 0.05)
                    << mode << ", " << size << " pixels, " << view[1];
            }
        }
    }
}

}  // namespace
