// A file on its way to become a scene, while another one is shown.
#pragma once

#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "cw2/options/options.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/scene.h"
#include "cw2/source_bake.h"
#include "cw2/vulkan/device.h"
#include "cw2/window/file_watch.h"

namespace cw2 {

/// It is baked by a process, if it has to be, then loaded by a thread.
class SceneOpening {
 public:
    /// Begins with options.scene, for a device and layouts that outlive this; what cw2-bake says is
    /// told to the user. Throws common::FileError.
    SceneOpening(const Device& device, const Layouts& layouts, const Options& options);
    SceneOpening(const SceneOpening&) = delete;
    SceneOpening& operator=(const SceneOpening&) = delete;

    /// The scene once it is there, until then null; waits for nothing. Throws std::runtime_error
    /// with the reason why there will be none: DeviceLost where that is it.
    std::unique_ptr<Scene> take();
    /// Whether a thread loads it; then the destructor waits.
    bool loads() const { return scene_.valid(); }
    /// How far it is, for those who have waited for a while; else empty.
    std::string progress() const;
    /// The first line of cw2-bake's, empty where it said nothing.
    const std::string& warning() const { return warning_; }
    /// What the scene is made of, once take() gave it.
    const FileWatch& watch() const { return *watch_; }

 private:
    using Clock = std::chrono::steady_clock;

    void begin_loading();

    const Device& device_;
    const Layouts& layouts_;
    std::filesystem::path path_;
    TextureSettings textures_;
    std::string warning_;
    std::unique_ptr<SourceBake> bake_;  ///< null if it is baked already
    std::optional<FileWatch> watch_;
    Clock::time_point loading_since_;
    std::future<std::unique_ptr<Scene>> scene_;  ///< destroyed first, which waits
};

}  // namespace cw2
