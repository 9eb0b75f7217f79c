// cw2-bake: turns an OBJ into a .cw2mesh file, and tells what is in one.
#include <cstdint>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "common/io.h"
#include "common/large_memory.h"
#include "common/signals.h"
#include "common/version.h"
#include "cw2-bake/bake.h"
#include "cw2-bake/inspection.h"
#include "cw2-bake/settings.h"
#include "mesh-format/file.h"

namespace {

void tell(std::string_view message) {
    common::tell("cw2-bake", message);
}

void inspect(const bake::Settings& settings) {
    const common::MappedFile file(settings.input);
    const auto document = mesh_format::parse(file.bytes(), settings.input.string());
    const std::string text = settings.json ? bake::inspection_json(document, file.bytes().size())
                                           : settings.input.string() + '\n' +
                                                 bake::inspection(document, file.bytes().size());
    common::print(text);
}

void run(const bake::Settings& settings) {
    const auto warn = [&](const std::string& warning) {
        if (settings.strict) throw bake::BakeError(warning);
        if (!settings.quiet) tell("warning: " + warning);
    };
    try {
        if (settings.inspect) return inspect(settings);
        const std::string summary =
            settings.is_baked ? bake::export_baked(settings, warn) : bake::bake(settings, warn);
        if (!settings.quiet) common::print(summary);
    } catch (const std::bad_alloc&) {
        throw bake::BakeError(settings.input.string() + ": there is not enough memory to " +
                              (settings.inspect ? "inspect it" : "export it"));
    }
}

/// A bake makes arrays one after the other, and handing their pages back to the kernel and asking
/// for new ones takes a fifth of its time. Only the largest, which are of huge pages, go when they
/// are done with.
constexpr int kLargestKept = 12 << 20;
/// Of inputs; what is made of smaller ones would fill a huge page or two in part.
constexpr std::uintmax_t kWorthHugePages = 32 << 20;
/// Less than the large arrays of such inputs: they would be kept where they fit.
constexpr int kHugeHeap = 32 << 20;

}  // namespace

int main(int argc, char** argv) {
    common::keep_heap(kLargestKept);
    common::handle_signals("cw2-bake");
    try {
        const auto settings = bake::parse_settings(argc, argv, common::version());
        std::error_code unknown;
        if (settings) {
            const std::uintmax_t bytes = std::filesystem::file_size(settings->input, unknown);
            if (!unknown && bytes >= kWorthHugePages) common::prefer_huge_heap(kHugeHeap);
            run(*settings);
        }
        return 0;
    } catch (const bake::UsageError& error) {
        tell(error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        tell("there is not enough memory");
        return 1;
    } catch (const std::exception& error) {
        tell(error.what());
        return 1;
    }
}
