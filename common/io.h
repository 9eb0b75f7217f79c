// Files as both executables read and write them: mapped whole, replaced whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace common {

/// A file that cannot be read or written; what() is one line "PATH: what is wrong".
class FileError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// `text` with its control characters as \xNN: names in files may hold line breaks, and a message
/// is one line.
std::string one_line(std::string_view text);

/// Writes the one line "PROGRAM: MESSAGE" to standard error, as one_line() makes it; takes no
/// memory, for there may be none.
void tell(std::string_view program, std::string_view message) noexcept;

/// The first `most` bytes of a file, in memory, where they stay what they are whatever happens to
/// it. Throws FileError as MappedFile does.
std::vector<std::byte> read_file(const std::filesystem::path& path,
                                 std::size_t most = std::numeric_limits<std::size_t>::max());

/// Writes to standard output; throws FileError where it takes no more.
void print(std::string_view text);

/// A file mapped read-only, unmapped when destroyed. Reading it after it became shorter ends the
/// program as handle_signals() says.
class MappedFile {
 public:
    /// Throws FileError if `path` is missing, is not a regular file, cannot be read, or is a Git
    /// LFS pointer.
    explicit MappedFile(const std::filesystem::path& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;

    std::span<const std::byte> bytes() const { return bytes_; }
    /// Throws FileError if somebody has written to the file since it was mapped: then what was read
    /// may be partly what it was, partly what it has become.
    void require_unchanged() const;

 private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::int64_t changed_ = 0;  ///< when, in nanoseconds
    std::span<const std::byte> bytes_;
};

/// Lets go of the memory of a part of a MappedFile's bytes, but for pages that it shares with what
/// is beside it; it is read anew if somebody needs it.
void forget_mapped(std::span<const std::byte> part);

/// A file that is written beside its target and takes its place on commit(), with the mode and, as
/// far as that is permitted, the owner of what was there; destroyed without commit() it leaves no
/// trace. Where the target is a symbolic link, the link stays. A FIFO or a character device is
/// written as it is, from the first write() on. The first such file in a folder removes those that
/// killed programs left there.
class OutputFile {
 public:
    /// Throws FileError if no file can be made beside `target`, or if it is something else.
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Appends; throws FileError on a full disk and the like.
    void write(std::span<const std::byte> bytes);
    /// Renames the finished file to its target.
    void commit();

 private:
    bool is_stream() const { return temporary_.empty(); }
    void make_temporary();
    void keep_mode_and_owner() const;

    std::filesystem::path name_;    ///< for messages
    std::filesystem::path target_;  ///< no symbolic link
    std::string temporary_;
    int descriptor_ = -1;
};

/// An OutputFile of these bytes alone.
void write_file(const std::filesystem::path& target, std::span<const std::byte> bytes);

}  // namespace common
