// cw2_with_sources: cw2's window, with shaders reloaded from another folder.
//
// Usage: cw2_with_sources FOLDER OPTION...; FOLDER holds shaders/, the options are those of cw2.
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "cw2/interactive.h"
#include "cw2/options/options.h"

int main(int argc, char** argv) {
    try {
        const auto options = cw2::parse_options(argc - 1, argv + 1);
        return options ? cw2::run_window(*options, argv[1]) : 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "cw2_with_sources: {}\n", error.what());
        return 1;
    }
}
