// The demo scene in memory: parts, each a mesh with one material.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace assets {

inline constexpr std::uint32_t kNoCorner = 0xFFFF'FFFF;

/// World space: metres, right-handed, +Y up. `normal` has unit length; v = 0 is the bottom row.
struct Vertex {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec2 uv;
};

/// Counter-clockwise seen from outside; corner[3] is kNoCorner in a triangle.
using Face = std::array<std::uint32_t, 4>;

struct Mesh {
    std::vector<Vertex> vertices;
    std::vector<Face> faces;
};

struct Part {
    std::string name;
    std::string material;
    Mesh mesh;
};

/// Adds copies of `from`, moved by a rigid motion with a uniform scale (no reflection).
void append(Mesh& to, const Mesh& from, const glm::mat4& to_from_local = glm::mat4(1.0f));

/// Gathers meshes under (name, material), in order of first use.
class Model {
 public:
    /// The part's mesh, made when it is first asked for; the reference stays valid.
    Mesh& part(const std::string& name, const std::string& material);
    const std::deque<Part>& parts() const { return parts_; }

 private:
    std::deque<Part> parts_;
};

std::size_t count_triangles(const Model& model);

}  // namespace assets
