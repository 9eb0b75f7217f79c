// What a bake says of the file that it has written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "mesh-format/file.h"

namespace bake {

struct Counts {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    std::size_t masked_materials = 0;
    std::size_t wide_meshes = 0;     ///< whose UVs 16 bits would not hold exactly enough
    std::uint64_t vertex_bytes = 0;  ///< as stored
    std::uint64_t index_bytes = 0;
    std::uint64_t texel_bytes = 0;
    float extent = 0.0f;  ///< longest side of the bounding box
};

Counts count(const mesh_format::Document& document);

/// 1234567 -> "1,234,567".
std::string grouped(std::uint64_t number);

/// The closing summary of a bake: counts, bytes by kind, measured errors. A few lines.
std::string summary(const mesh_format::Document& document, std::uint64_t file_bytes);

/// The same of an export to glTF: one line.
std::string export_summary(const mesh_format::Document& document, std::uint64_t file_bytes);

}  // namespace bake
