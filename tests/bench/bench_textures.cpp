// bench_textures FOLDER [THREADS]
//
// The floor under baking textures: reads every image in FOLDER with OpenImageIO, as the files state
// them, in THREADS threads [2], and does nothing with them. Prints what that took.
#include <OpenImageIO/imageio.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

/// The number of texels.
std::size_t read(const std::filesystem::path& path) {
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input) throw std::runtime_error(OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    std::vector<unsigned char> samples(spec.image_bytes(true));
    input->read_image(0, 0, 0, spec.nchannels, spec.format, samples.data());
    return spec.image_pixels();
}

void bench(const std::filesystem::path& folder) {
    OIIO::attribute("threads", 1);
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files.push_back(entry.path());
    }
    // The largest first, as the bake does.
    std::ranges::sort(files, std::greater<>(),
                      [](const auto& file) { return std::filesystem::file_size(file); });
    const auto begin = std::chrono::steady_clock::now();
    std::atomic<std::size_t> texels = 0;
    std::atomic<std::size_t> next = 0;
    tbb::parallel_for(
        std::size_t{0}, files.size(), [&](std::size_t) { texels += read(files[next++]); },
        tbb::simple_partitioner());
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    std::printf("%zu images, %zu texels: %.3f s\n", files.size(), texels.load(), wall.count());
}

}  // namespace

int main(int count, char** values) {
    try {
        if (count < 2 || count > 3)
            throw std::runtime_error("usage: bench_textures FOLDER [THREADS]");
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        count == 3 ? std::stoul(values[2]) : 2);
        bench(values[1]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_textures: %s\n", error.what());
        return 1;
    }
}
