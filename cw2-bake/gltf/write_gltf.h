// A baked scene to glTF 2.0.
#pragma once

#include <cstdint>
#include <filesystem>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/gltf/images.h"
#include "mesh-format/file.h"

namespace bake {

/// Writes a .glb, or a .gltf that holds its buffer as a data URI: positions below a node that moves
/// them by the scene's origin, normals, tangents, UVs, colours, materials with PNG images, and the
/// camera and light if the document has them (see light.h). A material whose back faces keep their
/// normals says so in its extras, as "cw2_back_normals": "kept", which read_gltf() honours. Warns
/// as make_gltf_images() does.
///
/// `document` is not encoded; `payloads` holds the bytes of its textures. Written beside `path` and
/// renamed. Returns the file's size. Throws common::FileError.
std::uint64_t write_gltf(const mesh_format::Document& document, TexturePayloads payloads,
                         const std::filesystem::path& path, const Warn& warn);

}  // namespace bake
