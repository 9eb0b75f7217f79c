#include "cw2-bake/textures/read_image.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/io.h"
#include "common/lfs_pointer.h"
#include "common/program.h"
#include "cw2-bake/textures/read_common_image.h"

namespace bake {
namespace {

ImageReader* load_image_reader() {
    const auto module = common::beside_program(kImageReaderModule);
    if (!std::filesystem::exists(module))
        throw ImageError("other formats than PNG and JPEG take OpenImageIO, and " +
                         module.string() + " is not there");
    std::string error;
    void* const symbol = common::load_symbol(kImageReaderModule, kImageReaderSymbol, error);
    if (!symbol) throw ImageError("no image can be read: " + error);
    return reinterpret_cast<ImageReader*>(symbol);
}

/// Throws for what no decoder should be asked to open: a pipe would block it for ever.
void check_regular_file(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) {
        throw ImageError("no such file");
    }
    if (error) {
        throw ImageError(error.message());
    }
    if (status.type() == std::filesystem::file_type::directory) {
        throw ImageError("is a directory");
    }
    if (status.type() != std::filesystem::file_type::regular) {
        throw ImageError("is not a regular file");
    }
    if (access(path.c_str(), R_OK) != 0) {
        throw ImageError(std::strerror(errno));
    }
    if (std::filesystem::file_size(path, error) == 0) {
        throw ImageError("is empty");
    }
}

/// Messages of libraries may have several lines, and often end with one.
std::string one_line(std::string text) {
    while (!text.empty() && text.back() == '\n') {
        text.pop_back();
    }
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "cannot be read" : text;
}

Image read_regular_file(const std::filesystem::path& path) {
    static ImageReader* const reader = load_image_reader();
    Image image;
    std::string error;
    if (!reader(path.c_str(), image, error)) {
        if (error.empty()) throw std::bad_alloc();
        throw ImageError(one_line(std::move(error)));
    }
    return image;
}

/// A file in memory that lives as long as this.
class MemoryFile {
 public:
    explicit MemoryFile(std::span<const std::byte> contents)
        : descriptor_(memfd_create("image", MFD_CLOEXEC)) {
        while (descriptor_ >= 0 && !contents.empty()) {
            const ssize_t written = ::write(descriptor_, contents.data(), contents.size());
            if (written <= 0) break;
            contents = contents.subspan(static_cast<std::size_t>(written));
        }
        if (descriptor_ < 0 || !contents.empty()) {
            const std::string cause = std::strerror(errno);
            close(descriptor_);
            throw ImageError(cause);
        }
    }
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
    int descriptor_;
};

}  // namespace

Image read_image(const std::filesystem::path& path) {
    check_regular_file(path);
    try {
        const common::MappedFile file(path);
        if (auto image = read_common_image(file.bytes())) {
            file.require_unchanged();
            return std::move(*image);
        }
    } catch (const common::FileError& error) {
        const std::string prefix = path.string() + ": ";
        const std::string_view line = error.what();
        throw ImageError(std::string(line.substr(line.starts_with(prefix) ? prefix.size() : 0)));
    }
    return read_regular_file(path);
}

Image read_image(std::span<const std::byte> contents) {
    if (contents.empty()) throw ImageError("is empty");
    if (common::is_lfs_pointer(contents)) throw ImageError(std::string(common::kIsLfsPointer));
    if (auto image = read_common_image(contents)) return std::move(*image);
    // Not every decoder of OpenImageIO reads from memory; all read files.
    return read_regular_file(MemoryFile(contents).path());
}

}  // namespace bake
