// Tells when files have become other ones.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/file_stamp.h"

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
    using Stamps = std::vector<std::optional<common::FileStamp>>;
    Stamps look() const;

    std::vector<std::filesystem::path> paths_;
    Stamps known_;
    Stamps latest_;
};

}  // namespace cw2
