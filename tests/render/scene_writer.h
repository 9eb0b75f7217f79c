// OBJ, MTL and PNG files of small test scenes.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

/// A corner of a polygon; what the polygon's attributes leave out is not written.
struct Corner {
    glm::dvec3 position;
    glm::dvec2 uv{0.0};
    glm::dvec3 normal{0.0};
    std::optional<glm::dvec3> color{};  ///< sRGB-encoded
};

enum class Attributes { positions, uvs, normals, both };

/// Writes FOLDER/NAME.obj and FOLDER/NAME.mtl. Six decimals, so that the last digit of a sine does
/// not matter.
class SceneWriter {
 public:
    /// `turn` is applied to every position and normal.
    SceneWriter(const std::filesystem::path& folder, const std::string& name,
                std::function<glm::dvec3(glm::dvec3)> turn = {});

    /// Adds a material of these MTL lines, and uses it for what follows.
    void material(const std::string& name, const std::vector<std::string>& lines);
    void line(const std::string& text);
    void polygon(const std::vector<Corner>& corners, Attributes attributes = Attributes::both);

    /// A parallelogram with corners at uv (0, 0), (1, 0), (1, 1), (0, 1) times `repeat`.
    void quad(glm::dvec3 origin, glm::dvec3 right, glm::dvec3 up, glm::dvec2 repeat = {1.0, 1.0});
    void sphere(glm::dvec3 center, double radius, int slices, int rings,
                Attributes attributes = Attributes::both);
    /// Turned about y; each side shows the whole texture.
    void cube(glm::dvec3 center, double half, double degrees);

 private:
    std::ofstream obj_;
    std::ofstream mtl_;
    std::function<glm::dvec3(glm::dvec3)> turn_;
};
