// What a compressed file holds, as in any other. A library of its own: it needs more than
// the standard library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "mesh-format/file.h"

namespace mesh_format {

/// What the sections vertices and indices of an encoded document decode to.
struct DecodedGeometry {
    std::unique_ptr<std::byte[]> vertices;
    std::unique_ptr<std::uint16_t[]> indices;
};

/// Calls a function with each number below a count, in any order, or at once on several threads.
using Loop = std::function<void(std::size_t count, const std::function<void(std::size_t)>&)>;

/// Decodes an encoded document mesh by mesh, by `loop` or one after the other, and checks the
/// result, which `document` then refers to; leaves any other as it is. Throws FormatError, which
/// calls the file `name`, where the sections are damaged, or claim to be more than kLargestRatio
/// times the size of what is stored of them and of the chunks.
DecodedGeometry decode(Document& document, std::string_view name, const Loop& loop = {});

/// A payload as it is in a plain file.
struct Payload {
    std::span<const std::byte> bytes;
    std::unique_ptr<std::byte[]> memory;  ///< of one that was compressed
};

/// The payload of a texture of a file that was read. A compressed one is decoded part by part, by
/// `loop` or one after the other; what lies before level `first_level` may be left unset. Throws
/// FormatError, which calls the file `name`, where it is damaged.
Payload decode_payload(const Document& document, std::size_t texture, std::string_view name,
                       std::uint32_t first_level = 0, const Loop& loop = {});

}  // namespace mesh_format
