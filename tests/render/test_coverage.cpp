// Foliage keeps its coverage when it shrinks: of a plane of leaves a picture shows the share that
// the mask at its full resolution shows, however far away and however slanted the plane is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/render/drawing.h"
#include "tests/render/known_textures.h"
#include "tests/render/scene_writer.h"
#include "tests/support/temporary_folder.h"

namespace {

constexpr int kSize = 256;  // texels

/// Whether the mask shows (u, v), both from 0 to 1. All masks repeat.
using Shape = std::function<bool(double u, double v)>;

struct Place {
    double u, v, size, angle;

    /// From the centre, in sizes and turned.
    glm::dvec2 inside(double x, double y) const {
        x -= u + std::round(x - u);
        y -= v + std::round(y - v);
        return glm::dvec2(std::cos(angle) * x + std::sin(angle) * y,
                          std::cos(angle) * y - std::sin(angle) * x) /
               size;
    }
};

/// Shown where `shape`, within [-0.5, 0.5] in both directions, is shown at one of `count` places.
Shape scattered(unsigned seed, int count, double smallest, double largest, double turn,
                const Shape& shape) {
    std::mt19937 random(seed);
    const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<Place> places(static_cast<std::size_t>(count));
    for (Place& place : places) {
        place = {number(), number(), smallest + (largest - smallest) * number(), turn * number()};
    }
    return [=](double u, double v) {
        return std::ranges::any_of(places, [&](const Place& place) {
            const glm::dvec2 at = place.inside(u, v);
            return std::abs(at.x) < 0.5 && std::abs(at.y) < 0.5 && shape(at.x, at.y);
        });
    };
}

/// Leaves of 20 to 51 texels.
Shape leaves() {
    return scattered(7, 40, 0.08, 0.20, 0.0,
                     [](double x, double y) { return in_leaf(x + 0.5, y + 0.5); });
}

/// Pointed blades in all directions, up to three texels wide.
Shape blades() {
    return scattered(3, 60, 0.10, 0.30, M_PI, [](double x, double y) {
        return std::abs(y) < 0.03 * (1.0 - 1.4 * std::abs(x));
    });
}

/// Rows of linked rings, as many as are hard on halving: every ring of a small level is alike.
Shape chains() {
    return [](double u, double v) {
        const double x = 8.0 * u - std::floor(8.0 * u) - 0.5;
        const double y = 8.0 * v - std::floor(8.0 * v) - 0.5;
        const double radius = std::hypot(x, y);
        return (radius > 0.3 && radius < 0.46) || (std::abs(y) < 0.07 && std::abs(x) > 0.3);
    };
}

/// With soft edges.
Picture paint(const Shape& shape) {
    return painted(kSize, kSize, 1, [&](int x, int y) {
        int inside = 0;
        for (int i = 0; i < 16; ++i) {
            inside +=
                shape((x + 0.125 + 0.25 * (i % 4)) / kSize, (y + 0.125 + 0.25 * (i / 4)) / kSize);
        }
        return std::vector{std::round(inside / 16.0 * 255.0) / 255.0};
    });
}

/// The share of the mask's area that is shown where its texels are filtered, at no loss of detail.
double true_coverage(const Picture& mask) {
    constexpr int kSamples = 8;  // each way between two texels
    int shown = 0;
    for (int y = 0; y < kSize * kSamples; ++y) {
        for (int x = 0; x < kSize * kSamples; ++x) {
            const auto texel = [&](int right, int down) {
                return *mask.at((x / kSamples + right) % kSize, (y / kSamples + down) % kSize);
            };
            const double across = (x % kSamples + 0.5) / kSamples;
            const double below = (y % kSamples + 0.5) / kSamples;
            shown += std::lerp(std::lerp(texel(0, 0), texel(1, 0), across),
                               std::lerp(texel(0, 1), texel(1, 1), across), below) >= 0.5;
        }
    }
    return shown / std::pow(kSize * kSamples, 2.0);
}

/// A plane that reaches beyond every view, one repeat a unit. It is turned about its normal, so
/// that pixels meet texels at all offsets.
std::filesystem::path bake_plane(const TemporaryFolder& folder, const Picture& mask,
                                 const std::string& mode) {
    write_picture(folder / "mask.png", mask);
    {
        constexpr double kTurn = 0.3;
        constexpr double kHalf = 200.0;
        const glm::dvec3 right(2.0 * kHalf * std::cos(kTurn), 2.0 * kHalf * std::sin(kTurn), 0.0);
        const glm::dvec3 up(-right.y, right.x, 0.0);
        SceneWriter scene(folder.path(), "plane");
        scene.material("mask", {"Kd 1 1 1", "map_d mask.png"});
        scene.quad(-0.5 * (right + up), right, up, {2.0 * kHalf, 2.0 * kHalf});
    }  // the files are whole once it is gone
    return bake_scene(folder / "plane.obj", {"--textures", mode});
}

/// The share of the plane's picture that shows it, seen from far away, `slant` degrees from its
/// normal, so that a repeat is `pixels` long where it is shortest.
double coverage(const std::filesystem::path& scene, double slant, int pixels) {
    constexpr double kView = 5.0;  // degrees: the distance is nearly the same everywhere
    const double longest = pixels / std::cos(glm::radians(slant));
    // At least ten repeats along each side, so that those which an edge cuts do not matter.
    const int size = std::max(256, static_cast<int>(10.0 * longest));
    const double distance = size / longest / (2.0 * std::tan(glm::radians(0.5 * kView)));
    const double aside = distance * std::sin(glm::radians(slant));
    const std::string side = std::to_string(size);
    const std::string position = std::to_string(0.93 * aside + 0.12) + ',' +
                                 std::to_string(0.37 * aside + 0.38) + ',' +
                                 std::to_string(distance * std::cos(glm::radians(slant)));
    const Picture picture = draw_scene(
        scene, ".exr",
        {"--view", "base-color", "--size", side + 'x' + side, "--samples", "1", "--fov",
         std::to_string(kView), "--camera-position=" + position, "--camera-target=0.12,0.38,0"});
    double sum = 0.0;
    for (std::size_t i = 3; i < picture.samples.size(); i += 4) sum += picture.samples[i];
    return sum / (static_cast<double>(size) * size);
}

/// Down to repeats of `least` pixels.
void expect_coverage(const Shape& shape, const std::string& mode, int least) {
    const Picture mask = paint(shape);
    const double truth = true_coverage(mask);
    EXPECT_GT(truth, 0.08);
    EXPECT_LT(truth, 0.6);
    const TemporaryFolder folder;
    const std::filesystem::path scene = bake_plane(folder, mask, mode);
    for (const auto& [slant, lengths] :
         {std::pair(0.0, std::vector{90, 48, 32, 22, 15, 11, 8}),
          std::pair(60.0, std::vector{22, 15, 11, 8}), std::pair(75.0, std::vector{15, 11, 8})}) {
        for (const int pixels : lengths) {
            if (pixels < least) continue;
            EXPECT_NEAR(coverage(scene, slant, pixels) / truth, 1.0, 0.05)
                << mode << ", " << pixels << " pixels a repeat, at " << slant << " degrees";
        }
    }
}

// Down to leaves of about a pixel.
TEST(Coverage, OfLeavesStaysWithinFivePercentAtEveryDistanceAndSlant) {
    expect_coverage(leaves(), "lossless", 8);
    expect_coverage(leaves(), "bc", 8);
}

// Down to blades of a fifth of a pixel; of smaller ones the 8 x 8 texels that are left keep no more
// than nine tenths.
TEST(Coverage, OfBladesStaysWithinFivePercentAtEveryDistanceAndSlant) {
    expect_coverage(blades(), "lossless", 11);
    expect_coverage(blades(), "bc", 11);
}

// Down to rings of a pixel.
TEST(Coverage, OfChainsStaysWithinFivePercentAtEveryDistanceAndSlant) {
    expect_coverage(chains(), "lossless", 8);
    expect_coverage(chains(), "bc", 8);
}

/// A plane of many repeats, seen at a grazing angle, on which the one copy of the mask is not.
TEST(Coverage, OfAClampedMaskBeyondItsEdgesIsThatOfItsEdges) {
    for (const double edge : {0.0, 1.0}) {
        const TemporaryFolder folder;
        write_picture(folder / "mask.png", painted(kSize, kSize, 1, [&](int x, int y) {
                          const bool inside = std::min(x, y) >= 16 && std::max(x, y) < kSize - 16;
                          return std::vector{inside ? 1.0 : edge};
                      }));
        {
            SceneWriter scene(folder.path(), "plane");
            scene.material("mask", {"Kd 1 1 1", "map_d -clamp on mask.png"});
            const auto corner = [](double x, double z) {
                return Corner{
                    {x, 0.0, z}, {2.0 + 0.1 * (x + 50.0), 2.0 + 0.1 * (z + 50.0)}, {0.0, 1.0, 0.0}};
            };
            scene.polygon({corner(-50, 50), corner(50, 50), corner(50, -50), corner(-50, -50)});
        }
        const std::filesystem::path scene = bake_scene(folder / "plane.obj");
        for (const char* samples : {"1", "4"}) {
            const Picture picture =
                draw_scene(scene, ".exr",
                           {"--size", "320x180", "--samples", samples, "--fov", "40",
                            "--camera-position", "0,2,60", "--camera-target", "0,0,0"});
            double shown = 0.0;
            for (std::size_t i = 3; i < picture.samples.size(); i += 4) shown += picture.samples[i];
            EXPECT_EQ(shown > 1000.0, edge == 1.0) << shown;
            EXPECT_EQ(shown > 0.0, edge == 1.0) << shown;
        }
    }
}

}  // namespace
