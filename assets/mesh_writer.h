// A model as Wavefront OBJ, its materials as MTL.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "assets/model.h"

namespace assets {

/// One material of the MTL; file names are relative to it and may be empty. A map multiplies its
/// factor; the factors of absent maps stand alone.
struct MaterialStatement {
    std::string name;
    glm::vec3 base_color{1.0f};  ///< linear
    float roughness = 1.0f;
    float metalness = 0.0f;
    std::string base_color_map;  ///< sRGB
    std::string roughness_map;
    std::string metalness_map;
    std::string normal_map;
    std::string alpha_map;
};

/// Throws std::runtime_error where a file cannot be written. Equal attributes are written once;
/// positions are rounded to 0.01 mm, normals and UVs to 1e-5.
void write_obj(const std::filesystem::path& path, const std::string& mtl_name, const Model& model);
void write_mtl(const std::filesystem::path& path, std::span<const MaterialStatement> materials);

}  // namespace assets
