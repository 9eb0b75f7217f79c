// A piece of OBJ text to its statements.
#pragma once

#include <cstddef>
#include <string_view>

#include "cw2-bake/obj/chunk.h"

namespace bake {

/// Where a piece of about `size` bytes of text from `begin` on may end: after a line end that no
/// backslash stands before.
std::size_t obj_chunk_end(std::string_view text, std::size_t begin, std::size_t size);

/// Parses text[begin, end), which starts and ends between two statements, into an empty `chunk`.
/// Never throws for what the text holds: see ObjChunk::error.
void parse_obj_chunk(std::string_view text, std::size_t begin, std::size_t end,
                     const ObjContext& context, ObjChunk& chunk);

}  // namespace bake
