#include "tests/oracle/corner_mesh.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <unordered_map>

#include "cw2-bake/normals.h"
#include "cw2-bake/read_obj.h"
#include "cw2-bake/tangents.h"

namespace oracle {
namespace {

using Key = std::array<float, 8>;

struct KeyHash {
    std::size_t operator()(const Key& key) const {
        std::size_t hash = 0;
        for (const float x : key) hash = hash * 1'000'003 + std::hash<float>{}(x);
        return hash;
    }
};

}  // namespace

IndexedMesh weld(const CornerMesh& mesh) {
    IndexedMesh welded;
    std::unordered_map<Key, std::uint32_t, KeyHash> vertex_of;
    for (std::size_t c = 0; c < mesh.positions.size(); ++c) {
        const glm::vec3& p = mesh.positions[c];
        const glm::vec3& n = mesh.normals[c];
        const glm::vec2& uv = mesh.uvs[c];
        const auto [found, added] =
            vertex_of.try_emplace(Key{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y},
                                  static_cast<std::uint32_t>(welded.positions.size()));
        if (added) {
            welded.positions.push_back(p);
            welded.normals.push_back(n);
            welded.uvs.push_back(uv);
        }
        welded.indices.push_back(found->second);
    }
    return welded;
}

IndexedMesh renumber(const IndexedMesh& mesh, std::uint32_t seed) {
    std::vector<std::uint32_t> new_number(mesh.positions.size());
    std::iota(new_number.begin(), new_number.end(), 0u);
    std::shuffle(new_number.begin(), new_number.end(), std::mt19937(seed));
    IndexedMesh renumbered = mesh;
    for (std::size_t v = 0; v < new_number.size(); ++v) {
        renumbered.positions[new_number[v]] = mesh.positions[v];
        renumbered.normals[new_number[v]] = mesh.normals[v];
        renumbered.uvs[new_number[v]] = mesh.uvs[v];
    }
    for (std::uint32_t& index : renumbered.indices) index = new_number[index];
    return renumbered;
}

std::vector<glm::vec4> our_tangents(const IndexedMesh& mesh) {
    return bake::generate_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.indices);
}

std::vector<CornerMesh> read_obj_by_material(const std::filesystem::path& path) {
    bake::SourceScene scene = bake::read_obj(path, [](const std::string&) {});
    bake::generate_normals(scene);
    std::vector<CornerMesh> meshes(scene.materials.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) meshes[i].name = scene.materials[i].name;
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        const bake::Corner& corner = scene.corners[i];
        CornerMesh& mesh = meshes[scene.triangle_material[i / 3]];
        mesh.positions.push_back(scene.positions[corner.position]);
        mesh.normals.push_back(scene.normals[corner.normal]);
        mesh.uvs.push_back(corner.uv == bake::kAbsent ? glm::vec2(0.0f) : scene.uvs[corner.uv]);
    }
    return meshes;
}

}  // namespace oracle
