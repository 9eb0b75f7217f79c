// PNG and JPEG, which have a reader of their own: the samples are those that OpenImageIO reads.
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include "common/io.h"
#include "cw2-bake/textures/read_common_image.h"
#include "cw2-bake/textures/read_image.h"
#include "image_files.h"

// After <cstdio>, which it needs.
#include <jpeglib.h>

namespace {

struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closer>;

std::optional<bake::Image> read_common(const std::filesystem::path& path) {
    const common::MappedFile file(path);
    return bake::read_common_image(file.bytes());
}

void expect_as_openimageio(const std::filesystem::path& path) {
    SCOPED_TRACE(path.filename().string());
    const auto ours = read_common(path);
    ASSERT_TRUE(ours);
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1;
    const auto input = OIIO::ImageInput::open(path.string(), &hints);
    ASSERT_TRUE(input) << OIIO::geterror();
    const OIIO::ImageSpec& spec = input->spec();
    EXPECT_EQ(ours->width, static_cast<std::uint32_t>(spec.width));
    EXPECT_EQ(ours->height, static_cast<std::uint32_t>(spec.height));
    ASSERT_EQ(ours->channels, static_cast<std::uint32_t>(spec.nchannels));
    EXPECT_EQ(ours->has_alpha, spec.alpha_channel == spec.nchannels - 1);
    EXPECT_EQ(ours->type == bake::SampleType::u16, spec.format == OIIO::TypeDesc::UINT16);
    std::vector<std::byte> theirs(spec.image_bytes());
    ASSERT_TRUE(input->read_image(0, 0, 0, spec.nchannels, spec.format, theirs.data()));
    EXPECT_TRUE(ours->samples == theirs);
}

std::vector<double> texel(int x, int y, int channels) {
    std::vector<double> values;
    for (int c = 0; c < channels; ++c) {
        values.push_back(0.5 + 0.5 * std::sin(0.7 * x + 0.31 * y * (c + 1) + c));
    }
    return values;
}

TEST(CommonImages, PngsOfEveryChannelCountAndDepth) {
    const TemporaryFolder folder;
    for (int channels = 1; channels <= 4; ++channels) {
        for (const OIIO::TypeDesc type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}) {
            write_image(
                folder / "a.png", 19, 13, channels,
                [&](int x, int y) { return texel(x, y, channels); }, type);
            expect_as_openimageio(folder / "a.png");
        }
    }
}

/// What a PNG may have that the other tests' writers do not make.
struct PngKind {
    int bits;
    int color_type;
    bool interlaced;
    int transparent;  ///< palette entries with an alpha, or 1 for a transparent colour
};

