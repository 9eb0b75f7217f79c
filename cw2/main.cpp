// cw2: draws a baked scene, in a window or into a file.
#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include "common/io.h"
#include "common/program.h"
#include "common/signals.h"
#include "common/version.h"
#include "cw2/headless.h"
#include "cw2/interactive.h"
#include "cw2/options/config.h"
#include "cw2/options/options.h"
#include "cw2/vulkan/device.h"

namespace {

void tell(const char* message) {
    common::tell("cw2", message);
}

int run(const cw2::Options& options) {
    if (options.list_views) {
        std::string text;
        for (cw2::View view = 0; view < cw2::kViews.size(); ++view) {
            std::string name(cw2::kViews[view].name);
            name.resize(std::max<std::size_t>(name.size(), 16), ' ');
            (text += name + ' ').append(cw2::kViews[view].description) += '\n';
        }
        common::print(text);
        return 0;
    }
    if (options.list_devices) {
        const cw2::Instance instance(options.validation, {});
        for (const std::string& line : cw2::describe_devices(instance)) common::print(line + '\n');
        return instance.validation_messages() == 0 ? 0 : 1;
    }
    // A scene that is none is told before a device or a display is missed.
    const common::MappedFile exists(options.scene);
    if (options.output || options.pixel || options.bench_pictures)
        return cw2::render_headless(options);
    return cw2::run_window(options, common::beside_program("../share/cw2"));
}

}  // namespace

int main(int argc, char** argv) {
    common::handle_signals("cw2");
    try {
        const auto options = cw2::parse_options(argc, argv, common::version());
        return options ? run(*options) : 0;
    } catch (const cw2::UsageError& error) {
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
