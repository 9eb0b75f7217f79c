// Config files: one `key = value` a line, in TOML.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace cw2 {

/// A command line or a config file that does not make sense; what() is one line.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct ConfigEntry {
    std::string key;
    /// As the command line would have it: strings without their quotes, the elements of an array
    /// with commas between, anything else as it is written.
    std::string value;
    int line;  ///< of the key, counted from 1
};

/// Reads the TOML of a config file: top-level keys, each once, whose values are strings, numbers,
/// booleans, or arrays of these; in the file's order. (CLI11's own reader cuts strings at '#' and
/// knows neither escapes nor lines.) Throws common::FileError where the file cannot be read,
/// and UsageError "PATH:LINE: what is wrong".
std::vector<ConfigEntry> read_config(const std::filesystem::path& path);

}  // namespace cw2
