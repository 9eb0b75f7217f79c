#include "cw2/window/pixel_reader.h"

#include <glm/common.hpp>

namespace cw2 {

namespace {

glm::uvec2 pixel_at(const glm::vec2& where) {
    return glm::uvec2(glm::max(where, glm::vec2(0.0f)));
}

bool has(VkExtent2D extent, const glm::uvec2& pixel) {
    return pixel.x < extent.width && pixel.y < extent.height;
}

}  // namespace

std::optional<glm::vec3> PixelReader::surface(const Scene& scene, const ViewerState& state,
                                              VkExtent2D extent, const glm::vec2& where) {
    const glm::uvec2 pixel = pixel_at(where);
    if (!has(extent, pixel)) return std::nullopt;
    const std::optional<Pick> there = picker_.pick(scene, state.settings(), extent, pixel);
    if (!there) return std::nullopt;
    return from_user(there->position, state.bounds());
}

void PixelReader::choose(const Scene& scene, const ViewerState& state, VkExtent2D extent,
                         const glm::vec2& where) {
    pixel_ = pixel_at(where);
    read(scene, state, extent);
    if (pick_) material_ = pick_->material;
}

void PixelReader::read(const Scene& scene, const ViewerState& state, VkExtent2D extent) {
    pick_.reset();
    if (!pixel_ || !has(extent, *pixel_)) return;
    pick_ = picker_.pick(scene, state.settings(), extent, *pixel_);
}

void PixelReader::forget(bool keeps_pixel) {
    if (!keeps_pixel) pixel_.reset();
    pick_.reset();  // it names a material of the old scene
    material_.reset();
}

}  // namespace cw2
