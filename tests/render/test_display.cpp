// How values become colours, exposed or false, and two sides one picture: against the EXRs of the
// same views.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "tests/render/drawing.h"
#include "tests/support/srgb_truth.h"
#include "tests/support/temporary_folder.h"

namespace {

using glm::dvec3;
using Options = std::vector<std::string>;

/// Rows at the bottom that may hold the legend.
constexpr int kLegendRows = 24;

class Display : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        make_test_scenes(folder_->path());
        scene_ = bake_scene(*folder_ / "stage.obj");
    }
    static void TearDownTestSuite() { folder_.reset(); }

    /// The stage as the render tests see it.
    static Picture draw(const std::string& extension, Options options) {
        const Options stage{"--size",
                            "161x120",
                            "--fov",
                            "42",
                            "--camera-target",
                            "0,0.75,0",
                            "--camera-position",
                            "0.3,1.6,4.3",
                            "--light-position",
                            "2.5,3.5,3"};
        options.insert(options.end(), stage.begin(), stage.end());
        return draw_scene(scene_, extension, options);
    }

 private:
    static std::unique_ptr<TemporaryFolder> folder_;
    static std::filesystem::path scene_;
};

std::unique_ptr<TemporaryFolder> Display::folder_;
std::filesystem::path Display::scene_;

/// Linear sRGB of an Oklab colour, from its definition.
dvec3 rgb_of_oklab(double lightness, double a, double b) {
    const auto cube = [](double x) { return x * x * x; };
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

dvec3 false_color_of(const float* sample, double low, double high) {
    const double luminance =
        glm::dot(dvec3(0.2126, 0.7152, 0.0722), dvec3(sample[0], sample[1], sample[2]));
    const double t = low > 0.0 ? std::log10(std::max(luminance, low) / low) / std::log10(high / low)
                               : (luminance - low) / (high - low);
    const double position = std::clamp(t, 0.0, 1.0);
    const double hue = (265.0 + 205.0 * position) * M_PI / 180.0;
    return rgb_of_oklab(0.2 + 0.77 * position, 0.13 * std::cos(hue), 0.13 * std::sin(hue));
}

/// Holds a PNG against the EXR's values, through `color`, which makes linear colours of them.
template <typename Color>
void expect_shows(const Picture& png, const Picture& exr, int rows, Color color) {
    ASSERT_EQ(png.samples.size() / 3, exr.samples.size() / 4);
    int seen = 0;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < png.width; ++x) {
            const float* const value = exr.at(x, y);
            if (value[3] == 0.0f) continue;
            ++seen;
            const dvec3 truth = color(value);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(png.at(x, y)[c], srgb_of_linear(std::clamp(truth[c], 0.0, 1.0)),
                            kByteStep);
        }
    }
    EXPECT_GT(seen, 5000);
}

TEST_F(Display, ExposureMultipliesByPowersOfTwo) {
    for (const std::string view : {"shaded", "specular"}) {
        const Picture exr = draw(".exr", {"--view", view, "--samples", "1"});
        for (const double stops : {-3.0, 2.5}) {
            SCOPED_TRACE(fmt::format("{} {}", view, stops));
            const Picture png = draw(
                ".png", {"--view", view, "--samples", "1", "--exposure", fmt::format("{}", stops)});
            expect_shows(png, exr, png.height, [&](const float* value) {
                return std::exp2(stops) * dvec3(value[0], value[1], value[2]);
            });
        }
    }
}

