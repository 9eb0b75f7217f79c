// Programs as a user runs them.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <memory>
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

/// A program that runs, with no standard input.
class Running {
 public:
    /// `command` is the program's path and its arguments.
    explicit Running(const std::vector<std::string>& command,
                     const Surroundings& surroundings = {});
    /// Kills it, if nobody has waited.
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    pid_t process() const { return process_; }
    /// Waits for its end. Throws std::runtime_error if it could not be started.
    Outcome wait();

 private:
    using File = std::unique_ptr<FILE, int (*)(FILE*)>;
    std::string program_;
    File out_;
    File err_;
    pid_t process_;
};

/// Runs `command` and waits. Throws std::runtime_error if it cannot be started.
Outcome run(const std::vector<std::string>& command, const Surroundings& surroundings = {});
