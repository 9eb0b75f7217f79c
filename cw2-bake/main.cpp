// cw2-bake: turns an OBJ into a .cw2mesh file, and tells what is in one.
#include <malloc.h>

#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "common/io.h"
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

/// One heap that keeps what it has got: a bake makes arrays one after the other, and handing their
/// pages back to the kernel and asking for new ones takes a fifth of its time. Only the largest,
/// which are of huge pages, lie apart and go when they are done with.
void keep_memory() {
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, 12 << 20);
    mallopt(M_TRIM_THRESHOLD, 256 << 20);
    mallopt(M_TOP_PAD, 4 << 20);
}

}  // namespace

int main(int argc, char** argv) {
    keep_memory();
    common::handle_signals("cw2-bake");
    try {
        const auto settings = bake::parse_settings(argc, argv, common::version());
        if (settings) run(*settings);
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
