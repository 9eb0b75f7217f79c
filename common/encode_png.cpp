#include "common/encode_png.h"

#include <png.h>

#include <string>

#include "common/io.h"

namespace common {

namespace {

using Channels = PngPicture::Channels;

int color_type(Channels channels) {
    switch (channels) {
        case Channels::grey:
            return PNG_COLOR_TYPE_GRAY;
        case Channels::rgba:
            return PNG_COLOR_TYPE_RGB_ALPHA;
        default:
            return PNG_COLOR_TYPE_RGB;
    }
}

std::size_t texel_bytes(Channels channels) {
    if (channels == Channels::grey) return 1;
    return channels == Channels::rgb ? 3 : 4;
}

}  // namespace

std::vector<std::byte> encode_png(const PngPicture& picture) {
    std::vector<std::byte> file;
    std::string problem;
    png_structp png = png_create_write_struct(
        PNG_LIBPNG_VER_STRING, &problem,
        [](png_structp failed, png_const_charp message) {
            *static_cast<std::string*>(png_get_error_ptr(failed)) = message;
            png_longjmp(failed, 1);
        },
        nullptr);
    png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
    if (info == nullptr || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        throw FileError("PNG encoder: " + problem);
    }
    png_set_write_fn(
        png, &file,
        [](png_structp writer, png_bytep data, png_size_t size) {
            auto& bytes = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(writer));
            const auto* const first = reinterpret_cast<const std::byte*>(data);
            bytes.insert(bytes.end(), first, first + size);
        },
        nullptr);
    // A third of the time of the default, 6, for files that are 4 to 8 % larger.
    png_set_compression_level(png, 3);
    png_set_IHDR(png, info, picture.width, picture.height, 8, color_type(picture.channels),
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (picture.says_srgb) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    if (picture.channels == Channels::rgb_of_rgba) png_set_filler(png, 0, PNG_FILLER_AFTER);
    const std::size_t row_bytes = picture.width * texel_bytes(picture.channels);
    for (std::uint32_t y = 0; y < picture.height; ++y) {
        png_write_row(png,
                      reinterpret_cast<png_const_bytep>(picture.texels.data() + y * row_bytes));
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

}  // namespace common
