#include "cw2/bench.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace cw2 {

namespace {

double per_pixel(std::uint64_t fragments, const PictureSize& size) {
    return static_cast<double>(fragments) / (static_cast<double>(size.width) * size.height);
}

}  // namespace

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

double peak_memory() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::string text_of(const Bench& bench, const PictureSize& size, std::uint32_t samples) {
    const auto row = [](const char* name, const std::vector<double>& values) {
        return fmt::format("  {:<8}{:10.2f}{:10.2f}\n", name, quantile(values, 0.5),
                           quantile(values, 0.95));
    };
    const std::string fragments = bench.fragments ? fmt::format("{:.2f} fragments a pixel, ",
                                                                per_pixel(*bench.fragments, size))
                                                  : std::string();
    return fmt::format(
        "{} pictures of {}x{}, {} {} each; milliseconds, median and 95 %:\n{}{}{}"
        "  {}{} triangles in {} draws, {} pipelines; peak memory {:.0f} MiB\n",
        bench.wall.size(), size.width, size.height, samples, samples == 1 ? "frame" : "frames",
        row("wall", bench.wall), row("CPU", bench.cpu), row("device", bench.device), fragments,
        bench.counts.triangles, bench.counts.draws, bench.pipelines, peak_memory());
}

std::string json_of(const Bench& bench, const PictureSize& size) {
    const auto times = [](const char* name, const std::vector<double>& values) {
        return fmt::format(",\n  \"{0}_median_ms\": {1:.3f},\n  \"{0}_95_ms\": {2:.3f}", name,
                           quantile(values, 0.5), quantile(values, 0.95));
    };
    std::string text = fmt::format(",\n  \"bench_pictures\": {}", bench.wall.size());
    text += times("wall", bench.wall) + times("cpu", bench.cpu) + times("device", bench.device);
    if (bench.fragments) {
        text +=
            fmt::format(",\n  \"fragments_per_pixel\": {:.4f}", per_pixel(*bench.fragments, size));
    }
    return text + fmt::format(
                      ",\n  \"frame_triangles\": {},\n  \"frame_draws\": {},\n"
                      "  \"pipelines\": {}",
                      bench.counts.triangles, bench.counts.draws, bench.pipelines);
}

}  // namespace cw2
