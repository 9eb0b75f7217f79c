#include "cw2/window/file_watch.h"

#include <utility>

namespace cw2 {

FileWatch::FileWatch(std::vector<std::filesystem::path> paths, const std::optional<Time>& since)
    : paths_(std::move(paths)), known_(look()), latest_(known_) {
    if (!since) return;
    for (std::optional<common::FileStamp>& stamp : known_) {
        if (!stamp) continue;
        const Time written = stamp->written_at();
        if (written >= *since && written <= std::chrono::system_clock::now()) stamp.reset();
    }
}

FileWatch::Stamps FileWatch::look() const {
    Stamps stamps;
    for (const std::filesystem::path& path : paths_) stamps.push_back(common::stamp_of(path));
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
