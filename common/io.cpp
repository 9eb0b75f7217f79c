#include "common/io.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "common/lfs_pointer.h"

namespace common {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw FileError(path.string() + ": " + what);
}

/// As above, with the cause that errno holds.
[[noreturn]] void fail_errno(const std::filesystem::path& path, const std::string& what) {
    fail(path, what + ": " + std::generic_category().message(errno));
}

/// Puts `from` in the place of `to`, in one step.
bool replace(const char* from, const char* to) {
    // Where there is an old file, the two change places and it is removed: a rename over it makes
    // ext4 send all of the new data to the disk first.
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_EXCHANGE) == 0) {
        return ::unlink(from) == 0;
    }
    return ::rename(from, to) == 0;
}

}  // namespace

std::string one_line(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string line;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7F) {
            line += "\\x";
            line += kDigits[byte / 16];
            line += kDigits[byte % 16];
        } else {
            line += c;
        }
    }
    return line;
}

MappedFile::MappedFile(const std::filesystem::path& path) {
    // O_NONBLOCK: opening a named pipe must not wait for its writer.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) fail_errno(path, "cannot be opened");
    struct Closer {
        int descriptor;
        ~Closer() { ::close(descriptor); }
    } const closer{descriptor};
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) fail_errno(path, "cannot be read");
    if (S_ISDIR(status.st_mode)) fail(path, "is a directory");
    if (!S_ISREG(status.st_mode)) fail(path, "is no regular file");
    if (status.st_size == 0) return;
    const auto size = static_cast<std::size_t>(status.st_size);
    void* const address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (address == MAP_FAILED) fail_errno(path, "cannot be mapped");
    bytes_ = {static_cast<const std::byte*>(address), size};
    if (is_lfs_pointer(bytes_)) {
        ::munmap(address, size);
        fail(path, std::string(kIsLfsPointer));
    }
}

MappedFile::~MappedFile() {
    if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
}

OutputFile::OutputFile(std::filesystem::path target) : target_(std::move(target)) {
    if (std::filesystem::is_directory(target_)) fail(target_, "is a directory");
    // A name of its own, so that two writers of one target do not meet in one temporary.
    std::string name = target_.string() + ".XXXXXX";
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) fail_errno(target_, "cannot be written");
    temporary_ = name;
}

OutputFile::~OutputFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_errno(target_, "cannot be written");
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void OutputFile::commit() {
    // mkostemp makes files that only their owner may read; a new file has the process's mode.
    const mode_t mask = ::umask(0);
    ::umask(mask);
    if (::fchmod(descriptor_, 0666 & ~mask) != 0 || !replace(temporary_.c_str(), target_.c_str())) {
        fail_errno(target_, "cannot be written");
    }
    ::close(std::exchange(descriptor_, -1));
}

}  // namespace common
