// What the module around Draco gives; see draco_reader.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace bake {

/// An attribute of a Draco mesh: what is asked for, and its values.
struct DracoAttribute {
    std::uint32_t id;    ///< unique in the Draco mesh
    int component_type;  ///< of glTF
    int components;
    std::vector<std::byte> values{};  ///< packed, one a vertex
};

struct DracoMesh {
    std::vector<std::uint32_t> indices{};  ///< 3 a triangle
    std::size_t vertex_count = 0;
    std::vector<DracoAttribute> attributes{};
};

/// What the module draco_reader exports: fills in the mesh whose attributes are asked for and
/// returns true, or sets `error`.
using DracoReader = bool(std::span<const std::byte> data, DracoMesh& mesh, std::string& error);
inline constexpr const char* kDracoReaderModule = "../lib/cw2/draco_reader.so";
inline constexpr const char* kDracoReaderSymbol = "cw2_bake_draco_reader";

}  // namespace bake
