// The files that a user goes through.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace cw2 {

class FileList {
 public:
    /// Begins at the first. There is at least one.
    explicit FileList(std::vector<std::filesystem::path> files);

    const std::filesystem::path& current() const { return files_[current_]; }
    /// Goes on by `steps`, negative ones back; the last one is followed by the first.
    void go(int steps);
    /// Puts files behind the current one, and goes to the first of them.
    void insert(const std::vector<std::filesystem::path>& files);
    /// Such as "2 of 5"; empty where there is but one.
    std::string place() const;

 private:
    std::vector<std::filesystem::path> files_;
    std::size_t current_ = 0;
};

}  // namespace cw2
