#include "cw2-bake/weld.h"

#include <tbb/parallel_invoke.h>

#include <cassert>

#include "cw2-bake/index_set.h"

namespace bake {
namespace {

/// For each element of the scene's arrays the first equal one; the last of `uvs` stands for a
/// corner with no UV.
struct Representatives {
    std::vector<std::uint32_t> positions, normals, uvs;
};

Representatives find_representatives(const SourceScene& scene) {
    Representatives result;
    const auto uvs = [&] {
        std::vector<glm::vec2> with_absent = scene.uvs;
        with_absent.emplace_back(0.0f);
        result.uvs = first_equal(std::span<const glm::vec2>(with_absent));
    };
    tbb::parallel_invoke(
        [&] { result.positions = first_equal(std::span<const glm::vec3>(scene.positions)); },
        [&] { result.normals = first_equal(std::span<const glm::vec3>(scene.normals)); }, uvs);
    return result;
}

/// A vertex, in terms of representatives.
struct Vertex {
    Corner corner;
    std::uint32_t material;
    std::uint32_t index;  ///< in its mesh

    bool is(const Corner& other, std::uint32_t other_material) const {
        return corner.position == other.position && corner.normal == other.normal &&
               corner.uv == other.uv && material == other_material;
    }
};

/// Fills the meshes' indices, and returns all vertices in the order of their first use.
std::vector<Vertex> index_corners(const SourceScene& scene, std::vector<WeldedMesh>& meshes) {
    const Representatives first = find_representatives(scene);
    std::vector<std::uint32_t> vertex_counts(meshes.size(), 0);
    std::vector<Vertex> vertices;
    PlacedIndexSet set(scene.positions.size());
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        const Corner& source = scene.corners[i];
        assert(source.normal != kAbsent);
        const std::uint32_t material = scene.triangle_material[i / 3];
        const std::size_t uv = source.uv == kAbsent ? scene.uvs.size() : source.uv;
        const Corner corner{first.positions[source.position], first.normals[source.normal],
                            first.uvs[uv]};
        const std::uint32_t found = set.find_or_insert(
            corner.position, hash_of(corner.position, corner.normal, corner.uv, material),
            [&](std::uint32_t v) { return vertices[v].is(corner, material); });
        if (found == vertices.size())
            vertices.push_back({corner, material, vertex_counts[material]++});
        meshes[material].indices.push_back(vertices[found].index);
        if (!scene.tangents.empty()) meshes[material].tangents.push_back(scene.tangents[i]);
    }
    return vertices;
}

}  // namespace

std::vector<WeldedMesh> weld(const SourceScene& scene) {
    std::vector<WeldedMesh> meshes(scene.materials.size());
    std::vector<std::size_t> triangle_counts(meshes.size(), 0);
    for (const std::uint32_t material : scene.triangle_material) ++triangle_counts[material];
    for (std::uint32_t m = 0; m < meshes.size(); ++m) {
        meshes[m].material = m;
        meshes[m].indices.reserve(3 * triangle_counts[m]);
    }
    const std::vector<Vertex> vertices = index_corners(scene, meshes);

    std::vector<std::size_t> vertex_counts(meshes.size(), 0);
    for (const Vertex& vertex : vertices) ++vertex_counts[vertex.material];
    for (WeldedMesh& mesh : meshes) {
        mesh.positions.reserve(vertex_counts[mesh.material]);
        mesh.normals.reserve(vertex_counts[mesh.material]);
        mesh.uvs.reserve(vertex_counts[mesh.material]);
    }
    for (const Vertex& vertex : vertices) {
        WeldedMesh& mesh = meshes[vertex.material];
        mesh.positions.push_back(scene.positions[vertex.corner.position]);
        mesh.normals.push_back(scene.normals[vertex.corner.normal]);
        const bool has_uv = vertex.corner.uv < scene.uvs.size();
        mesh.uvs.push_back(has_uv ? scene.uvs[vertex.corner.uv] : glm::vec2{0.0f});
    }
    std::erase_if(meshes, [](const WeldedMesh& mesh) { return mesh.indices.empty(); });
    return meshes;
}

}  // namespace bake
