// Programs as a user runs them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// How a program ended and what it printed.
struct Outcome {
    int status;  ///< exit status; 128 + the signal's number if a signal ended it
    std::string out;
    std::string err;
};

/// What is different from the caller's surroundings.
struct Surroundings {
    std::vector<std::string> environment;  ///< "NAME=VALUE", each added or replaced
    std::filesystem::path folder;          ///< to run in; empty: the caller's
};

/// Runs `command`, the program's path and its arguments, with no standard input, and waits.
/// Throws std::runtime_error if it cannot be started.
Outcome run(const std::vector<std::string>& command, const Surroundings& surroundings = {});
