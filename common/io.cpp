#include "common/io.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <mutex>
#include <new>
#include <random>
#include <set>
#include <system_error>
#include <utility>

#include "common/lfs_pointer.h"
#include "common/signals.h"

namespace common {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw FileError(path.string() + ": " + what);
}

/// As above, with the cause that errno holds.
[[noreturn]] void fail_errno(const std::filesystem::path& path, const std::string& what) {
    fail(path, what + ": " + std::generic_category().message(errno));
}

/// Puts a temporary file in the place of `to`, in one step.
bool replace(const std::string& from, const std::filesystem::path& to) {
    // Where there is an old file, the two change places and it is removed: a rename over it makes
    // ext4 send all of the new data to the disk first.
    const bool renamed =
        ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0 ||
        ::rename(from.c_str(), to.c_str()) == 0;
    return renamed && remove_temporary(from);
}

/// Closes what it holds.
class Descriptor {
 public:
    explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
    ~Descriptor() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    Descriptor(Descriptor&& other) noexcept : descriptor_(other.release()) {}

    int get() const { return descriptor_; }
    int release() { return std::exchange(descriptor_, -1); }

 private:
    int descriptor_;
};

struct stat status_of(const Descriptor& file, const std::filesystem::path& path) {
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) fail_errno(path, "cannot be read");
    return status;
}

std::int64_t changed_at(const struct stat& status) {
    return std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
}

Descriptor open_regular(const std::filesystem::path& path) {
    struct stat status {};
    // Opening some devices does something.
    const bool is_there = ::stat(path.c_str(), &status) == 0;
    if (is_there && S_ISDIR(status.st_mode)) fail(path, "is a directory");
    if (is_there && !S_ISREG(status.st_mode)) fail(path, "is no regular file");
    // O_NONBLOCK: if it has become a named pipe, opening it must not wait for its writer.
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (file.get() < 0) fail_errno(path, "cannot be opened");
    if (!S_ISREG(status_of(file, path).st_mode)) fail(path, "is no regular file");
    std::array<std::byte, 64> start;
    const ssize_t count = ::pread(file.get(), start.data(), start.size(), 0);
    if (count < 0) fail_errno(path, "cannot be read");
    if (is_lfs_pointer(std::span(start).first(static_cast<std::size_t>(count))))
        fail(path, std::string(kIsLfsPointer));
    return file;
}

/// Gives the characters of what one_line() makes of `text`.
template <typename Put>
void each_shown(std::string_view text, Put&& put) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7F) {
            for (const char shown : {'\\', 'x', kDigits[byte / 16], kDigits[byte % 16]}) put(shown);
        } else {
            put(c);
        }
    }
}

// Temporary files are named as their target, this, and some of these.
constexpr std::string_view kMark = ".cw2-tmp-";  // which no user's own file has
constexpr std::size_t kSuffixLength = 6;
constexpr std::size_t kLongestName = 255;  // of a file, as Linux has it
constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";

bool is_temporary_name(std::string_view name) {
    if (name.size() < kMark.size() + kSuffixLength) return false;
    const std::string_view suffix = name.substr(name.size() - kSuffixLength);
    name.remove_suffix(kSuffixLength);
    return name.ends_with(kMark) && suffix.find_first_not_of(kLetters) == suffix.npos;
}

/// Removes what programs that were killed have left in `folder`: nobody has a lock on it.
void remove_leftovers(const std::filesystem::path& folder) {
    static std::mutex mutex;
    static std::set<std::filesystem::path> done;
    const std::scoped_lock lock(mutex);
    if (!done.insert(folder).second) return;
    // Iterators of std::filesystem end the program where there is no memory.
    const std::unique_ptr<DIR, int (*)(DIR*)> entries(
        ::opendir(folder.empty() ? "." : folder.c_str()), ::closedir);
    if (!entries) return;
    while (const dirent* const entry = ::readdir(entries.get())) {
        if (!is_temporary_name(entry->d_name)) continue;
        const int at = ::dirfd(entries.get());
        const Descriptor file(
            ::openat(at, entry->d_name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
        struct stat status {};
        if (file.get() >= 0 && ::fstat(file.get(), &status) == 0 && S_ISREG(status.st_mode) &&
            status.st_uid == ::geteuid() && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) {
            ::unlinkat(at, entry->d_name, 0);
        }
    }
}

}  // namespace

std::string one_line(std::string_view text) {
    std::string line;
    each_shown(text, [&](char c) { line += c; });
    return line;
}

void tell(std::string_view program, std::string_view message) noexcept {
    std::array<char, 512> buffer;
    std::size_t filled = 0;
    const auto put = [&](char c) {
        buffer[filled++] = c;
        if (filled < buffer.size() && c != '\n') return;
        [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, buffer.data(), filled);
        filled = 0;
    };
    for (const char c : program) put(c);
    for (const char c : {':', ' '}) put(c);
    each_shown(message, put);
    put('\n');
}

std::vector<std::byte> read_file(const std::filesystem::path& path, std::size_t most) {
    const Descriptor file = open_regular(path);
    const std::size_t size =
        std::min(static_cast<std::size_t>(status_of(file, path).st_size), most);
    std::vector<std::byte> bytes;
    if (size > bytes.max_size()) throw std::bad_alloc();
    bytes.resize(size);
    std::size_t done = 0;
    while (done < size) {
        const ssize_t count = ::read(file.get(), bytes.data() + done, size - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail_errno(path, "cannot be read");
        if (count == 0) fail(path, "became shorter while it was read");
        done += static_cast<std::size_t>(count);
    }
    return bytes;
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() ||
        std::fflush(stdout) != 0) {
        fail_errno("standard output", "cannot be written");
    }
}

MappedFile::MappedFile(const std::filesystem::path& path) : path_(path) {
    Descriptor file = open_regular(path);
    const struct stat status = status_of(file, path);
    changed_ = changed_at(status);
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size > 0) {
        void* const address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
        if (address == MAP_FAILED) fail_errno(path, "cannot be mapped");
        bytes_ = {static_cast<const std::byte*>(address), size};
        guard_mapping(bytes_, path.string());
    }
    descriptor_ = file.release();
}