void write_png(const std::filesystem::path& path, const PngKind& kind) {
    const File file(std::fopen(path.c_str(), "wb"));
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file.get());
    constexpr png_uint_32 kSize = 21;
    png_set_IHDR(png, info, kSize, kSize, kind.bits, kind.color_type,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    const bool palette = kind.color_type == PNG_COLOR_TYPE_PALETTE;
    std::vector<png_color> colors;
    for (int i = 0; i < 1 << kind.bits && palette; ++i) {
        colors.push_back({static_cast<png_byte>(17 * i), static_cast<png_byte>(255 - 9 * i),
                          static_cast<png_byte>(40 + 3 * i)});
    }
    if (palette) png_set_PLTE(png, info, colors.data(), static_cast<int>(colors.size()));
    const png_byte alphas[] = {0, 100, 200};
    const png_color_16 hidden{.index = 0, .red = 1, .green = 1, .blue = 1, .gray = 1};
    if (kind.transparent > 0) {
        png_set_tRNS(png, info, alphas, palette ? kind.transparent : 0, &hidden);
    }
    png_write_info(png, info);
    std::vector<png_byte> samples(kSize * png_get_rowbytes(png, info));
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<png_byte>(i * 29 / 7);
    std::vector<png_bytep> rows;
    for (std::size_t y = 0; y < kSize; ++y) {
        rows.push_back(samples.data() + y * png_get_rowbytes(png, info));
    }
    png_write_image(png, rows.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
}

TEST(CommonImages, PngsWithPalettesFewBitsTransparentColoursAndInterlacing) {
    const TemporaryFolder folder;
    for (const bool interlaced : {false, true}) {
        for (const int bits : {1, 2, 4, 8}) {
            for (const int transparent : {0, 2}) {
                SCOPED_TRACE(testing::Message() << bits << " bits, " << transparent);
                write_png(folder / "p.png",
                          {bits, PNG_COLOR_TYPE_PALETTE, interlaced, transparent});
                expect_as_openimageio(folder / "p.png");
                write_png(folder / "g.png", {bits, PNG_COLOR_TYPE_GRAY, interlaced, transparent});
                expect_as_openimageio(folder / "g.png");
            }
        }
        write_png(folder / "t.png", {8, PNG_COLOR_TYPE_RGB, interlaced, 1});
        expect_as_openimageio(folder / "t.png");
    }
}

TEST(CommonImages, JpegsGreyAndColouredOfEverySubsampling) {
    const TemporaryFolder folder;
    for (const char* subsampling : {"4:4:4", "4:2:2", "4:2:0", "4:1:1"}) {
        SCOPED_TRACE(subsampling);
        write_image(
            folder / "a.jpg", 45, 37, 3, [](int x, int y) { return texel(x, y, 3); },
            OIIO::TypeDesc::UINT8, "jpeg:subsampling", subsampling);
        expect_as_openimageio(folder / "a.jpg");
    }
    // Bytes before the end that mean nothing, as some cameras write them.
    std::ifstream file(folder / "a.jpg", std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    ASSERT_TRUE(bytes.ends_with("\xFF\xD9"));
    bytes.insert(bytes.size() - 2, 40, '\x12');
    write_bytes(folder / "b.jpg", bytes);
    expect_as_openimageio(folder / "b.jpg");
    write_image(folder / "g.jpg", 45, 37, 1, [](int x, int y) { return texel(x, y, 1); });
    expect_as_openimageio(folder / "g.jpg");
}

/// 8 x 8 equal texels, in forms that OpenImageIO does not write.
void write_plain_jpeg(const std::filesystem::path& path, J_COLOR_SPACE space,
                      const std::vector<JSAMPLE>& texel, bool progressive) {
    constexpr JDIMENSION kSide = 8;
    const File file(std::fopen(path.c_str(), "wb"));
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_stdio_dest(&jpeg, file.get());
    jpeg.image_width = kSide;
    jpeg.image_height = kSide;
    jpeg.input_components = static_cast<int>(texel.size());
    jpeg.in_color_space = space;
    jpeg_set_defaults(&jpeg);
    if (progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    std::vector<JSAMPLE> row;
    for (JDIMENSION x = 0; x < kSide; ++x) row.insert(row.end(), texel.begin(), texel.end());
    for (JSAMPROW rows[] = {row.data()}; jpeg.next_scanline < kSide;) {
        jpeg_write_scanlines(&jpeg, rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
}

TEST(CommonImages, OtherColoursAndOtherFormatsAreLeftToOpenImageIO) {
    const TemporaryFolder folder;
    write_plain_jpeg(folder / "cmyk.jpg", JCS_CMYK, {255, 128, 0, 255}, false);
    EXPECT_FALSE(read_common(folder / "cmyk.jpg"));
    EXPECT_EQ(bake::read_image(folder / "cmyk.jpg").channels, 3u);
    write_image(folder / "a.tif", 4, 4, 3, [](int x, int y) { return texel(x, y, 3); });
    EXPECT_FALSE(read_common(folder / "a.tif"));
    EXPECT_FALSE(bake::read_common_image({}));
}

TEST(CommonImages, WhatEndsEarlyIsRefusedWhereverItEnds) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.jpg"}) {
        write_image(folder / name, 16, 16, 3, [](int x, int y) { return texel(x, y, 3); });
        const common::MappedFile file(folder / name);
        for (std::size_t size = 8; size < file.bytes().size(); ++size) {
            EXPECT_THROW(bake::read_common_image(file.bytes().first(size)), bake::ImageError)
                << name << ' ' << size;
        }
    }
}

/// Address space beyond what is in use is limited while this lives.
class MemoryLimit {
 public:
    explicit MemoryLimit(std::uint64_t bytes) {
        std::uint64_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        getrlimit(RLIMIT_AS, &before_);
        rlimit limit = before_;
        limit.rlim_cur = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + bytes;
        setrlimit(RLIMIT_AS, &limit);
    }
    ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
    rlimit before_{};
};

/// 16384 x 16384 texels of 64 bits, and not one of them.
void write_empty_png(const std::filesystem::path& path) {
    const File file(std::fopen(path.c_str(), "wb"));
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file.get());
    png_set_IHDR(png, info, 16'384, 16'384, 16, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"),
                    reinterpret_cast<png_const_bytep>("\x78\x9C"), 2);
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
    png_destroy_write_struct(&png, &info);
}

/// One block, and a frame header that states 16384 x 16384 texels.
void write_empty_jpeg(const std::filesystem::path& path, bool progressive) {
    write_plain_jpeg(path, JCS_RGB, {100, 100, 100}, progressive);
    std::ifstream file(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::size_t frame = bytes.find(progressive ? "\xFF\xC2" : "\xFF\xC0");
    ASSERT_NE(frame, std::string::npos);
    write_bytes(path, bytes.replace(frame + 5, 4, std::string{'\x40', '\0', '\x40', '\0'}));
}

TEST(CommonImages, SizesThatAFileCannotHoldAreRefusedBeforeTheyAreAllocated) {
    const TemporaryFolder folder;
    write_empty_png(folder / "a.png");
    write_empty_jpeg(folder / "b.jpg", false);
    write_empty_jpeg(folder / "c.jpg", true);
    for (const char* name : {"a.png", "b.jpg", "c.jpg"}) {
        const common::MappedFile file(folder / name);
        const MemoryLimit limit(64 << 20);
        try {
            bake::read_common_image(file.bytes());
            ADD_FAILURE() << name << " was read";
        } catch (const std::exception& error) {
            EXPECT_NE(std::string(error.what()).find("too short for the size"), std::string::npos)
                << name << ": " << error.what();
        }
    }
}

TEST(CommonImages, OfOneColourAreReadHoweverSmallTheirFiles) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.jpg"}) {
        write_image(folder / name, 2048, 2048, 1, [](int, int) { return std::vector{0.0}; });
        EXPECT_TRUE(read_common(folder / name)) << name;
    }
}

}  // namespace