TEST_F(Display, FalseColorsShowLuminance) {
    const struct {
        const char* view;
        const char* range;
        double low, high;
    } table[] = {
        {"distribution", "auto", 0.01, 1e4},  {"specular", "auto", 0.001, 100.0},
        {"diffuse", "auto", 0.0, 0.32},       {"shaded", "0.05,0.5", 0.05, 0.5},
        {"fresnel", "-0.5,0.75", -0.5, 0.75},
    };
    for (const auto& [view, range, low, high] : table) {
        SCOPED_TRACE(view);
        const Picture exr = draw(".exr", {"--view", view, "--samples", "1"});
        // False colours are of the values, whatever the exposure.
        const Picture png = draw(
            ".png", {"--view", view, "--samples", "1", "--false-color", range, "--exposure", "2"});
        expect_shows(png, exr, png.height - kLegendRows,
                     [low = low, high = high](const float* value) {
                         return false_color_of(value, low, high);
                     });
    }
}

TEST_F(Display, ExrHoldsTheValuesThemselves) {
    const Picture plain = draw(".exr", {"--view", "specular"});
    const Picture shown =
        draw(".exr", {"--view", "specular", "--exposure", "4", "--false-color", "auto"});
    EXPECT_TRUE(plain.samples == shown.samples);
}

/// The columns from `begin` to before `end` are the same in both.
void expect_same_columns(const Picture& a, const Picture& b, int begin, int end) {
    ASSERT_EQ(a.samples.size(), b.samples.size());
    for (int y = 0; y < a.height; ++y) {
        for (int x = begin; x < end; ++x) {
            for (int c = 0; c < a.channels; ++c) ASSERT_EQ(a.at(x, y)[c], b.at(x, y)[c]) << x;
        }
    }
}

TEST_F(Display, SplitSidesAreThoseOfTheWholePictures) {
    const struct {
        Options split, left, right;
    } table[] = {
        {{"--split", "shaded,normal"}, {}, {"--view", "normal"}},
        {{"--split", "shaded:no-normal-map,shaded:no-alpha-mask"},
         {"--no-normal-map"},
         {"--no-alpha-mask"}},
        {{"--split", "specular,roughness", "--exposure", "1"},
         {"--view", "specular", "--exposure", "1"},
         {"--view", "roughness", "--exposure", "1"}},
        {{"--split", "normal,vertex-normal:no-alpha-mask", "--no-alpha-mask"},
         {"--view", "normal", "--no-alpha-mask"},
         {"--view", "vertex-normal", "--no-alpha-mask"}},
    };
    const struct {
        const char* position;
        int column;
    } dividers[] = {{"0.5", 81}, {"0.2", 32}, {"1", 161}};
    for (const auto& [split, left, right] : table) {
        SCOPED_TRACE(split[1]);
        const bool is_first = &split == &table[0].split;
        for (const std::string& extension : is_first ? Options{".exr", ".png"} : Options{".png"}) {
            const Picture left_picture = draw(extension, left);
            const Picture right_picture = draw(extension, right);
            for (const auto& [position, column] : dividers) {
                SCOPED_TRACE(position);
                Options options = split;
                options.insert(options.end(), {"--divider", position});
                const Picture both = draw(extension, options);
                expect_same_columns(both, left_picture, 0, column - 1);
                expect_same_columns(both, right_picture, column + 1, both.width);
                for (int x = std::max(column - 1, 0); x < std::min(column + 1, both.width); ++x) {
                    for (int c = 0; c < 3; ++c) ASSERT_EQ(both.at(x, 60)[c], 1.0f);
                }
            }
        }
    }
}

TEST_F(Display, SidesInFalseColorsHaveTheirOwnRanges) {
    const Picture both = draw(".png", {"--split", "distribution,diffuse", "--false-color", "auto"});
    const Picture left = draw(".png", {"--view", "distribution", "--false-color", "auto"});
    const Picture right = draw(".png", {"--view", "diffuse", "--false-color", "auto"});
    for (int y = 0; y < both.height - kLegendRows; ++y) {
        for (int x = 0; x < both.width; ++x) {
            if (x == 80 || x == 81) continue;
            const float* const whole = (x < 80 ? left : right).at(x, y);
            for (int c = 0; c < 3; ++c) ASSERT_EQ(both.at(x, y)[c], whole[c]);
        }
    }
}

}  // namespace
