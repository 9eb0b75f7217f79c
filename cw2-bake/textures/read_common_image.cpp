#include "cw2-bake/textures/read_common_image.h"

#include <png.h>

#include <array>
#include <csetjmp>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

// After <cstdio>, which it needs.
#include <jerror.h>
#include <jpeglib.h>

namespace bake {
namespace {

/// Throws ImageError if a file that can hold at most `most` of something states `stated` of it.
void check_held(std::uint64_t stated, std::uint64_t most) {
    if (stated > most) throw ImageError("is damaged: it is too short for the size that it states");
}

// Both libraries leave through longjmp(), so what has a destructor lives with the callers of the
// functions that they leave.

struct PngReader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::span<const std::byte> rest;
    std::vector<png_bytep> rows;
    std::string error;
    bool lacks_memory = false;

    explicit PngReader(std::span<const std::byte> contents) : rest(contents) {
        png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, this, fail, ignore, this, allocate,
                                       free);
        if (png) info = png_create_info_struct(png);
        if (!info) {
            png_destroy_read_struct(&png, nullptr, nullptr);
            throw std::bad_alloc();
        }
    }
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    [[noreturn]] static void fail(png_structp png, png_const_charp message) {
        static_cast<PngReader*>(png_get_error_ptr(png))->error = message;
        png_longjmp(png, 1);
    }
    static void ignore(png_structp, png_const_charp) {}
    /// To the library a lack of memory is an error like any other.
    static png_voidp allocate(png_structp png, png_alloc_size_t size) {
        void* const place = std::malloc(size);
        if (!place) static_cast<PngReader*>(png_get_mem_ptr(png))->lacks_memory = true;
        return place;
    }
    static void free(png_structp, png_voidp place) { std::free(place); }
    static void read(png_structp png, png_bytep out, std::size_t size) {
        auto& rest = static_cast<PngReader*>(png_get_io_ptr(png))->rest;
        if (size > rest.size()) png_error(png, "ends early");
        std::memcpy(out, rest.data(), size);
        rest = rest.subspan(size);
    }
};

/// Deflate makes at most 258 bytes of 2 bits, a length and a distance of one bit each (RFC 1951).
constexpr std::uint64_t kMostInflation = 258 * 8 / 2;

/// False if the reader has an error.
bool read_png(PngReader& reader, Image& image) {
    png_structp png = reader.png;
    const std::uint64_t file_bytes = reader.rest.size();
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_read_fn(png, &reader, PngReader::read);
    png_read_info(png, reader.info);
    check_extent(png_get_image_width(png, reader.info), png_get_image_height(png, reader.info));
    const std::uint64_t texel_bits =
        std::uint64_t{png_get_bit_depth(png, reader.info)} * png_get_channels(png, reader.info);
    check_held(std::uint64_t{png_get_image_width(png, reader.info)} *
                   png_get_image_height(png, reader.info) * texel_bits / 8,
               file_bytes * kMostInflation);
    png_set_expand(png);
    if (png_get_bit_depth(png, reader.info) == 16) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, reader.info);

    image.width = png_get_image_width(png, reader.info);
    image.height = png_get_image_height(png, reader.info);
    image.channels = png_get_channels(png, reader.info);
    image.has_alpha = image.channels % 2 == 0;
    image.type = png_get_bit_depth(png, reader.info) == 16 ? SampleType::u16 : SampleType::u8;
    const std::size_t row_bytes = png_get_rowbytes(png, reader.info);
    image.samples.resize(row_bytes * image.height);
    for (std::size_t y = 0; y < image.height; ++y) {
        reader.rows.push_back(reinterpret_cast<png_bytep>(image.samples.data()) + y * row_bytes);
    }
    png_read_image(png, reader.rows.data());
    png_read_end(png, nullptr);
    return true;
}

struct JpegReader {
    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    std::jmp_buf exit{};
    std::array<char, JMSG_LENGTH_MAX> error{};

    JpegReader() {
        jpeg.err = jpeg_std_error(&errors);
        errors.error_exit = fail;
        errors.emit_message = fail_on_warnings;
        jpeg.client_data = this;
    }
    ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    [[noreturn]] static void fail(j_common_ptr common) {
        auto* reader = static_cast<JpegReader*>(common->client_data);
        reader->errors.format_message(common, reader->error.data());
        std::longjmp(reader->exit, 1);
    }
    /// An image that ends early is a warning to the library. These harm no texel.
    static void fail_on_warnings(j_common_ptr common, int level) {
        const int code = common->err->msg_code;
        const bool harmless = code == JWRN_EXTRANEOUS_DATA || code == JWRN_JFIF_MAJOR ||
                              code == JWRN_ADOBE_XFORM || code == JWRN_BOGUS_ICC;
        if (level < 0 && !harmless) fail(common);
    }
};

