// A baked scene on a device of its own, for tests that call the renderer's parts themselves.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cw2/options/frame_of.h"
#include "cw2/options/options.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/scene.h"
#include "cw2/vulkan/device.h"

/// With the settings that words of the command line say, and all levels of its textures from those
/// that are named on; validation messages are failures.
class LoadedScene {
 public:
    LoadedScene(const std::filesystem::path& path, const std::vector<std::string>& words,
                VkExtent2D extent, const std::vector<std::uint32_t>& first_levels = {}) {
        std::vector<const char*> arguments{"cw2", path.c_str(), "--output", "ignored.exr"};
        for (const std::string& word : words) arguments.push_back(word.c_str());
        const auto options =
            cw2::parse_options(static_cast<int>(arguments.size()), arguments.data());
        cw2::SceneFile file = cw2::load_scene_file(path);
        scene_ = std::make_unique<cw2::Scene>(device_, file);
        scene_->make_textures(device_, layouts_, file, cw2::texture_settings(*options, device_),
                              first_levels);
        scene_->write_textures(device_, file);
        settings_ = cw2::frame_settings(
            *options, scene_->bounds(),
            static_cast<float>(extent.width) / static_cast<float>(extent.height));
        settings_.light.position =
            cw2::orbit(settings_.light.position, scene_->bounds().center, options->time);
    }
    ~LoadedScene() { EXPECT_EQ(instance_.validation_messages(), 0); }
    LoadedScene(const LoadedScene&) = delete;
    LoadedScene& operator=(const LoadedScene&) = delete;

    const cw2::Device& device() const { return device_; }
    const cw2::Layouts& layouts() const { return layouts_; }
    const cw2::Scene& scene() const { return *scene_; }
    const cw2::FrameSettings& settings() const { return settings_; }

 private:
    cw2::Instance instance_{true, {}};
    cw2::Device device_{instance_, std::nullopt};
    cw2::Layouts layouts_{device_};
    std::unique_ptr<cw2::Scene> scene_;
    cw2::FrameSettings settings_;
};
