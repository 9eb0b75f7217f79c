// Files with compressed geometry: what they decode to, and what damage does.
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "cw2-bake/geometry/compress.h"
#include "cw2-bake/textures/payload_compression.h"
#include "mesh-format/decode.h"
#include "small_scene.h"

namespace {

using namespace small_scene;

/// The scene with its geometry compressed.
SmallScene compressed(SmallScene scene = {}) {
    bake::PackedGeometry geometry;
    geometry.meshes = scene.meshes;
    geometry.vertices.assign(scene.vertices.begin(), scene.vertices.end());
    geometry.indices = scene.indices;
    bake::EncodedGeometry encoded = bake::compress(geometry);
    scene.vertices.clear();
    scene.indices.clear();
    scene.encoded_vertices = std::move(encoded.vertices);
    scene.encoded_indices = std::move(encoded.indices);
    return scene;
}

/// What parsing and decoding complain about, or an empty text.
std::string complaint_of_decoding(const Bytes& bytes) {
    try {
        Document document = parse(bytes, "the file");
        decode(document, "the file");
        return {};
    } catch (const FormatError& error) {
        return error.what();
    }
}

TEST(CompressedFile, DecodesToWhatWasCompressed) {
    const SmallScene scene;
    const Bytes bytes = written(compressed());
    Document document = parse(bytes, "the file");
    ASSERT_TRUE(document.is_encoded());
    const DecodedGeometry decoded = decode(document, "the file");
    EXPECT_FALSE(document.is_encoded());
    EXPECT_TRUE(std::ranges::equal(document.vertices, scene.vertices));
    ASSERT_EQ(document.indices.size(), scene.indices.size());
    for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
        // A triangle may start at any of its corners.
        std::vector<std::uint16_t> triangle(&document.indices[i], &document.indices[i] + 3);
        const auto first = std::ranges::find(triangle, scene.indices[i]);
        std::rotate(triangle.begin(), first, triangle.end());
        EXPECT_TRUE(std::equal(triangle.begin(), triangle.end(), &scene.indices[i]));
    }
}

/// What a plain file may not hold a compressed one may not hide.
TEST(CompressedFile, FloatsThatAreNoneAreRefused) {
    SmallScene scene;
    const MeshRecord& mesh = scene.meshes[1];
    const VertexLayout layout = vertex_layout(mesh.forms);
    const std::uint32_t infinity = 0x7F80'0000;
    for (const std::uint32_t offset : {4u, layout.frame_offset + 8, layout.uv_offset + 4}) {
        SmallScene damaged = scene;
        std::memcpy(&damaged.vertices[mesh.vertex_offset + layout.stride + offset], &infinity,
                    sizeof infinity);
        EXPECT_TRUE(
            complaint_of_decoding(written(compressed(damaged))).ends_with(" is not finite"));
    }
}

TEST(CompressedFile, PartsOfOtherSizesAreRefused) {
    for (const SectionKind kind : {SectionKind::encoded_vertices, SectionKind::encoded_indices}) {
        for (std::uint32_t less = 1;; ++less) {
            Forgery forgery(compressed());
            if (less > forgery.record<std::uint32_t>(kind)) break;
            forgery.record<std::uint32_t>(kind, 0) -= less;
            forgery.record<std::uint32_t>(kind, 1) += less;
            // Both meshes' are; which is found first is up to the threads.
            EXPECT_TRUE(complaint_of_decoding(forgery.sealed())
                            .ends_with(": its encoded geometry is damaged"));
        }
    }
}

constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);  // of the parts of two meshes

/// What the Zstandard frames of a section's first part hold.
Bytes stream_of_first(const Bytes& section) {
    std::uint32_t size = 0;
    std::memcpy(&size, section.data(), sizeof size);
    Bytes stream(1 << 16);
    stream.resize(ZSTD_decompress(stream.data(), stream.size(), &section[kSizes], size));
    return stream;
}

/// The section with another stream in its first part.
Bytes with_first(const Bytes& section, const Bytes& stream) {
    std::uint32_t old_size = 0;
    std::memcpy(&old_size, section.data(), sizeof old_size);
    const auto others = std::span(section).subspan(kSizes + old_size);
    Bytes result(kSizes + ZSTD_compressBound(stream.size()) + others.size());
    std::ranges::copy(std::span(section).first(kSizes), result.begin());
    const auto size = static_cast<std::uint32_t>(
        ZSTD_compress(&result[kSizes], result.size() - kSizes, stream.data(), stream.size(), 1));
    std::memcpy(result.data(), &size, sizeof size);
    std::ranges::copy(others, result.begin() + kSizes + size);
    result.resize(kSizes + size + others.size());
    return result;
}

