#include "tests/oracle/corner_mesh.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "cw2-bake/geometry/normals.h"
#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/geometry/weld.h"
#include "cw2-bake/obj/read_obj.h"

namespace oracle {
namespace {

/// Moves the elements to other places, and `index_of(corner)` along with them.
template <typename Vector, typename IndexOf>
void shuffle(std::vector<Vector>& values, std::vector<bake::Corner>& corners, IndexOf index_of,
             std::mt19937& random) {
    std::vector<std::uint32_t> place(values.size());
    std::iota(place.begin(), place.end(), 0u);
    std::shuffle(place.begin(), place.end(), random);
    const std::vector<Vector> old = values;
    for (std::size_t i = 0; i < old.size(); ++i) values[place[i]] = old[i];
    for (bake::Corner& corner : corners) index_of(corner) = place[index_of(corner)];
}

}  // namespace

bake::SourceScene scene_of(const CornerMesh& mesh) {
    bake::SourceScene scene;
    for (std::uint32_t c = 0; c < mesh.positions.size(); ++c) {
        // No -0, as from a reader.
        scene.positions.push_back(mesh.positions[c] + 0.0f);
        scene.normals.push_back(mesh.normals[c] + 0.0f);
        scene.uvs.push_back(mesh.uvs[c] + 0.0f);
        scene.corners.push_back({c, c, c});
    }
    scene.triangle_material.extend(scene.corners.size() / 3, 0);
    scene.materials.resize(1);
    return scene;
}

bake::SourceScene renumber(const bake::SourceScene& scene, std::uint32_t seed) {
    std::mt19937 random(seed);
    bake::SourceScene result = scene;
    using bake::Corner;
    shuffle(
        result.positions, result.corners, [](Corner & c) -> auto& { return c.position; }, random);
    shuffle(
        result.normals, result.corners, [](Corner & c) -> auto& { return c.normal; }, random);
    shuffle(
        result.uvs, result.corners, [](Corner & c) -> auto& { return c.uv; }, random);
    return result;
}

std::vector<glm::vec4> our_tangents(const bake::SourceScene& scene, bool in_space) {
    bake::SourceScene rest = scene;
    const bake::FirstEqual positions(rest.positions);
    bake::FramedTriangles framed =
        in_space ? bake::weld_in_space(rest, positions) : bake::weld(rest, positions);
    bake::add_tangents(rest, framed);
    std::vector<glm::vec4> tangents(framed.indices.size());
    for (std::uint32_t c = 0; c < tangents.size(); ++c)
        tangents[framed.source_of(c)] = framed.vertices[framed.indices[c]].tangent;
    return tangents;
}

std::vector<CornerMesh> read_obj_by_material(const std::filesystem::path& path) {
    bake::SourceScene scene = bake::read_obj(path, [](const std::string&) {});
    bake::generate_normals(scene, bake::FirstEqual(scene.positions));
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
