// Wavefront OBJ and MTL to a SourceScene.
#pragma once

#include <cstddef>
#include <filesystem>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/source_scene.h"

namespace bake {

/// How much of the text one thread parses at a time.
inline constexpr std::size_t kObjChunkBytes = 256 * 1024;

/// Reads an OBJ and the MTLs it names. Throws BakeError, with the line, for what cannot be read:
/// no such file, no faces, a position that is no finite number, an index of one that is out of
/// range, a malformed face. What is wrong with a normal, a UV, a colour or a smoothing group is a
/// warning, and it is absent; a missing MTL or material is a warning, too, and what is not drawn
/// (curves, lines, faces of fewer than three corners, unknown statements) is left out with one a
/// kind. Faces before any `usemtl` get a material
/// "default". The text is parsed in pieces of about `chunk_bytes`, on as many threads as TBB is
/// allowed; the result depends on neither. What it names is looked for as FileFinder does with
/// `root`.
SourceScene read_obj(const std::filesystem::path& path, const Warn& warn,
                     std::size_t chunk_bytes = kObjChunkBytes,
                     const std::filesystem::path& root = {}, const Advance& advance = kUnwatched);

}  // namespace bake
