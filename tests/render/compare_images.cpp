// compare_images: whether two pictures look the same.
//
// Usage: compare_images [--tolerance T] [--share S] [--report FOLDER] EXPECTED ACTUAL
//
// Compares samples as the files store them (0..1). Exits 1 if more than the share S [0.001] of the
// pixels has a channel that differs by more than T [0.02], or if the sizes differ; then it leaves
// both pictures, their difference and a page that shows all three in FOLDER. Exits 2 if it cannot
// compare.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/image.h"

namespace {

namespace fs = std::filesystem;

struct Settings {
    double tolerance = 0.02;
    double share = 0.001;
    fs::path report;
    fs::path expected;
    fs::path actual;
};

struct Comparison {
    bool same_size = true;
    double share = 0.0;    ///< of the pixels beyond the tolerance
    double largest = 0.0;  ///< difference of a channel
    double square = 0.0;   ///< of the differences, the mean over all channels
};

/// Infinite where one of the two is no number.
double difference(float a, float b) {
    const double result = std::abs(double{a} - double{b});
    return std::isnan(result) ? INFINITY : result;
}

bool same_size(const Picture& a, const Picture& b) {
    return a.width == b.width && a.height == b.height && a.channels == b.channels;
}

Comparison compare(const Picture& expected, const Picture& actual, double tolerance) {
    Comparison result;
    result.same_size = same_size(expected, actual);
    if (!result.same_size) return result;
    const auto channels = static_cast<std::size_t>(expected.channels);
    const std::size_t pixels = expected.samples.size() / channels;
    std::size_t beyond = 0;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        double worst = 0.0;
        for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
            const double apart = difference(expected.samples[i], actual.samples[i]);
            worst = std::max(worst, apart);
            result.square += apart * apart / static_cast<double>(expected.samples.size());
        }
        if (worst > tolerance) ++beyond;
        result.largest = std::max(result.largest, worst);
    }
    result.share = static_cast<double>(beyond) / static_cast<double>(pixels);
    return result;
}

/// Ten times the difference of each colour channel, so that 0.02 is visible.
Picture amplified_difference(const Picture& expected, const Picture& actual) {
    const int channels = std::min(expected.channels, 3);
    return painted(expected.width, expected.height, channels, [&](int x, int y) {
        std::vector<double> samples;
        for (int c = 0; c < channels; ++c) {
            samples.push_back(
                std::min(1.0, 10.0 * difference(expected.at(x, y)[c], actual.at(x, y)[c])));
        }
        return samples;
    });
}

void write_report(const Settings& settings, const Picture& expected, const Picture& actual,
                  const std::string& finding) {
    fs::create_directories(settings.report);
    write_picture(settings.report / "expected.png", expected);
    write_picture(settings.report / "actual.png", actual);
    std::string cells;
    for (const std::string name : {"expected", "actual", "difference"}) {
        if (name == "difference") {
            if (!same_size(expected, actual)) continue;
            write_picture(settings.report / "difference.png",
                          amplified_difference(expected, actual));
        }
        cells +=
            fmt::format("<figure><img src=\"{0}.png\"><figcaption>{0}{1}</figcaption></figure>\n",
                        name, name == "difference" ? " x 10" : "");
    }
    std::ofstream(settings.report / "index.html") << fmt::format(
        "<!DOCTYPE html><meta charset=\"utf-8\"><title>{0}</title>\n"
        "<style>body{{font-family:sans-serif}}figure{{display:inline-block;"
        "margin:4px;width:32%}}img{{width:100%;image-rendering:pixelated}}</style>\n"
        "<h1>{0}</h1><p>{1}</p>\n{2}",
        settings.report.filename().string(), finding, cells);
}

int run(const Settings& settings) {
    const Picture expected = read_picture(settings.expected);
    const Picture actual = read_picture(settings.actual);
    const Comparison found = compare(expected, actual, settings.tolerance);
    const std::string finding =
        found.same_size
            ? fmt::format(
                  "{:.3f} % of the pixels differ by more than {} (allowed: {:.3f} %); "
                  "largest difference {:.4f}; {:.2f} dB apart",
                  100.0 * found.share, settings.tolerance, 100.0 * settings.share, found.largest,
                  -10.0 * std::log10(found.square))
            : fmt::format("size {}x{}x{}, expected {}x{}x{}", actual.width, actual.height,
                          actual.channels, expected.width, expected.height, expected.channels);
    fmt::print("{}: {}\n", settings.actual.string(), finding);
    if (found.same_size && found.share <= settings.share) return 0;
    if (!settings.report.empty()) {
        write_report(settings, expected, actual, finding);
        fmt::print("see {}\n", (fs::absolute(settings.report) / "index.html").string());
    }
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("Whether two pictures look the same.", "compare_images");
    app.add_option("--tolerance", settings.tolerance, "largest difference of a channel");
    app.add_option("--share", settings.share, "share of the pixels that may exceed it");
    app.add_option("--report", settings.report, "folder for what a failure leaves");
    app.add_option("EXPECTED", settings.expected)->required();
    app.add_option("ACTUAL", settings.actual)->required();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    try {
        return run(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "compare_images: {}\n", error.what());
        return 2;
    }
}
