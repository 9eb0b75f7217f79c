#include "common/encode_png.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <future>
#include <new>
#include <stdexcept>
#include <string_view>

namespace common {

namespace {

using Channels = PngPicture::Channels;
using Bytes = std::vector<std::byte>;

/// Strips are compressed by themselves, on threads. Their number depends on the picture alone, and
/// so do the bytes.
constexpr std::size_t kStripBytes = 64u << 10;
constexpr std::size_t kMostStrips = 16;

struct Layout {
    std::size_t texel_bytes;  ///< in memory
    std::size_t channels;     ///< in the file
    unsigned char color_type;
};

Layout layout_of(Channels channels) {
    switch (channels) {
        case Channels::grey:
            return {1, 1, 0};
        case Channels::rgb:
            return {3, 3, 2};
        case Channels::rgba:
            return {4, 4, 6};
        case Channels::rgb_of_rgba:
            return {4, 3, 2};
    }
    std::abort();
}

void append(Bytes& file, std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) file.push_back(std::byte(word >> shift & 255));
}

void append_chunk(Bytes& file, std::string_view type, std::span<const std::byte> data) {
    append(file, static_cast<std::uint32_t>(data.size()));
    const std::size_t start = file.size();
    const auto letters = std::as_bytes(std::span(type));
    file.insert(file.end(), letters.begin(), letters.end());
    file.insert(file.end(), data.begin(), data.end());
    const auto* const checked = reinterpret_cast<const Bytef*>(file.data() + start);
    append(file,
           static_cast<std::uint32_t>(::crc32(0, checked, static_cast<uInt>(file.size() - start))));
}

/// What of the three neighbours is nearest to left + above - corner (PNG 1.2, 6.6).
unsigned char paeth(int left, int above, int corner) {
    const int to_left = std::abs(above - corner);
    const int to_above = std::abs(left - corner);
    const int to_corner = std::abs(left + above - 2 * corner);
    const int other = to_above <= to_corner ? above : corner;
    return static_cast<unsigned char>(to_left <= to_above && to_left <= to_corner ? left : other);
}

/// A strip of rows as it is compressed, and what of it the checksum of all needs.
struct Strip {
    Bytes stream;
    uLong adler;
    std::size_t filtered_bytes;
};

/// Row `y` without what is not for the file; zeros above the first.
void unpack_row(const PngPicture& picture, const Layout& layout, std::int64_t y, Bytes& row) {
    row.assign(layout.channels * picture.width, std::byte{0});
    if (y < 0) return;
    const std::byte* from =
        picture.texels.data() + static_cast<std::size_t>(y) * picture.width * layout.texel_bytes;
    if (layout.channels == layout.texel_bytes) {
        std::memcpy(row.data(), from, row.size());
        return;
    }
    for (std::size_t i = 0; i < row.size(); i += 3, from += 4) std::memcpy(row.data() + i, from, 3);
}

/// Every row by Paeth's filter: a search for each row's best takes longer than it saves.
Bytes filtered(const PngPicture& picture, const Layout& layout, std::uint32_t first,
               std::uint32_t end) {
    constexpr std::byte kPaeth{4};
    const std::size_t row_bytes = layout.channels * picture.width;
    Bytes out((end - first) * (row_bytes + 1));
    Bytes above, row;
    unpack_row(picture, layout, std::int64_t{first} - 1, above);
    std::byte* to = out.data();
    for (std::uint32_t y = first; y < end; ++y) {
        unpack_row(picture, layout, y, row);
        *to++ = kPaeth;
        const auto at = [](const Bytes& bytes, std::size_t i) {
            return std::to_integer<int>(bytes[i]);
        };
        for (std::size_t i = 0; i < layout.channels; ++i)
            to[i] = std::byte(at(row, i) - at(above, i));
        for (std::size_t i = layout.channels; i < row_bytes; ++i) {
            const std::size_t left = i - layout.channels;
            to[i] = std::byte(at(row, i) - paeth(at(row, left), at(above, i), at(above, left)));
        }
        to += row_bytes;
        above.swap(row);
    }
    return out;
}

Strip compress(const Bytes& filtered, bool is_last) {
    // Runs alone: a third of the time of a search for matches, and as small for pictures.
    z_stream stream{};
    if (::deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 9, Z_RLE) != Z_OK)
        throw std::bad_alloc();
    Strip strip;
    strip.stream.resize(::deflateBound(&stream, static_cast<uLong>(filtered.size())) + 16);
    const auto* const in = reinterpret_cast<const Bytef*>(filtered.data());
    stream.next_in = const_cast<Bytef*>(in);  // zlib only reads it
    stream.avail_in = static_cast<uInt>(filtered.size());
    stream.next_out = reinterpret_cast<Bytef*>(strip.stream.data());
    stream.avail_out = static_cast<uInt>(strip.stream.size());
    const int result = ::deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
    strip.stream.resize(stream.total_out);
    ::deflateEnd(&stream);
    if (result != (is_last ? Z_STREAM_END : Z_OK))
        throw std::runtime_error("PNG encoder: zlib failed");
    strip.adler = ::adler32(1, in, static_cast<uInt>(filtered.size()));
    strip.filtered_bytes = filtered.size();
    return strip;
}

std::vector<Strip> strips_of(const PngPicture& picture, const Layout& layout) {
    const std::size_t bytes = (layout.channels * picture.width + 1) * picture.height;
    const std::size_t count = std::clamp<std::size_t>(
        bytes / kStripBytes, 1, std::min<std::size_t>(kMostStrips, picture.height));
    std::vector<std::future<Strip>> pending;
    for (std::size_t i = 0; i < count; ++i) {
        const auto begin = static_cast<std::uint32_t>(picture.height * i / count);
        const auto end = static_cast<std::uint32_t>(picture.height * (i + 1) / count);
        pending.push_back(std::async(
            picture.on_threads ? std::launch::async : std::launch::deferred,
            [&picture, &layout, begin, end] {
                return compress(filtered(picture, layout, begin, end), end == picture.height);
            }));
    }
    std::vector<Strip> strips;
    for (std::future<Strip>& strip : pending) strips.push_back(strip.get());
    return strips;
}

}  // namespace

std::vector<std::byte> encode_png(const PngPicture& picture) {
    const Layout layout = layout_of(picture.channels);
    const std::vector<Strip> strips = strips_of(picture, layout);

    const auto signature = std::as_bytes(std::span(std::string_view("\x89PNG\r\n\x1A\n")));
    Bytes file(signature.begin(), signature.end());
    Bytes header;
    append(header, picture.width);
    append(header, picture.height);
    // 8 bits a channel; the only compression and kind of filters there are; rows in their order.
    for (const unsigned char byte : std::to_array<unsigned char>({8, layout.color_type, 0, 0, 0}))
        header.push_back(std::byte{byte});
    append_chunk(file, "IHDR", header);
    constexpr std::byte kPerceptual{0};
    if (picture.says_srgb) append_chunk(file, "sRGB", {&kPerceptual, 1});
    // A zlib stream (RFC 1950) may be spread over as many chunks as one likes.
    uLong adler = 1;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        adler = ::adler32_combine(adler, strips[i].adler,
                                  static_cast<z_off_t>(strips[i].filtered_bytes));
        Bytes data;
        if (i == 0) data = {std::byte{0x78}, std::byte{0x01}};
        data.insert(data.end(), strips[i].stream.begin(), strips[i].stream.end());
        if (i + 1 == strips.size()) append(data, static_cast<std::uint32_t>(adler));
        append_chunk(file, "IDAT", data);
    }
    append_chunk(file, "IEND", {});
    return file;
}

}  // namespace common
