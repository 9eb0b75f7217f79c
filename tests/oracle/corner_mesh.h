// Triangles as MikkTSpace takes them, every corner with attributes of its own, and as ours does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "cw2-bake/base/source_scene.h"

namespace oracle {

struct CornerMesh {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> uvs;
};

/// The mesh as a scene of one material.
bake::SourceScene scene_of(const CornerMesh& mesh);

/// The same triangles in the same order over attributes in another order.
bake::SourceScene renumber(const bake::SourceScene& scene, std::uint32_t seed);

/// Our tangents of a scene, one a corner, of triangles in the order of the source or of space.
std::vector<glm::vec4> our_tangents(const bake::SourceScene& scene, bool in_space = false);

/// The meshes that are small enough to have recorded results, about 15,000 corners in all.
std::vector<CornerMesh> small_meshes();

/// The meshes for the living oracle only, about 580,000 corners in all.
std::vector<CornerMesh> large_meshes();

/// One mesh a material of an OBJ, as the bake reads it.
std::vector<CornerMesh> read_obj_by_material(const std::filesystem::path& path);

}  // namespace oracle
