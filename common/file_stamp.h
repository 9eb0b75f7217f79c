// Tells whether a file has become another one.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace common {

/// What differs between a file and the one that took its place, or its rewritten contents.
struct FileStamp {
    std::uint64_t device;
    std::uint64_t inode;
    std::uint64_t size;
    std::int64_t seconds;
    std::int64_t nanoseconds;
    auto operator<=>(const FileStamp&) const = default;

    std::chrono::system_clock::time_point written_at() const {
        return std::chrono::system_clock::time_point(std::chrono::seconds(seconds) +
                                                     std::chrono::nanoseconds(nanoseconds));
    }
};

/// Nothing where there is no such file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

}  // namespace common