TEST(CompressedFile, StreamsOfOtherSizesAreRefused) {
    SmallScene scene = compressed();
    for (Bytes* const section : {&scene.encoded_vertices, &scene.encoded_indices}) {
        const Bytes whole = *section;
        const Bytes stream = stream_of_first(whole);
        *section = with_first(whole, stream);
        EXPECT_EQ(complaint_of_decoding(written(scene)), "");
        for (const std::size_t size : {std::size_t{0}, std::size_t{1}, stream.size() - 1,
                                       stream.size() + 1, stream.size() + 2, std::size_t{9999}}) {
            Bytes other = stream;
            other.resize(size);
            *section = with_first(whole, other);
            EXPECT_TRUE(complaint_of_decoding(written(scene))
                            .ends_with(": its encoded geometry is damaged"))
                << size << " of " << stream.size();
        }
        *section = whole;
    }
}

TEST(CompressedFile, DamageIsSaidOrMakesOtherGeometry) {
    std::size_t refused = 0;
    for (const SectionKind kind : {SectionKind::encoded_vertices, SectionKind::encoded_indices}) {
        for (std::size_t at = 8; at < Forgery(compressed()).section(kind).size; ++at) {
            for (const unsigned bits : {0x01u, 0x80u, 0xFFu}) {
                Forgery forgery(compressed());
                forgery.record<std::byte>(kind, at) ^= std::byte(bits);
                refused += !complaint_of_decoding(forgery.sealed()).empty();
            }
        }
    }
    EXPECT_GT(refused, 100u);
}

/// A file's only texture, of several parts, and its payload.
struct CompressedTexture {
    CompressedTexture() {
        bake::Texture texture{
            .format = TextureFormat::r8_unorm, .width = 700, .height = 450, .payload = {}};
        texture.payload.resize(mip_chain_bytes(texture.format, texture.width, texture.height));
        for (std::size_t i = 0; i < texture.payload.size(); ++i)
            texture.payload[i] = static_cast<std::byte>(i * i >> 9);
        plain = texture.payload;
        bake::compress_payload(texture);
        stored = texture.payload;
        record = {.format = texture.format,
                  .flags = texture.flags,
                  .width = texture.width,
                  .height = texture.height,
                  .mip_count = full_mip_count(texture.width, texture.height),
                  .size = stored.size()};
    }
    Payload decoded(std::uint32_t first_level = 0) const {
        const Document document{.textures = {&record, 1}, .texels = stored};
        return decode_payload(document, 0, "the file", first_level);
    }

    TextureRecord record{};
    std::vector<std::byte> plain;
    std::vector<std::byte> stored;
};

TEST(CompressedFile, PayloadsDecodeFromAnyLevelOn) {
    const CompressedTexture texture;
    ASSERT_TRUE(texture.record.flags & kCompressed);
    EXPECT_LT(texture.stored.size(), texture.plain.size());
    std::size_t begin = 0;
    for (std::uint32_t level = 0; level < texture.record.mip_count; ++level) {
        const Payload payload = texture.decoded(level);
        ASSERT_EQ(payload.bytes.size(), texture.plain.size());
        EXPECT_TRUE(std::ranges::equal(payload.bytes.subspan(begin),
                                       std::span(texture.plain).subspan(begin)));
        begin += mip_bytes(texture.record.format, 700, 450, level);
    }
}

TEST(CompressedFile, NoiseIsStoredAsItIs) {
    std::mt19937 random(1);
    bake::Texture texture{.format = TextureFormat::r8_unorm, .width = 64, .height = 64};
    texture.payload.resize(mip_chain_bytes(texture.format, 64, 64));
    for (std::byte& value : texture.payload) value = static_cast<std::byte>(random());
    const std::vector<std::byte> plain = texture.payload;
    bake::compress_payload(texture);
    EXPECT_EQ(texture.flags, 0u);
    EXPECT_EQ(texture.payload, plain);
}

