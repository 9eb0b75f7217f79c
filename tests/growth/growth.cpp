// Bakes inputs at two sizes under callgrind, which counts instructions, and holds the growth of
// their number against that of the input: time would depend on what else the machine does.
#include <tbb/global_control.h>
#include <valgrind/callgrind.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>

#include "cw2-bake/bake.h"
#include "tests/growth/inputs.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

struct Work {
    std::uint64_t bytes = 0;         ///< of the input
    std::uint64_t instructions = 0;  ///< to bake it
    int warnings = 0;
};

/// callgrind was told to write to `profile`; it adds a number to each name.
std::uint64_t instructions_since_last(const fs::path& profile) {
    static int dumps = 0;
    CALLGRIND_DUMP_STATS;
    const fs::path dump = profile.string() + '.' + std::to_string(++dumps);
    std::ifstream file(dump);
    std::uint64_t total = 0;
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("totals: ")) total = std::stoull(line.substr(8));
    fs::remove(dump);
    if (total == 0) throw std::runtime_error(dump.string() + ": holds no total");
    return total;
}

Work work_of(const Input& input, int n, const fs::path& profile) {
    const TemporaryFolder folder;
    bake::Settings settings{.input = input.write(folder.path(), n),
                            .output = folder / "out.cw2mesh",
                            .threads = 1,
                            .quiet = true};
    Work work;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
        if (entry.is_regular_file()) work.bytes += entry.file_size();
    CALLGRIND_ZERO_STATS;
    try {
        bake::bake(settings, [&](const std::string&) { ++work.warnings; });
    } catch (const std::runtime_error&) {
        // Refused: also an answer, and also one that must not take long.
    }
    work.instructions = instructions_since_last(profile);
    return work;
}

/// A factor of 4 in size: n log n grows by less than 1.35 times as much.
bool grows_with_its_input(const Input& input, const fs::path& profile) {
    const Work small = work_of(input, input.n, profile);
    const Work large = work_of(input, 4 * input.n, profile);
    const double growth = static_cast<double>(large.instructions) /
                          static_cast<double>(small.instructions) *
                          (static_cast<double>(small.bytes) / static_cast<double>(large.bytes));
    const bool is_good = growth < 1.35 && large.warnings < 60;
    std::printf("%s %-35s %8zu bytes %10zu instructions %8zu bytes %10zu instructions: x %.2f\n",
                is_good ? "    " : "BAD ", input.name, static_cast<std::size_t>(small.bytes),
                static_cast<std::size_t>(small.instructions), static_cast<std::size_t>(large.bytes),
                static_cast<std::size_t>(large.instructions), growth);
    std::fflush(stdout);
    return is_good;
}

/// What is missing costs in proportion to what is missing: of one thing next to nothing.
int costs_of_what_is_missing(const fs::path& profile) {
    const std::vector<Input> inputs = nearly_whole_inputs();
    const auto instructions = [&](const Input& input) {
        return static_cast<double>(work_of(input, input.n, profile).instructions);
    };
    const double whole = instructions(inputs.front());
    int bad = 0;
    for (const Input& input : std::span(inputs).subspan(1)) {
        const double cost = instructions(input) / whole;
        const bool is_good = cost < 1.04;
        std::printf("%s %-35s x %.3f of the whole one's instructions\n", is_good ? "    " : "BAD ",
                    input.name, cost);
        bad += !is_good;
    }
    return bad;
}

}  // namespace

int main(int, char** argv) {
    if (RUNNING_ON_VALGRIND == 0 || !argv[1]) {
        std::fputs("usage: valgrind --tool=callgrind --callgrind-out-file=FILE growth FILE\n",
                   stderr);
        return 2;
    }
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    int bad = 0;
    for (const auto& inputs : {obj_inputs(), gltf_inputs()}) {
        work_of(inputs.front(), 10, argv[1]);  // what happens once
        for (const Input& input : inputs) bad += !grows_with_its_input(input, argv[1]);
    }
    bad += costs_of_what_is_missing(argv[1]);
    return bad > 0 ? 1 : 0;
}
