// Git LFS leaves a small text in place of a file whose contents were not fetched.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace common {

/// What is wrong with such a file, behind its name.
inline constexpr std::string_view kIsLfsPointer =
    "is a Git LFS pointer, not the file; git lfs pull fetches it";

/// Whether `contents` begin with the line that the specification of Git LFS asks of a pointer.
inline bool is_lfs_pointer(std::span<const std::byte> contents) {
    constexpr std::string_view kFirstLine = "version https://git-lfs.github.com/spec/v1";
    return std::string_view(reinterpret_cast<const char*>(contents.data()), contents.size())
        .starts_with(kFirstLine);
}

}  // namespace common
