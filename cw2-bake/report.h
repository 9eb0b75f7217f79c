// What is in a baked file, in words and as JSON.
#pragma once

#include <cstdint>
#include <string>

#include "mesh-format/file.h"

namespace bake {

/// The closing summary of a bake: counts, bytes by kind, measured errors. A few lines.
std::string summary(const mesh_format::Document& document, std::uint64_t file_bytes);

/// The same of an export to glTF: one line.
std::string export_summary(const mesh_format::Document& document, std::uint64_t file_bytes);

/// The summary, then every mesh, material and texture.
std::string inspection(const mesh_format::Document& document, std::uint64_t file_bytes);

/// The same as JSON.
std::string inspection_json(const mesh_format::Document& document, std::uint64_t file_bytes);

}  // namespace bake
