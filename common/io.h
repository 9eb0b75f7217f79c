// Files as both executables read and write them: mapped whole, replaced whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace common {

/// A file that cannot be read or written; what() is one line "PATH: what is wrong".
class FileError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// `text` with its control characters as \xNN: names in files may hold line breaks, and a message
/// is one line.
std::string one_line(std::string_view text);

/// A file mapped read-only, unmapped when destroyed.
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

 private:
    std::span<const std::byte> bytes_;
};

/// A file that is written beside its target and takes its place on commit(); destroyed without
/// commit() it leaves no trace.
class OutputFile {
 public:
    /// Throws FileError if no file can be made beside `target`.
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Appends; throws FileError on a full disk and the like.
    void write(std::span<const std::byte> bytes);
    /// Renames the finished file to its target.
    void commit();

 private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    int descriptor_ = -1;
};

}  // namespace common
