// Scenes that are not baked yet: cw2-bake makes them into the user's cache.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cw2/options/options.h"
#include "cw2/vulkan/device.h"

namespace cw2 {

/// What makes one bake of a file another than the next.
struct BakeSettings {
    bool z_up = false;          ///< --up z
    bool strict = false;        ///< --strict
    bool restricted = false;    ///< --restrict
    bool uncompressed = false;  ///< textures without blocks, for devices that would decode them
};

/// A baked form of an OBJ or a glTF: one of the cache, if neither the source, nor a file that it
/// names, nor the baker has changed since it was made, else made by running the cw2-bake that
/// stands beside this program. The cache is the folder cw2 in $XDG_CACHE_HOME or ~/.cache; beyond
/// 2 GiB what was not used for longest goes. Where it cannot be written the file is a temporary
/// one. Programs that run at the same time share the cache.
class SourceBake {
 public:
    /// Begins. `tell` is given each line of cw2-bake's, warnings of earlier bakes again. Throws
    /// common::FileError where `source` or cw2-bake is missing.
    SourceBake(const std::filesystem::path& source, const BakeSettings& settings,
               std::function<void(const std::string& line)> tell);
    /// Ends cw2-bake, if it still runs, and removes a temporary file; so do signals that end this
    /// program.
    ~SourceBake();
    SourceBake(const SourceBake&) = delete;
    SourceBake& operator=(const SourceBake&) = delete;

    /// Waits for at most `patience`; true once baked() is there; a temporary one stays until this
    /// is destroyed. Throws common::FileError with what cw2-bake says is wrong.
    bool done(std::chrono::milliseconds patience);

    const std::filesystem::path& baked() const { return baked_; }
    /// What it was made of, files that are missing included; once done.
    const std::vector<std::filesystem::path>& sources() const { return sources_; }
    /// What is written to them from then on may not be in it; once done.
    std::chrono::system_clock::time_point read_at() const { return read_at_; }
    /// How far cw2-bake says it is; empty while it says nothing.
    const std::string& progress() const { return progress_; }

 private:
    bool lock();
    bool reuse();
    void start();
    bool read_output(std::chrono::milliseconds patience);
    void take(std::string_view text);
    std::string as_given(std::string line) const;
    bool finish();
    void note_sources();
    void remove_old_entries() const;
    std::filesystem::path depfile() const;

    std::filesystem::path source_;           ///< absolute
    std::filesystem::path folder_as_given_;  ///< with a slash; empty where that was absolute, too
    std::filesystem::path baker_;
    std::vector<std::string> options_;
    std::function<void(const std::string&)> tell_;
    std::string key_;
    std::filesystem::path folder_;  ///< of the cache, or a temporary one
    bool is_temporary_ = false;
    std::filesystem::path baked_;
    std::vector<std::filesystem::path> sources_;
    std::vector<std::string> lines_;
    std::string progress_;
    std::string text_;  ///< of the line at hand
    std::chrono::system_clock::time_point read_at_;
    bool has_depfile_ = true;
    bool is_done_ = false;
    int lock_ = -1;
    int output_ = -1;
    pid_t process_ = -1;
};

/// The bake of the scene that the options name, in the form that suits the device; null if it is
/// baked already. `tell` is given what cw2-bake says.
std::unique_ptr<SourceBake> bake_of(const Options& options, const Device& device,
                                    std::function<void(const std::string& line)> tell);

/// Prints a line to standard error.
void tell_user(const std::string& line);

/// Waits until it is done, and shows on a terminal how far it is. Throws as done() does.
void wait_for(SourceBake& bake);

}  // namespace cw2
