// What a program leaves behind when a signal ends it: no temporary files, and a message where a
// file that it has mapped became shorter.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>
#include <string>

namespace common {

/// For the start of main(). From then on SIGHUP, SIGINT, SIGQUIT, SIGABRT, SIGPIPE, SIGTERM and
/// SIGXCPU remove what is noted here before they end the program, and so does an exception that
/// nobody catches, with its message and status 1; reading a guarded mapping where its file
/// has no more bytes removes it, too, and ends the program with status 1 and a line that begins
/// with `program`; and a file beyond the limit of sizes is an error of write(). A signal that is
/// ignored stays so. Descriptors 0 to 2 are open afterwards, so that no file gets their place.
void handle_signals(const char* program);

/// Makes a file that must not outlive the program; its descriptor, or -1 and errno.
int create_temporary(const std::string& path, mode_t mode);
/// Notes what is there, or will be: a file or an empty folder. The last that was noted goes first.
void note_temporary(const std::string& path);
/// Removes it, if it is there; false and errno where that fails.
bool remove_temporary(const std::string& path);

/// A process that is to be ended first, since it may write into temporary folders; 0: none any
/// more.
void note_child(pid_t child);

/// `path` is what the message names.
void guard_mapping(std::span<const std::byte> bytes, const std::string& path);
void unguard_mapping(std::span<const std::byte> bytes);

}  // namespace common
