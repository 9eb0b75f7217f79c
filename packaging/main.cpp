// make-documents FOLDER VERSION: writes man pages, and completions for bash, fish and zsh, of both
// programs, from their tables of options.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <span>

#include "common/io.h"
#include "cw2-bake/settings.h"
#include "cw2/options/options.h"
#include "packaging/command_line.h"

namespace {

constexpr std::string_view kRenderManual = R"(.SH EXIT STATUS
0: done; 1: what was asked cannot be done (files, devices, data); 2: wrong usage.
.SH ENVIRONMENT
What is not baked yet is baked into the folder \fIcw2\fR of \fBXDG_CACHE_HOME\fR, or of
\fI~/.cache\fR. \fBVK_DRIVER_FILES\fR, of the Vulkan loader, chooses drivers.
.SH EXAMPLES
.nf
cw2 model.obj
cw2 model.obj \-\-output picture.png \-\-camera\-position 2,1,3
cw2 model.glb \-\-frames 120 \-\-output turn_%04d.png
.fi
.SH SEE ALSO
.BR cw2\-bake (1)
)";

constexpr std::string_view kBakeManual = R"(.SH EXIT STATUS
0: done; 1: what was asked cannot be done (files, data); 2: wrong usage. A bake that fails leaves an
earlier output as it was.
.SH EXAMPLES
.nf
cw2\-bake model.obj
cw2\-bake model.glb \-o out/model.cw2mesh \-\-compress \-\-depfile out/model.d
cw2\-bake \-\-inspect model.cw2mesh
cw2\-bake model.cw2mesh \-o model.glb
.fi
.SH SEE ALSO
.BR cw2 (1)
)";

void write(const std::filesystem::path& path, std::string_view text) {
    std::filesystem::create_directories(path.parent_path());
    common::write_file(path, std::as_bytes(std::span(text)));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: make-documents FOLDER VERSION\n", stderr);
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    const auto document = [&](std::string_view manual) {
        return [&, manual](const CLI::App& app) {
            const packaging::CommandLine line = packaging::describe(app);
            write(folder / "man" / (line.program + ".1"),
                  packaging::man_page(line, argv[2], manual));
            write(folder / "bash" / line.program, packaging::bash_completion(line));
            write(folder / "fish" / (line.program + ".fish"), packaging::fish_completion(line));
            write(folder / "zsh" / ('_' + line.program), packaging::zsh_completion(line));
        };
    };
    try {
        cw2::show_command_line(document(kRenderManual));
        bake::show_command_line(document(kBakeManual));
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make-documents: %s\n", error.what());
        return 1;
    }
}
