// bench_textures FOLDER [THREADS]
//
// The floor under baking textures: reads every image in FOLDER with the bake's own reader, in as
// many threads, and does nothing with them. Prints wall and processor seconds of five runs.
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "cw2-bake/read_image.h"

namespace {

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void read_all(const std::vector<std::filesystem::path>& files) {
    std::atomic<std::size_t> texels = 0;
    tbb::parallel_for(
        std::size_t{0}, files.size(),
        [&](std::size_t i) {
            const bake::Image image = bake::read_image(files[i]);
            texels += std::size_t{image.width} * image.height;
        },
        tbb::simple_partitioner());
    std::printf("%zu images, %zu texels: ", files.size(), texels.load());
}

void bench(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files.push_back(entry.path());
    }
    std::ranges::sort(files);
    for (int run = 0; run < 5; ++run) {
        const auto begin = std::chrono::steady_clock::now();
        const double before = processor_seconds();
        read_all(files);
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
        std::printf("%.3f s wall, %.3f s processor\n", wall.count(), processor_seconds() - before);
    }
}

}  // namespace

int main(int count, char** values) {
    try {
        if (count < 2 || count > 3) throw bake::ImageError("usage: bench_textures FOLDER [THREADS]");
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        count == 3 ? std::stoul(values[2]) : 2);
        bench(values[1]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_textures: %s\n", error.what());
        return 1;
    }
}
