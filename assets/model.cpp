#include "assets/model.h"

namespace assets {

void append(Mesh& to, const Mesh& from, const glm::mat4& to_from_local) {
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    const glm::mat3 linear(to_from_local);
    for (const Vertex& vertex : from.vertices) {
        to.vertices.push_back({glm::vec3(to_from_local * glm::vec4(vertex.position, 1.0f)),
                               glm::normalize(linear * vertex.normal), vertex.uv});
    }
    for (Face face : from.faces) {
        for (std::uint32_t& corner : face) corner += corner == kNoCorner ? 0 : base;
        to.faces.push_back(face);
    }
}

Mesh& Model::part(const std::string& name, const std::string& material) {
    for (Part& part : parts_) {
        if (part.name == name && part.material == material) return part.mesh;
    }
    return parts_.emplace_back(Part{name, material, {}}).mesh;
}

std::size_t count_triangles(const Model& model) {
    std::size_t triangles = 0;
    for (const Part& part : model.parts()) {
        for (const Face& face : part.mesh.faces) triangles += face[3] == kNoCorner ? 1 : 2;
    }
    return triangles;
}

}  // namespace assets
