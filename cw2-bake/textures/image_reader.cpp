// The module around OpenImageIO, loaded by read_image.cpp when the first image is read: linking it
// would make every start of the program load some 250 libraries, a third of a second and 130 MiB.
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <new>
#include <set>
#include <string>
#include <string_view>

#include "cw2-bake/textures/read_image.h"

namespace {

using bake::Image;
using bake::ImageError;
using bake::SampleType;

/// Sets the type in which the samples are kept: the file's own if 8 or 16 bits hold it.
OIIO::TypeDesc choose_type(const OIIO::TypeDesc& stored, Image& image) {
    switch (stored.basetype) {
        case OIIO::TypeDesc::UINT8:
            image.type = SampleType::u8;
            return OIIO::TypeDesc::UINT8;
        case OIIO::TypeDesc::UINT16:
            image.type = SampleType::u16;
            return OIIO::TypeDesc::UINT16;
        default:
            image.type = SampleType::f32;
            return OIIO::TypeDesc::FLOAT;
    }
}

void check_flat(const OIIO::ImageSpec& spec) {
    bake::check_extent(spec.width, spec.height);
    if (spec.nchannels < 1) {
        throw ImageError("has no texels");
    }
    if (spec.depth > 1 || spec.deep) {
        throw ImageError("is not a flat image");
    }
}

/// FFmpeg's readers follow what a movie names, wherever it is.
void refuse_movies(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    const std::string formats = OIIO::get_string_attribute("extension_list");
    for (const std::string& format : OIIO::Strutil::splits(formats, ";")) {
        if (!format.starts_with("ffmpeg:")) continue;
        for (const std::string& name :
             OIIO::Strutil::splits(format.substr(format.find(':') + 1), ","))
            if (OIIO::Strutil::iequals("." + name, extension))
                throw ImageError("is a movie, not an image");
    }
}

/// Throws for more texels than the file can hold, before there is memory for them.
void check_held(const OIIO::ImageInput& input, const std::filesystem::path& path) {
    // These store texels as they are, or runs of equal ones.
    const std::set<std::string> plain{"pnm", "targa", "hdr",    "bmp", "sgi",
                                      "iff", "dpx",   "cineon", "rla", "dds"};
    // BMP's: 255 texels of three channels in two bytes.
    constexpr std::uint64_t kMostInflation = 512;
    const OIIO::ImageSpec& spec = input.spec();
    if (!plain.contains(input.format_name()) && spec.get_string_attribute("compression") != "none")
        return;
    if (spec.image_bytes(true) / kMostInflation > std::filesystem::file_size(path))
        throw ImageError("is damaged: it is too short for the size that it states");
}

/// The reader of GIFs takes memory for the screen that the file states (GIF89a, 18) when it opens
/// it.
void check_screen_held(const std::filesystem::path& path) {
    std::array<unsigned char, 10> start{};
    std::ifstream(path, std::ios::binary)
        .read(reinterpret_cast<char*>(start.data()), static_cast<std::streamsize>(start.size()));
    if (std::string_view(reinterpret_cast<const char*>(start.data()), 4) != "GIF8") return;
    const int width = start[6] + 256 * start[7];
    const int height = start[8] + 256 * start[9];
    bake::check_extent(width, height);
    // A code of 12 bits, the longest, stands for 4096 texels at most.
    constexpr std::uint64_t kMostInflation = 4096;
    if (std::uint64_t(width) * std::uint64_t(height) / kMostInflation >
        std::filesystem::file_size(path))
        throw ImageError("is damaged: it is too short for the size that it states");
}

Image read(const char* path) {
    refuse_movies(path);
    check_screen_held(path);
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1;
    const auto input = OIIO::ImageInput::open(path, &hints);
    if (!input) {
        throw ImageError(OIIO::geterror());
    }
    const OIIO::ImageSpec& spec = input->spec();
    check_flat(spec);
    check_held(*input, path);

    Image image;
    image.width = static_cast<std::uint32_t>(spec.width);
    image.height = static_cast<std::uint32_t>(spec.height);
    const int channels = std::min(spec.nchannels, 4);
    image.channels = static_cast<std::uint32_t>(channels);
    image.has_alpha = channels % 2 == 0 && spec.alpha_channel == channels - 1;
    const OIIO::TypeDesc type = choose_type(spec.format, image);
    image.samples.resize(std::size_t{image.width} * image.height * image.channels * type.size());
    // A JPEG that ends early counts as read, and leaves a message all the same.
    if (!input->read_image(0, 0, 0, channels, type, image.samples.data()) || input->has_error()) {
        throw ImageError(input->geterror());
    }
    return image;
}

/// The bake runs an image per thread already.
void forbid_inner_threads() {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) bool cw2_bake_image_reader(const char* path,
                                                                             Image& image,
                                                                             std::string& error) {
    try {
        static std::once_flag once;
        std::call_once(once, forbid_inner_threads);
        image = read(path);
        return true;
    } catch (const std::bad_alloc&) {
        error.clear();
        return false;
    } catch (const std::exception& exception) {
        error = exception.what();
    } catch (...) {
    }
    if (error.empty()) error = "cannot be read";
    return false;
}

static_assert(std::is_same_v<decltype(cw2_bake_image_reader), bake::ImageReader>);
