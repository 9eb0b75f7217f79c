// Image files to texels in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "cw2-bake/textures/image.h"

namespace bake {

/// Reads a PNG, a JPEG or, where the module image_reader is installed, an image of any format that
/// OpenImageIO knows, told by content where the extension misleads. Throws ImageError if there is
/// none, or if it is damaged or larger than mesh_format::kMaxTextureSize. Callable from several
/// threads.
Image read_image(const std::filesystem::path& path);

/// The same for the contents of an image file.
Image read_image(std::span<const std::byte> contents);

/// What the module image_reader exports: sets `image` and returns true, or sets `error`, which is
/// empty where there was not enough memory.
using ImageReader = bool(const char* path, Image& image, std::string& error);
inline constexpr const char* kImageReaderModule = "../lib/cw2/image_reader.so";
inline constexpr const char* kImageReaderSymbol = "cw2_bake_image_reader";

}  // namespace bake
