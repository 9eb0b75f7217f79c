// cw2: draws a baked scene, in a window or into a file.
#include <cstdio>
#include <exception>

#include "common/io.h"
#include "cw2/headless.h"
#include "cw2/interactive.h"
#include "cw2/options/config.h"
#include "cw2/options/options.h"
#include "cw2/vulkan/device.h"

namespace {

void tell(const char* message) {
    std::fprintf(stderr, "cw2: %s\n", common::one_line(message).c_str());
}

int run(const cw2::Options& options) {
    if (options.list_views) {
        for (cw2::View view = 0; view < cw2::kViews.size(); ++view) {
            std::printf("%-16s %s\n", cw2::kViews[view].name.data(),
                        cw2::kViews[view].description.data());
        }
        return 0;
    }
    // A scene that is none is told before a device or a display is missed.
    if (!options.list_devices) const common::MappedFile exists(options.scene);
    if (!options.list_devices && !options.output && !options.pixel) {
        return cw2::run_window(options, CW2_SOURCE_DIR);
    }

    if (!options.list_devices) return cw2::render_headless(options);
    const cw2::Instance instance(options.validation, {});
    for (const std::string& line : cw2::describe_devices(instance)) std::puts(line.c_str());
    return instance.validation_messages() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto options = cw2::parse_options(argc, argv);
        return options ? run(*options) : 0;
    } catch (const cw2::UsageError& error) {
        tell(error.what());
        return 2;
    } catch (const std::exception& error) {
        tell(error.what());
        return 1;
    }
}
