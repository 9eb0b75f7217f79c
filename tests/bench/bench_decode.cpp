// bench_decode FILE.cw2mesh...
//
// Decodes files that were baked with --compress, each 31 times, and prints the least and the median
// CPU milliseconds of one thread and the least wall milliseconds of two; then the bytes of the
// stored and of the decoded geometry.
#include <malloc.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <new>
#include <span>
#include <vector>

#include "mesh-format/decode.h"

namespace {

using namespace mesh_format;

/// Sorted milliseconds of kRuns decodings by `loop`, by `clock`.
constexpr std::size_t kRuns = 31;
template <typename Clock>
std::array<double, kRuns> measure(std::span<const std::byte> bytes, const char* name,
                                  const Loop& loop, const Clock& clock) {
    std::array<double, kRuns> runs;
    for (double& run : runs) {
        Document document = parse(bytes, name);
        const double start = clock();
        const DecodedGeometry geometry = decode(document, name, loop);
        run = clock() - start;
    }
    std::ranges::sort(runs);
    return runs;
}

double cpu() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}
double wall() {
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

int main(int argc, char** argv) {
    // What one run frees the next takes: else it is up to chance whether fresh pages are in it.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 2);
    const Loop two = [](std::size_t count, const std::function<void(std::size_t)>& task) {
        tbb::parallel_for(std::size_t{0}, count, task);
    };
    for (int i = 1; i < argc; ++i) {
        std::ifstream stream(argv[i], std::ios::binary);
        const std::vector<char> file((std::istreambuf_iterator<char>(stream)), {});
        // Sections are aligned to it.
        std::byte* const memory = static_cast<std::byte*>(operator new (
            file.size(), std::align_val_t{kSectionAlignment}));
        std::ranges::transform(file, memory, [](char c) { return std::byte(c); });
        const std::span<const std::byte> bytes(memory, file.size());
        const Document document = parse(bytes, argv[i]);
        const auto one_thread = measure(bytes, argv[i], {}, cpu);
        const auto two_threads = measure(bytes, argv[i], two, wall);
        std::printf("%s: %.2f, %.2f, %.2f ms; %zu and %zu bytes\n", argv[i], one_thread.front(),
                    one_thread[kRuns / 2], two_threads.front(),
                    document.encoded_vertices.size() + document.encoded_indices.size(),
                    document.scene.vertex_bytes + 2 * document.scene.index_count);
        operator delete (memory, std::align_val_t{kSectionAlignment});
    }
}