/// How many of the smallest units of a JPEG its size states (ITU T.81, A.2). Each takes a bit at
/// least: the Huffman code of its first coefficient (F.1.2.1 and, progressive, G.1.2.1).
std::uint64_t unit_count(const jpeg_decompress_struct& jpeg) {
    const auto units = [](std::uint64_t extent, int blocks) {
        const auto texels = static_cast<std::uint64_t>(DCTSIZE * blocks);
        return (extent + texels - 1) / texels;
    };
    return units(jpeg.image_width, jpeg.max_h_samp_factor) *
           units(jpeg.image_height, jpeg.max_v_samp_factor);
}

enum class Outcome { read, other_colors, damaged };

Outcome read_jpeg(JpegReader& reader, std::span<const std::byte> contents, Image& image) {
    jpeg_decompress_struct& jpeg = reader.jpeg;
    if (setjmp(reader.exit) != 0) return Outcome::damaged;
    jpeg_create_decompress(&jpeg);
    jpeg.client_data = &reader;
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(contents.data()), contents.size());
    jpeg_read_header(&jpeg, TRUE);
    check_extent(jpeg.image_width, jpeg.image_height);
    // Arithmetic codes may take less than a bit.
    if (!jpeg.arith_code) check_held(unit_count(jpeg), std::uint64_t{contents.size()} * 8);
    const bool grey = jpeg.jpeg_color_space == JCS_GRAYSCALE;
    if (!grey && jpeg.jpeg_color_space != JCS_YCbCr && jpeg.jpeg_color_space != JCS_RGB) {
        return Outcome::other_colors;
    }
    jpeg.out_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_start_decompress(&jpeg);
    image.width = jpeg.output_width;
    image.height = jpeg.output_height;
    image.channels = grey ? 1 : 3;
    const std::size_t row_bytes = std::size_t{image.width} * image.channels;
    image.samples.resize(row_bytes * image.height);
    while (jpeg.output_scanline < jpeg.output_height) {
        auto* row =
            reinterpret_cast<JSAMPROW>(image.samples.data() + row_bytes * jpeg.output_scanline);
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
    return Outcome::read;
}

bool starts_with(std::span<const std::byte> contents, std::string_view signature) {
    return contents.size() >= signature.size() &&
           std::memcmp(contents.data(), signature.data(), signature.size()) == 0;
}

}  // namespace

std::optional<Image> read_common_image(std::span<const std::byte> contents) {
    Image image;
    if (starts_with(contents, "\x89PNG\r\n\x1a\n")) {
        PngReader reader(contents);
        if (!read_png(reader, image)) {
            if (reader.lacks_memory) throw std::bad_alloc();
            throw ImageError("is damaged: " + reader.error);
        }
        return image;
    }
    if (starts_with(contents, "\xff\xd8\xff")) {
        JpegReader reader;
        switch (read_jpeg(reader, contents, image)) {
            case Outcome::read:
                return image;
            case Outcome::other_colors:
                return std::nullopt;
            case Outcome::damaged:
                if (reader.errors.msg_code == JERR_OUT_OF_MEMORY) throw std::bad_alloc();
                throw ImageError(std::string("is damaged: ") + reader.error.data());
        }
    }
    return std::nullopt;
}

std::string common_image_libraries() {
    jpeg_error_mgr manager{};
    const jpeg_error_mgr& jpeg = *jpeg_std_error(&manager);
    // Of libpng the one that is loaded; libjpeg-turbo tells only its headers' number, and what is
    // loaded by the years of its copyright.
    std::string names = std::string("libpng ") + png_get_libpng_ver(nullptr);
    for (const int line : {JMSG_VERSION, JMSG_COPYRIGHT})
        names += std::string(", ") + jpeg.jpeg_message_table[line];
#ifdef LIBJPEG_TURBO_VERSION_NUMBER
    names += ", libjpeg-turbo " + std::to_string(LIBJPEG_TURBO_VERSION_NUMBER);
#endif
    return names;
}

}  // namespace bake
