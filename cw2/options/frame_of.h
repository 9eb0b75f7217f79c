// From options, a scene and a device to what is drawn.
#pragma once

#include "cw2/options/options.h"
#include "cw2/render/frame_settings.h"
#include "cw2/render/scene.h"
#include "cw2/vulkan/device.h"

namespace cw2 {

/// The options with what the scene asks for where they leave it open: its camera if they state
/// neither position nor target, its light's position and colour.
Options completed(Options options, const SceneStart& start, const Bounds& bounds);

/// What the options ask a frame to show of a scene of these bounds, at the start of the light's
/// orbit. `aspect` is the picture's width / height.
FrameSettings frame_settings(const Options& options, const Bounds& bounds, float aspect);

/// Throws VulkanError where the device cannot render pictures of the size in the options.
void require_size(const Options& options, const Device& device);

/// How the options and the device want textures.
TextureSettings texture_settings(const Options& options, const Device& device);

}  // namespace cw2
