// Where the running program is.
#pragma once

#include <filesystem>
#include <string>

namespace common {

/// A file or folder that is installed with the running program; `path` is relative to the
/// program's folder. Whether it exists is not asked.
std::filesystem::path beside_program(const std::filesystem::path& path);

/// What a module calls `symbol`; `path` is as beside_program() takes it. The module stays loaded.
/// Null, and why in `error`, where it cannot be had.
void* load_symbol(const std::filesystem::path& path, const char* symbol, std::string& error);

}  // namespace common
