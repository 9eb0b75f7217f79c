// Where the running program is.
#pragma once

#include <filesystem>

namespace common {

/// A file or folder that is installed with the running program; `path` is relative to the
/// program's folder. Whether it exists is not asked.
std::filesystem::path beside_program(const std::filesystem::path& path);

}  // namespace common
