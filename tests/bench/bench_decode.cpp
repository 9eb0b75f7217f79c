// bench_decode FILE.cw2mesh...
//
// Decodes files that were baked with --compress, each 31 times by one thread and 31 times by two,
// and prints the least CPU milliseconds of both, and the least wall milliseconds of two.
#include <malloc.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <span>
#include <vector>

#include "mesh-format/decode.h"

namespace {

using namespace mesh_format;

/// The least milliseconds by `clock` of 31 decodings by `loop`.
template <typename Clock>
double least(std::span<const std::byte> bytes, const char* name, const Loop& loop,
             const Clock& clock) {
    double result = std::numeric_limits<double>::max();
    for (int run = 0; run < 31; ++run) {
        Document document = parse(bytes, name);
        const double start = clock();
        const DecodedGeometry geometry = decode(document, name, loop);
        result = std::min(result, clock() - start);
    }
    return result;
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
        std::printf("%s: %.2f %.2f %.2f\n", argv[i], least(bytes, argv[i], {}, cpu),
                    least(bytes, argv[i], two, cpu), least(bytes, argv[i], two, wall));
        operator delete (memory, std::align_val_t{kSectionAlignment});
    }
}
