#include "cw2/window/file_watch.h"

#include <sys/stat.h>

#include <utility>

namespace cw2 {

FileWatch::FileWatch(std::filesystem::path path)
    : path_(std::move(path)), known_(look()), latest_(known_) {}

std::optional<FileWatch::Stamp> FileWatch::look() const {
    struct stat status {};
    if (stat(path_.c_str(), &status) != 0) return std::nullopt;
    return Stamp{status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
                 status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

bool FileWatch::changed() {
    const std::optional<Stamp> now = look();
    const bool settled = now == std::exchange(latest_, now);
    if (!settled || !now || now == known_) return false;
    known_ = now;
    return true;
}

}  // namespace cw2
