#include "cw2/image_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <png.h>

#include <cstring>
#include <string>
#include <vector>

#include "mesh-format/io.h"

namespace cw2 {

namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, const void* data, std::size_t size) {
    const auto* const first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
}

Bytes encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::byte> pixels) {
    std::vector<std::byte> row(std::size_t{width} * 3);
    Bytes bytes;
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
        png, &bytes,
        [](png_structp writer, png_bytep data, png_size_t size) {
            append(*static_cast<Bytes*>(png_get_io_ptr(writer)), data, size);
        },
        nullptr);
    png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::byte* const source = pixels.data() + std::size_t{y} * width * 4;
        for (std::uint32_t x = 0; x < width; ++x) std::memcpy(&row[3 * x], source + 4 * x, 3);
        png_write_row(png, reinterpret_cast<png_const_bytep>(row.data()));
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

/// Where OpenEXR writes: memory, because it goes back to fill in its offsets.
class MemoryStream : public Imf::OStream {
 public:
    MemoryStream() : OStream("memory") {}
    void write(const char data[], int size) override {
        const auto count = static_cast<std::size_t>(size);
        if (position_ + count > bytes_.size()) bytes_.resize(position_ + count);
        std::memcpy(bytes_.data() + position_, data, count);
        position_ += count;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    const Bytes& bytes() const { return bytes_; }

 private:
    Bytes bytes_;
    std::size_t position_ = 0;
};

Bytes encode_exr(std::uint32_t width, std::uint32_t height, std::span<const std::byte> pixels) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(height));
    header.compression() = Imf::ZIP_COMPRESSION;
    // OpenEXR only reads through this pointer, but its interface takes it as mutable.
    char* const base = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));
    Imf::FrameBuffer frame;
    const char* const names[] = {"R", "G", "B", "A"};
    for (std::size_t channel = 0; channel < 4; ++channel) {
        header.channels().insert(names[channel], Imf::Channel(Imf::FLOAT));
        frame.insert(names[channel],
                     Imf::Slice(Imf::FLOAT, base + 4 * channel, 16, std::size_t{width} * 16));
    }
    MemoryStream stream;
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(height));
    }
    return stream.bytes();
}

}  // namespace

ImageKind image_kind(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    if (extension == ".png") return ImageKind::png;
    if (extension == ".exr") return ImageKind::exr;
    throw mesh_format::FileError(path.string() + ": unknown image format; use .png or .exr");
}

void write_image(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                 std::span<const std::byte> pixels) {
    mesh_format::OutputFile file(path);
    try {
        file.write(image_kind(path) == ImageKind::png ? encode_png(width, height, pixels)
                                                      : encode_exr(width, height, pixels));
    } catch (const mesh_format::FileError&) {
        throw;
    } catch (const std::exception& error) {
        throw mesh_format::FileError(path.string() + ": " + error.what());
    }
    file.commit();
}

}  // namespace cw2
