#include "cw2-bake/encode_png.h"

#include <png.h>

#include <string>

#include "mesh-format/io.h"

namespace bake {

std::vector<std::byte> encode_png(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                                  std::span<const std::byte> texels) {
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
        throw mesh_format::FileError("PNG encoder: " + problem);
    }
    png_set_write_fn(
        png, &file,
        [](png_structp writer, png_bytep data, png_size_t size) {
            auto& bytes = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(writer));
            const auto* const first = reinterpret_cast<const std::byte*>(data);
            bytes.insert(bytes.end(), first, first + size);
        },
        nullptr);
    png_set_compression_level(png, 3);
    png_set_IHDR(png, info, width, height, 8,
                 channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    const std::size_t row_bytes = std::size_t{width} * channels;
    for (std::uint32_t y = 0; y < height; ++y) {
        png_write_row(png, reinterpret_cast<png_const_bytep>(texels.data() + y * row_bytes));
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

}  // namespace bake
