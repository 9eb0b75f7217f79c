// Pictures to files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

namespace cw2 {

/// What an image file holds.
enum class ImageKind {
    png,  ///< 8-bit RGB or RGBA
    exr,  ///< 32-bit float RGBA, linear
};

/// The kind that the name's extension, in any case, asks for.
std::optional<ImageKind> image_kind(const std::filesystem::path& path);

/// Bytes of a pixel in memory, tightly packed RGBA: 4 x uint8 for png, 4 x float for exr.
constexpr std::size_t pixel_bytes(ImageKind kind) {
    return kind == ImageKind::png ? 4 : 16;
}

/// What a PNG holds.
struct PngContents {
    bool srgb = true;    ///< sRGB-encoded colours; false: values
    bool alpha = false;  ///< false: it is dropped
};

/// Writes width x height pixels, row 0 at the top, beside `path`, which has a kind, and renames.
/// The same pixels give the same bytes. Throws common::FileError.
void write_image(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                 std::span<const std::byte> pixels, const PngContents& png = {});

}  // namespace cw2
