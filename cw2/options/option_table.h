// Every option of cw2: how it is read from a command line or a config file, and written to one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cw2/options/options.h"

namespace cw2 {

/// One option: on the command line and, by the same name, in a config file.
struct Setting {
    std::string name;         ///< without dashes
    std::string form;         ///< of its value; empty: a flag, whose value is true or false
    std::string description;  ///< for --help
    /// Takes over a value. Returns what is wrong with it, or nothing.
    std::function<std::string(Options&, const std::string&)> read;
    /// The value in TOML; empty where nothing has set it.
    std::function<std::string(const Options&)> write;

    /// As CLI11 is told: SCENE has no dashes.
    std::string command_line_name() const {
        return name == "scene" ? "SCENE" : name == "output" ? "-o,--output" : "--" + name;
    }
};

/// All of them, in the order of --help.
std::vector<Setting> all_settings();

}  // namespace cw2
