// The pixel whose numbers a user reads.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "cw2/render/picker.h"
#include "cw2/window/viewer_state.h"

namespace cw2 {

class PixelReader {
 public:
    /// `device` and `layouts` must outlive this. Throws VulkanError.
    PixelReader(const Device& device, const Layouts& layouts, const ShaderCode& code)
        : picker_(device, layouts, code) {}

    /// What a picture of this `extent` shows at a place in pixels, in the world; nothing where that
    /// is the background, or outside.
    std::optional<glm::vec3> surface(const Scene& scene, const ViewerState& state,
                                     VkExtent2D extent, const glm::vec2& where);

    /// Chooses the pixel, and reads it.
    void choose(const Scene& scene, const ViewerState& state, VkExtent2D extent,
                const glm::vec2& where);
    /// Reads the chosen pixel again, as it is now.
    void read(const Scene& scene, const ViewerState& state, VkExtent2D extent);
    /// The scene is another now. `keeps_pixel`: what it shows there is read from now on.
    void forget(bool keeps_pixel);

    /// Nothing where no pixel is chosen, or it shows the background.
    const std::optional<Pick>& pick() const { return pick_; }
    /// Of the surface that was chosen last.
    const std::optional<std::uint32_t>& material() const { return material_; }

    /// Throws VulkanError, and keeps the old ones.
    void use_shaders(const ShaderCode& code) { picker_.use_shaders(code); }

 private:
    Picker picker_;
    std::optional<glm::uvec2> pixel_;
    std::optional<Pick> pick_;
    std::optional<std::uint32_t> material_;
};

}  // namespace cw2
