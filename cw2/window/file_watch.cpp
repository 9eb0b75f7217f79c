#include "cw2/window/file_watch.h"

#include <sys/stat.h>

#include <utility>

namespace cw2 {

FileWatch::FileWatch(std::vector<std::filesystem::path> paths, const std::optional<Time>& since)
    : paths_(std::move(paths)), known_(look()), latest_(known_) {
    if (!since) return;
    for (std::optional<Stamp>& stamp : known_) {
        if (!stamp) continue;
        const Time written(std::chrono::seconds(stamp->seconds) +
                           std::chrono::nanoseconds(stamp->nanoseconds));
        if (written >= *since && written <= std::chrono::system_clock::now()) stamp.reset();
    }
}

FileWatch::Stamps FileWatch::look() const {
    Stamps stamps;
    for (const std::filesystem::path& path : paths_) {
        struct stat status {};
        auto& stamp = stamps.emplace_back();
        if (stat(path.c_str(), &status) == 0)
            stamp = Stamp{status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
                          status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
    }
    return stamps;
}

bool FileWatch::changed() {
    const Stamps now = look();
    const bool settled = now == std::exchange(latest_, now);
    if (!settled || !now.front() || now == known_) return false;
    known_ = now;
    return true;
}

}  // namespace cw2
