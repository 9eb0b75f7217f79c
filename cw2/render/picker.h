// What a picture shows at one pixel, in numbers.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

#include "cw2/render/renderer.h"

namespace cw2 {

/// A point of a surface and the terms of its shading; colours are linear.
struct Pick {
    glm::uvec2 pixel;        ///< from the upper left corner
    std::uint32_t material;  ///< index into Scene::material_names
    glm::dvec3 position;     ///< in the user's coordinates
    glm::vec3 normal;        ///< that shades; it and the next two are of unit length
    glm::vec3 to_light;
    glm::vec3 to_camera;
    glm::vec3 base_color;
    glm::vec3 vertex_color;  ///< a factor of the base colour; white where the mesh has none
    glm::vec3 emission;      ///< 1 is as bright as white paper
    bool unlit;              ///< the base colour is what is seen
    float roughness;
    float metalness;
    float distribution;  ///< D
    float masking;       ///< G
    glm::vec3 fresnel;   ///< F
    glm::vec3 diffuse;   ///< before light colour and n.l
    glm::vec3 specular;  ///< the same
    glm::vec3 shaded;    ///< the sum, lit

    // Cosines, clamped at 0.
    float n_dot_l() const;
    float n_dot_v() const;
    float n_dot_h() const;
    float v_dot_h() const;
};

/// All of it in one line of text.
std::string describe(const Pick& pick, const std::string& material);

/// All of it as a JSON object; `material` is its name. Of the background only the pixel is known.
std::string json_of(glm::uvec2 pixel, const std::optional<Pick>& pick, const std::string& material);

class Picker {
 public:
    /// `device` and `layouts` must outlive this. Throws VulkanError.
    Picker(const Device& device, const Layouts& layouts, const ShaderCode& code);

    /// Reads the centre of a pixel of the picture that `settings` show in `extent`, with the maps
    /// of the side it is on where there is a split, and what is done to values for the eye left
    /// out; nothing where it shows the background. Takes as long as drawing the little that is
    /// there, but for the first time. Throws VulkanError.
    std::optional<Pick> pick(const Scene& scene, const FrameSettings& settings, VkExtent2D extent,
                             glm::uvec2 pixel);

    /// From now on reads what these shaders draw. Throws VulkanError, and keeps the old ones.
    void use_shaders(const ShaderCode& code) { renderer_.use_shaders(code); }

 private:
    void fit(VkExtent2D extent);

    const Device& device_;
    Renderer renderer_;
    Image image_;
    VkExtent2D extent_{};
    Buffer values_;
    CommandPool pool_;
    VkCommandBuffer commands_;
};

}  // namespace cw2
