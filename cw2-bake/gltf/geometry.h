// A baked scene's meshes as glTF's accessors and the bytes that they read.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "mesh-format/file.h"

namespace bake {

/// Arrays of the glTF. Views of buffer 0 lie one after the other in `bytes`, each at a multiple of
/// 4.
struct GltfGeometry {
    std::vector<std::byte> bytes;
    nlohmann::ordered_json views = nlohmann::ordered_json::array();
    nlohmann::ordered_json accessors = nlohmann::ordered_json::array();
    nlohmann::ordered_json primitives = nlohmann::ordered_json::array();
    glm::vec3 low, high;  ///< bounding box
};

/// Everything as 32-bit floats, which every viewer reads; colours of 16 bits, indices of 16 bits
/// but where a mesh has so many vertices that one would mean a restart. The document's geometry is
/// not encoded.
GltfGeometry make_gltf_geometry(const mesh_format::Document& document);

}  // namespace bake
