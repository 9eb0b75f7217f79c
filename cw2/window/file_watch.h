// Tells when a file has become another one.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace cw2 {

class FileWatch {
 public:
    /// From the file as it is now.
    explicit FileWatch(std::filesystem::path path);

    /// Whether the file has changed since the last time this was true, and was the same at the
    /// last two calls: whoever writes it is probably done. Never while there is no file.
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
    std::optional<Stamp> look() const;

    std::filesystem::path path_;
    std::optional<Stamp> known_;
    std::optional<Stamp> latest_;
};

}  // namespace cw2
