#include "cw2/render/image_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>

#include <cstring>
#include <string>
#include <vector>

#include "common/encode_png.h"
#include "common/file_kind.h"
#include "common/io.h"

namespace cw2 {

namespace {

using Bytes = std::vector<std::byte>;

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

std::optional<ImageKind> image_kind(const std::filesystem::path& path) {
    const std::string extension = common::lower_extension(path);
    if (extension == ".png") return ImageKind::png;
    if (extension == ".exr") return ImageKind::exr;
    return std::nullopt;
}

void write_image(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                 std::span<const std::byte> pixels, const PngContents& png) {
    common::OutputFile file(path);
    try {
        using common::PngPicture;
        file.write(
            image_kind(path) == ImageKind::png
                ? common::encode_png({.width = width,
                                      .height = height,
                                      .channels = png.alpha ? PngPicture::Channels::rgba
                                                            : PngPicture::Channels::rgb_of_rgba,
                                      .says_srgb = png.srgb,
                                      .texels = pixels,
                                      .on_threads = true})
                : encode_exr(width, height, pixels));
    } catch (const common::FileError&) {
        throw;
    } catch (const std::exception& error) {
        throw common::FileError(path.string() + ": " + error.what());
    }
    file.commit();
}

}  // namespace cw2
