// The file format: what is written comes back, and nothing else is taken for a file.

#include <gtest/gtest.h>

#include "small_scene.h"

namespace {

using namespace small_scene;

template <typename T>
void expect_equal(std::span<const T> a, std::span<const T> b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(a), std::as_bytes(b)));
}

void expect_equal(const Document& a, const Document& b) {
    expect_equal(std::span(&a.scene, 1), std::span(&b.scene, 1));
    expect_equal(a.meshes, b.meshes);
    expect_equal(a.chunks, b.chunks);
    expect_equal(a.materials, b.materials);
    expect_equal(a.textures, b.textures);
    expect_equal(a.sources, b.sources);
    EXPECT_EQ(a.strings, b.strings);
    expect_equal(a.vertices, b.vertices);
    expect_equal(a.indices, b.indices);
    expect_equal(a.texels, b.texels);
    expect_equal(a.encoded_vertices, b.encoded_vertices);
    expect_equal(a.encoded_indices, b.encoded_indices);
}

TEST(File, WhatIsWrittenComesBack) {
    for (const bool encoded : {false, true}) {
        SmallScene scene;
        if (encoded) scene.encode();
        const Bytes bytes = written(scene);
        const Document document = parse(bytes, "the file");
        expect_equal(document, scene.document());
        EXPECT_EQ(document.is_encoded(), encoded);
        EXPECT_EQ(document.text(document.materials[1].name), "leaf");

        EXPECT_EQ(written(document, scene.payloads()), bytes);
    }
}

TEST(File, EveryTruncationIsRefused) {
    for (const bool encoded : {false, true}) {
        SmallScene scene;
        if (encoded) scene.encode();
        const Bytes whole = written(scene);
        for (std::size_t size = 0; size < whole.size(); ++size) {
            // A vector of its own, so that reading beyond the end is found.
            const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
            EXPECT_TRUE(complaint(part).starts_with("the file: ")) << size << " bytes";
        }
    }
}

TEST(File, PayloadsAreCheckedWhenAskedFor) {
    Bytes bytes = written({});
    const Document whole = parse(bytes, "the file");
    const std::size_t at = static_cast<std::size_t>(whole.texels.data() - bytes.data()) + 20;
    bytes[at] ^= std::byte{1};
    EXPECT_NE(complaint(bytes).find("texture 1: "), std::string::npos);
    const Document document = parse(bytes, "the file", Payloads::unchecked);
    const auto intact = [&](const TextureRecord& texture) {
        return checksum(document.payload(texture)) == texture.checksum;
    };
    EXPECT_TRUE(intact(document.textures[0]));
    EXPECT_FALSE(intact(document.textures[1]));
}

TEST(File, BytesAfterTheEndAreRefused) {
    Bytes bytes = written({});
    bytes.push_back(std::byte{0});
    EXPECT_NE(complaint(bytes), "");
}

TEST(File, EveryAlteredByteIsRefused) {
    for (const bool encoded : {false, true}) {
        SmallScene scene;
        if (encoded) scene.encode();
        Bytes bytes = written(scene);
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            for (const unsigned change : {0x01u, 0x80u, 0xFFu}) {
                bytes[at] ^= static_cast<std::byte>(change);
                EXPECT_TRUE(complaint(bytes).starts_with("the file: ")) << at;
                bytes[at] ^= static_cast<std::byte>(change);
            }
        }
    }
}

TEST(File, NothingIsWrittenOfAnInvalidDocument) {
    SmallScene scene;
    scene.indices[2] = 4;
    const Sink sink = [](std::span<const std::byte>) { ADD_FAILURE() << "something was written"; };
    EXPECT_THROW(write(scene.document(), scene.payloads(), "the file", sink), FormatError);
}

TEST(File, ChecksumTellsLengthsAndPlacesApart) {
    const Bytes zeros(100);
    for (std::size_t size = 0; size < zeros.size(); ++size) {
        Bytes bytes(size);
        const std::uint64_t sum = checksum(bytes);
        EXPECT_NE(sum, checksum(std::span(zeros).first(size + 1)));
        for (std::size_t at = 0; at < size; ++at) {
            bytes[at] = std::byte{1};
            EXPECT_NE(checksum(bytes), sum);
            bytes[at] = std::byte{0};
        }
    }
}

}  // namespace
