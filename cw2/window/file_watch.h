// Tells when files have become other ones.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace cw2 {

class FileWatch {
 public:
    using Time = std::chrono::system_clock::time_point;

    /// From the files as they are now, but what was written to between `since` and now counts as
    /// changed. There is at least one; all but the first may be missing.
    explicit FileWatch(std::vector<std::filesystem::path> paths,
                       const std::optional<Time>& since = std::nullopt);

    /// Whether a file has changed since the last time this was true, and all were the same at the
    /// last two calls: whoever writes them is probably done. Never while the first is missing.
    bool changed();

 private:
    /// What differs between a file and the one that took its place, or its rewritten contents.
    struct Stamp {
        std::uint64_t device;
        std::uint64_t inode;
        std::uint64_t size;
        std::int64_t seconds;
        std::int64_t nanoseconds;
        auto operator<=>(const Stamp&) const = default;
    };
    using Stamps = std::vector<std::optional<Stamp>>;
    Stamps look() const;

    std::vector<std::filesystem::path> paths_;
    Stamps known_;
    Stamps latest_;
};

}  // namespace cw2
