// What is in a baked file, in words and as JSON.
#pragma once

#include <cstdint>
#include <string>

#include "mesh-format/file.h"

namespace bake {

/// The summary, then every mesh, material, texture and source.
std::string inspection(const mesh_format::Document& document, std::uint64_t file_bytes);

/// The same as JSON.
std::string inspection_json(const mesh_format::Document& document, std::uint64_t file_bytes);

}  // namespace bake