/// Whatever it holds, a payload takes what check() asks for, and decodes.
TEST(CompressedFile, TexelsThatAreEqualNearlyEverywhereArePlausible) {
    for (const std::size_t odd : {1, 100'000, 100'000'000}) {
        for (const std::uint32_t size : {31u, 32u, 45u, 1024u, 2048u}) {
            bake::Texture texture{
                .format = TextureFormat::r8_unorm, .width = size, .height = size, .payload = {}};
            texture.payload.resize(mip_chain_bytes(texture.format, size, size), std::byte{9});
            for (std::size_t i = odd; i < texture.payload.size(); i += odd)
                texture.payload[i] = std::byte{200};
            const Bytes plain = texture.payload;
            bake::compress_payload(texture);
            ASSERT_EQ(texture.flags, kCompressed);
            EXPECT_GE(texture.payload.size() * kLargestRatio, plain.size());
            EXPECT_LE(texture.payload.size(), 40 + plain.size() / 900);
            const TextureRecord record{.format = texture.format,
                                       .flags = texture.flags,
                                       .width = size,
                                       .height = size,
                                       .mip_count = full_mip_count(size, size),
                                       .size = texture.payload.size()};
            const Document document{.textures = {&record, 1}, .texels = texture.payload};
            EXPECT_TRUE(std::ranges::equal(decode_payload(document, 0, "the file").bytes, plain));
        }
    }
}

TEST(CompressedFile, DamagedPayloadsAreRefusedOrDecodeToAsMuch) {
    const CompressedTexture whole;
    const auto ends = [&](const CompressedTexture& texture) {
        try {
            EXPECT_EQ(texture.decoded().bytes.size(), whole.plain.size());
            return false;
        } catch (const FormatError& error) {
            EXPECT_EQ(std::string(error.what()),
                      "the file: texture 0: its compressed texels are damaged");
            return true;
        }
    };
    // Sizes of parts, and the frames' first bytes.
    std::size_t refused = 0;
    for (std::size_t at = 0; at < 60; ++at) {
        for (const unsigned bits : {0x01u, 0x80u, 0xFFu}) {
            CompressedTexture texture = whole;
            texture.stored[at] ^= std::byte(bits);
            refused += ends(texture);
        }
    }
    EXPECT_GT(refused, 50u);
    for (std::size_t size = 0; size < whole.stored.size(); size += size < 40 ? 1 : 999) {
        CompressedTexture texture = whole;
        texture.stored.resize(size);
        texture.record.size = size;
        EXPECT_TRUE(ends(texture)) << size;
    }
    // A part as long as another, in its place.
    CompressedTexture texture = whole;
    texture.record.height = 451;
    EXPECT_TRUE(ends(texture));
}

/// A large flat mesh shrinks to less than a thousandth.
TEST(CompressedFile, NextToNothingIsPlausible) {
    constexpr std::uint32_t kChunks = 256;
    constexpr std::uint32_t kChunkIndices = 3 * kMaxChunkTriangles;
    SmallScene scene;
    scene.meshes.resize(1);
    MeshRecord& mesh = scene.meshes.front();
    mesh.vertex_count = kMaxMeshVertices;
    mesh.index_count = kChunks * kChunkIndices;
    mesh.chunk_count = kChunks;
    scene.chunks.clear();
    for (std::uint32_t i = 0; i < kChunks; ++i) {
        scene.chunks.push_back(
            {.first_index = i * kChunkIndices, .index_count = kChunkIndices, .radius = 1.0f});
    }
    scene.vertices.assign(mesh.vertex_count * vertex_layout(mesh.forms).stride, std::byte{0});
    scene.indices.assign(mesh.index_count, 0);
    scene.scene.vertex_bytes = scene.vertices.size();
    scene.scene.index_count = scene.indices.size();
    const SmallScene small = compressed(scene);
    EXPECT_LT(1000 * (small.encoded_vertices.size() + small.encoded_indices.size()),
              scene.vertices.size() + 2 * scene.indices.size());
    EXPECT_EQ(complaint_of_decoding(written(small)), "");
}

/// No more memory is taken than the stored bytes make plausible.
TEST(CompressedFile, ImplausibleSizesAreRefused) {
    Forgery forgery(compressed());
    forgery.scene().vertex_bytes = std::uint64_t{1} << 40;
    EXPECT_EQ(complaint_of_decoding(forgery.sealed()),
              "the file: the scene's sizes are implausible");
}

}  // namespace
