#include "cw2/window/file_list.h"

#include <fmt/format.h>

#include <utility>

namespace cw2 {

FileList::FileList(std::vector<std::filesystem::path> files) : files_(std::move(files)) {}

void FileList::go(int steps) {
    const auto count = static_cast<std::ptrdiff_t>(files_.size());
    const std::ptrdiff_t there = (static_cast<std::ptrdiff_t>(current_) + steps) % count;
    current_ = static_cast<std::size_t>((there + count) % count);
}

void FileList::insert(const std::vector<std::filesystem::path>& files) {
    if (files.empty()) return;
    ++current_;
    files_.insert(files_.begin() + static_cast<std::ptrdiff_t>(current_), files.begin(),
                  files.end());
}

std::string FileList::place() const {
    if (files_.size() == 1) return {};
    return fmt::format("{} of {}", current_ + 1, files_.size());
}

}  // namespace cw2