MappedFile::~MappedFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (bytes_.empty()) return;
    unguard_mapping(bytes_);
    ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      changed_(other.changed_),
      bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(changed_, other.changed_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

void forget_mapped(std::span<const std::byte> part) {
    static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    const auto begin = reinterpret_cast<std::uintptr_t>(part.data());
    const std::uintptr_t first = (begin + page - 1) / page * page;
    const std::uintptr_t end = (begin + part.size()) / page * page;
    if (first < end) ::madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}

void MappedFile::require_unchanged() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail_errno(path_, "cannot be read");
    if (changed_at(status) != changed_ || static_cast<std::size_t>(status.st_size) != bytes_.size())
        fail(path_, "has changed while it was read");
}

OutputFile::OutputFile(const std::filesystem::path& target) : name_(target), target_(target) {
    struct stat status {};
    const bool exists = ::stat(target.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) fail(target, "is a directory");
    if (exists && S_ISBLK(status.st_mode)) fail(target, "is a block device");
    if (exists && S_ISSOCK(status.st_mode)) fail(target, "is a socket");
    if (exists && !S_ISREG(status.st_mode)) {
        if (::access(target.c_str(), W_OK) != 0) fail_errno(target, "cannot be written");
        return;
    }
    constexpr int kMostLinks = 40;  // as the kernel has it
    std::error_code error;
    for (int i = 0; std::filesystem::is_symlink(target_, error); ++i) {
        if (i == kMostLinks) fail(target, "cannot be written: too many symbolic links");
        target_ = target_.parent_path() / std::filesystem::read_symlink(target_, error);
    }
    remove_leftovers(target_.parent_path());
    make_temporary();
}

/// A name of its own, so that two writers of one target do not meet in one temporary, and a lock
/// for as long as somebody writes.
void OutputFile::make_temporary() {
    const std::string stem =
        target_.filename().string().substr(0, kLongestName - kMark.size() - kSuffixLength);
    std::random_device random;
    for (int i = 0; i < 100; ++i) {
        std::string name = (target_.parent_path() / stem).string() + std::string(kMark);
        for (std::size_t k = 0; k < kSuffixLength; ++k)
            name += kLetters[random() % kLetters.size()];
        // What others may not read in the end they may not read before.
        std::error_code error;
        const mode_t mode = std::filesystem::exists(target_, error) ? 0600 : 0666;
        descriptor_ = create_temporary(name, mode);
        if (descriptor_ < 0 && errno == EEXIST) continue;
        if (descriptor_ < 0) fail_errno(name_, "cannot be written");
        temporary_ = std::move(name);
        const bool locked = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
        struct stat status {};
        if (locked && ::fstat(descriptor_, &status) == 0 && status.st_nlink > 0) return;
        // Somebody took it for a leftover, before it was locked.
        ::close(std::exchange(descriptor_, -1));
        remove_temporary(temporary_);
    }
    fail(name_, "cannot be written: no name for a temporary file is free");
}

OutputFile::~OutputFile() {
    if (descriptor_ < 0) return;
    if (!is_stream()) remove_temporary(temporary_);
    ::close(descriptor_);
}

void OutputFile::write(std::span<const std::byte> bytes) {
    if (descriptor_ < 0) descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor_ < 0) fail_errno(name_, "cannot be written");
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_errno(name_, "cannot be written");
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

/// Of what is there, if something is; of a new file they are right already.
void OutputFile::keep_mode_and_owner() const {
    struct stat old {};
    if (::stat(target_.c_str(), &old) != 0) return;
    struct stat own {};
    bool ok = ::fstat(descriptor_, &own) == 0;
    mode_t mode = old.st_mode & 0777;
    // Only root may give files away, but everybody may to a group of theirs. What another group
    // might do ours may not.
    if (own.st_gid != old.st_gid && ::fchown(descriptor_, static_cast<uid_t>(-1), old.st_gid) != 0)
        mode &= ~mode_t{070};
    if (own.st_uid != old.st_uid) [[maybe_unused]]
        const int refused = ::fchown(descriptor_, old.st_uid, static_cast<gid_t>(-1));
    ok = ok && ::fchmod(descriptor_, mode) == 0;
    if (!ok) fail_errno(name_, "cannot be written");
}

void OutputFile::commit() {
    if (!is_stream()) {
        keep_mode_and_owner();
        // Some file systems tell of a full disk when a file is closed.
        if (::close(::dup(descriptor_)) != 0 || !replace(temporary_, target_)) {
            fail_errno(name_, "cannot be written");
        }
    }
    if (::close(std::exchange(descriptor_, -1)) != 0 && is_stream()) {
        fail_errno(name_, "cannot be written");
    }
}

void write_file(const std::filesystem::path& target, std::span<const std::byte> bytes) {
    OutputFile file(target);
    file.write(bytes);
    file.commit();
}

}  // namespace common
