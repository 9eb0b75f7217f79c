// PNG and JPEG by their own libraries: reading them takes no OpenImageIO, whose start costs more
// than most scenes' images.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "cw2-bake/textures/image.h"

namespace bake {

/// The image in the contents of a file; nothing if it is neither a PNG nor a JPEG, or one whose
/// colours are neither grey nor RGB. Palettes and transparent colours are looked up. Throws
/// ImageError if it is damaged or too large; before the image is allocated, if it is larger than
/// the contents can hold.
std::optional<Image> read_common_image(std::span<const std::byte> contents);

/// The names and versions of the libraries that do it.
std::string common_image_libraries();

}  // namespace bake
