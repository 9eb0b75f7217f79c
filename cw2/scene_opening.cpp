#include "cw2/scene_opening.h"

#include <fmt/format.h>

#include <new>
#include <utility>
#include <vector>

#include "cw2/options/frame_of.h"
#include "cw2/render/scene_file.h"

namespace cw2 {

namespace {

/// How long something may load before one says so.
constexpr std::chrono::milliseconds kPatience(300);

}  // namespace

SceneOpening::SceneOpening(const Device& device, const Layouts& layouts, const Options& options)
    : device_(device),
      layouts_(layouts),
      path_(options.scene),
      textures_(texture_settings(options, device)),
      bake_(bake_of(options, device, [this](const std::string& line) {
          tell_user(line);
          if (warning_.empty()) warning_ = line;
      })) {}

std::unique_ptr<Scene> SceneOpening::take() {
    constexpr std::chrono::milliseconds kAtOnce(0);
    if (!loads()) {
        if (bake_ && !bake_->done(kAtOnce)) return nullptr;
        begin_loading();
    }
    return scene_.wait_for(kAtOnce) == std::future_status::ready ? scene_.get() : nullptr;
}

void SceneOpening::begin_loading() {
    if (bake_) {
        watch_.emplace(bake_->sources(), bake_->read_at());
    } else {
        watch_.emplace(std::vector{path_});
    }
    loading_since_ = Clock::now();
    scene_ = std::async(std::launch::async, [this, path = bake_ ? bake_->baked() : path_] {
        SceneFile file = read_scene_file(path);
        try {
            return std::make_unique<Scene>(
                make_scene(device_, layouts_, std::move(file), textures_));
        } catch (const std::bad_alloc&) {
            refuse_for_memory(path);
        } catch (const DeviceLost&) {
            throw;
        } catch (const VulkanError& error) {
            throw VulkanError(path.string() + ": " + error.what());
        }
    });
}

std::string SceneOpening::progress() const {
    const std::string name = path_.filename().string();
    if (!loads()) return fmt::format("baking {} {}", name, bake_->progress());
    return Clock::now() - loading_since_ < kPatience ? std::string() : "loading " + name;
}

}  // namespace cw2
