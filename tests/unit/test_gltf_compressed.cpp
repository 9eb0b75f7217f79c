// Geometry that EXT_meshopt_compression and KHR_draco_mesh_compression hold, against what went into
// their encoders. Draco's is not here: its library holds a tinygltf of its own, which would take
// the place of ours.
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/unit/gltf_reading.h"

namespace {

using bake::SourceScene;
using nlohmann::json;

using Bytes = std::vector<unsigned char>;

Bytes encode_vertices(const auto& values, std::size_t stride) {
    const std::size_t count = values.size() * sizeof values[0] / stride;
    Bytes bytes(meshopt_encodeVertexBufferBound(count, stride));
    bytes.resize(
        meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), count, stride));
    return bytes;
}

class GltfMeshopt : public GltfReading {
 protected:
    /// Makes the view of an accessor one of `stream`; the first buffer holds the compressed bytes,
    /// the second none at all.
    static json& compress(GltfWriter& gltf, int accessor, const Bytes& stream, const char* mode,
                          std::size_t stride, const char* filter = nullptr) {
        const std::size_t count = gltf.root["accessors"][accessor]["count"];
        const json compressed = gltf.root["bufferViews"][gltf.view(stream)];
        json& view = gltf.root["bufferViews"]
                              [gltf.root["accessors"][accessor]["bufferView"].get<std::size_t>()];
        view = {{"buffer", 1}, {"byteOffset", 0}, {"byteLength", count * stride}};
        json& extension = view["extensions"]["EXT_meshopt_compression"];
        extension = {{"buffer", 0},
                     {"byteOffset", compressed["byteOffset"]},
                     {"byteLength", stream.size()},
                     {"byteStride", stride},
                     {"count", count},
                     {"mode", mode}};
        if (filter) extension["filter"] = filter;
        gltf.root["extensionsUsed"] = {"EXT_meshopt_compression"};
        gltf.root["extensionsRequired"] = {"EXT_meshopt_compression"};
        gltf.root["buffers"] = {
            {{"byteLength", gltf.bytes.size()}},
            {{"byteLength", 1 << 20},
             {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
        return extension;
    }
};

const std::vector<float> kPositions{-1, -1, 0.25f, 1, -1, 0, 1, 1, 0, -1, 1, 0};
const std::vector<std::uint32_t> kIndices{0, 1, 2, 0, 2, 3};

Bytes encode_triangles() {
    Bytes bytes(meshopt_encodeIndexBufferBound(6, 4));
    bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), kIndices.data(), 6));
    return bytes;
}

TEST_F(GltfMeshopt, AttributesAndIndicesAreWhatWasEncoded) {
    GltfWriter gltf = square_gltf();
    compress(gltf, 0, encode_vertices(kPositions, 12), "ATTRIBUTES", 12);
    compress(gltf, 3, encode_triangles(), "TRIANGLES", 2);
    SourceScene scene = read(gltf);
    ASSERT_EQ(triangle_count(scene), 2u);
    EXPECT_EQ(position(scene, 0), glm::vec3(-1, -1, 0.25f));
    EXPECT_EQ(position(scene, 5), glm::vec3(-1, 1, 0));
    EXPECT_TRUE(warnings_.empty());

    Bytes sequence(meshopt_encodeIndexSequenceBound(6, 4));
    sequence.resize(
        meshopt_encodeIndexSequence(sequence.data(), sequence.size(), kIndices.data(), 6));
    compress(gltf, 3, sequence, "INDICES", 2);
    scene = read(gltf);
    ASSERT_EQ(triangle_count(scene), 2u);
    EXPECT_EQ(position(scene, 5), glm::vec3(-1, 1, 0));
}

TEST_F(GltfMeshopt, FiltersAreUndone) {
    GltfWriter gltf = square_gltf();
    const float a = std::sqrt(0.5f);
    const std::vector<float> normals{0, 0, 1, 0, 0, a, a, 0, a, 0, a, 0, 0, -a, -a, 0};
    std::vector<std::int8_t> octahedral(16);
    meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, normals.data());
    gltf.root["accessors"][1]["componentType"] = kByte;
    gltf.root["accessors"][1]["normalized"] = true;
    gltf.root["bufferViews"][1]["byteStride"] = 4;
    compress(gltf, 1, encode_vertices(octahedral, 4), "ATTRIBUTES", 4, "OCTAHEDRAL");
    gltf.root["bufferViews"][1]["byteStride"] = 4;
    std::vector<std::uint32_t> exponential(12);
#if MESHOPTIMIZER_VERSION >= 190
    meshopt_encodeFilterExp(exponential.data(), 4, 12, 20, kPositions.data(),
                            meshopt_EncodeExpSharedVector);
#else
    meshopt_encodeFilterExp(exponential.data(), 4, 12, 20, kPositions.data());
#endif
    compress(gltf, 0, encode_vertices(exponential, 12), "ATTRIBUTES", 12, "EXPONENTIAL");
    const SourceScene scene = read(gltf);
    EXPECT_NEAR(glm::distance(normal(scene, 1), glm::vec3(0, a, a)), 0, 0.02);
    EXPECT_NEAR(glm::distance(normal(scene, 2), glm::vec3(a, 0, a)), 0, 0.02);
    EXPECT_NEAR(glm::distance(position(scene, 0), glm::vec3(-1, -1, 0.25f)), 0, 1e-4);
}

TEST_F(GltfMeshopt, ViewsThatShareTheirBytesAreBounded) {
    GltfWriter gltf = square_gltf();
    std::mt19937 random(1);
    std::vector<float> positions(3 * 3000);
    for (float& value : positions) value = static_cast<float>(random() % 1000);
    const auto accessor = static_cast<std::size_t>(gltf.accessor(positions, kFloat, "VEC3"));
    json& primitives = gltf.root["meshes"][0]["primitives"];
    primitives[0]["attributes"] = {{"POSITION", accessor}};
    compress(gltf, static_cast<int>(accessor), encode_vertices(positions, 12), "ATTRIBUTES", 12);
    gltf.bytes.erase(gltf.bytes.begin() + 200, gltf.bytes.begin() + 36'000);
    const std::size_t view = gltf.root["accessors"][accessor]["bufferView"];
    json& extension = gltf.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
    extension["byteOffset"] = extension["byteOffset"].get<std::size_t>() - 35'800;
    gltf.root["buffers"][0]["byteLength"] = gltf.bytes.size();
    EXPECT_EQ(error(gltf), "");
    for (int i = 0; i < 3; ++i) {
        json another = gltf.root["accessors"][accessor];
        another["bufferView"] = gltf.add("bufferViews", json(gltf.root["bufferViews"][view]));
        json sharing = primitives[0];
        sharing["attributes"]["POSITION"] = gltf.add("accessors", another);
        primitives.push_back(sharing);
    }
    const std::string message = error(gltf);
    EXPECT_TRUE(message.ends_with(": its compressed bytes belong to other views, too")) << message;
}

TEST_F(GltfMeshopt, WhatDoesNotFitIsRefusedWithItsPlace) {
    const auto message = [&](const std::function<void(json&)>& damage) {
        GltfWriter gltf = square_gltf();
        json& extension = compress(gltf, 0, encode_vertices(kPositions, 12), "ATTRIBUTES", 12);
        damage(extension);
        const std::string text = error(gltf);
        const std::string place = "scene.glb: /bufferViews/0/extensions/EXT_meshopt_compression";
        EXPECT_TRUE(text.starts_with(place)) << text;
        return text.substr(std::min(text.size(), place.size()));
    };
    EXPECT_EQ(message([](json& e) { e["mode"] = "LINES"; }), ": its mode 'LINES' is none");
    EXPECT_EQ(message([](json& e) { e["byteStride"] = 6; }),
              ": its byteStride 6 is none of mode ATTRIBUTES");
    EXPECT_EQ(message([](json& e) { e["mode"] = "INDICES"; }),
              ": its byteStride 12 is none of mode INDICES");
    EXPECT_EQ(message([](json& e) { e["filter"] = "QUATERNION"; }),
              ": its filter 'QUATERNION' is none of mode ATTRIBUTES with byteStride 12");
    EXPECT_EQ(message([](json& e) { e["byteOffset"] = 1 << 20; }), ": reaches past its buffer");
    EXPECT_EQ(message([](json& e) { e["buffer"] = 1; }), ": reaches past its buffer");
    EXPECT_EQ(message([](json& e) { e["buffer"] = 2; }), "/buffer: is 2, but there are 2 buffers");
    EXPECT_EQ(message([](json& e) { e.erase("count"); }), ": has no count");
    EXPECT_EQ(message([](json& e) { e["byteLength"] = 20; }), ": is damaged");
    const std::string many = message([](json& e) { e["count"] = 2'000'000'000; });
    EXPECT_TRUE(many.ends_with("bytes are too few for 2000000000 elements")) << many;
    // What decodes to fewer elements than its accessor asks for.
    GltfWriter gltf = square_gltf();
    compress(gltf, 0, encode_vertices(std::vector<float>(9, 0.0f), 12), "ATTRIBUTES", 12)["count"] =
        3;
    EXPECT_EQ(error(gltf), "scene.glb: /accessors/0: reaches past its buffer view");
}

TEST_F(GltfMeshopt, EveryTruncationAndAlterationIsReadOrRefused) {
    const auto whole = encode_vertices(kPositions, 12);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        GltfWriter gltf = square_gltf();
        compress(gltf, 0, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)),
                 "ATTRIBUTES", 12);
        EXPECT_EQ(error(gltf),
                  "scene.glb: /bufferViews/0/extensions/EXT_meshopt_compression: is damaged");
    }
    std::mt19937 random(3);
    for (int round = 0; round < 500; ++round) {
        GltfWriter gltf = square_gltf();
        Bytes vertices = whole, triangles = encode_triangles();
        vertices[random() % vertices.size()] = static_cast<unsigned char>(random());
        triangles[random() % triangles.size()] = static_cast<unsigned char>(random());
        compress(gltf, 0, vertices, "ATTRIBUTES", 12);
        compress(gltf, 3, triangles, "TRIANGLES", 2);
        const std::string message = error(gltf);
        ASSERT_TRUE(message.empty() || message.starts_with("scene.glb: ")) << message;
    }
}

TEST_F(GltfMeshopt, AFallbackBufferNeedNotBeThere) {
    GltfWriter gltf = square_gltf();
    compress(gltf, 0, encode_vertices(kPositions, 12), "ATTRIBUTES", 12);
    gltf.root["extensionsRequired"] = json::array();
    gltf.root["buffers"][1]["uri"] = "missing.bin";
    gltf.root["buffers"][0]["uri"] = "scene.bin";
    gltf.write_gltf(folder_ / "scene.gltf");
    EXPECT_EQ(position(read_file("scene.gltf"), 0), glm::vec3(-1, -1, 0.25f));
    EXPECT_TRUE(warnings_.empty());
}

/// The square with its first vertex at z = 0.25: positions (id 0), UVs (1) and four bytes 1, 0, 0,
/// 0 (2), in the sequential encoding of Draco 1.5.5.
const std::vector<std::uint8_t> kSequential{
    68, 82, 65,  67, 79, 2, 2,   1,   0, 0, 0,   2,   4, 1, 0, 1, 2, 0, 2,   3,   1, 3, 0,   9,
    3,  0,  0,   3,  9,  2, 0,   1,   4, 2, 4,   0,   2, 0, 0, 1, 0, 0, 128, 191, 0, 0, 128, 191,
    0,  0,  128, 62, 0,  0, 128, 63,  0, 0, 128, 191, 0, 0, 0, 0, 0, 0, 128, 63,  0, 0, 128, 63,
    0,  0,  0,   0,  0,  0, 128, 191, 0, 0, 128, 63,  0, 0, 0, 0, 0, 0, 0,   0,   0, 0, 128, 63,
    0,  0,  128, 63, 0,  0, 128, 63,  0, 0, 128, 63,  0, 0, 0, 0, 0, 0, 0,   0,   0, 0, 0,   0,
    0,  1,  1,   0,  2,  3, 1,   64,  1, 0, 1,   0,   0, 0, 0, 0, 1, 0, 0,   0};
/// The same in the edgebreaker encoding, positions and UVs quantised to 11 bits.
const std::vector<std::uint8_t> kEdgebreaker{
    68,  82,  65, 67, 79,  2,   2,  1,   1,   0,   0,  0,   4,   2,   2,   2,   0,  0,   1,
    31,  255, 1,  17, 255, 1,   17, 255, 1,   17,  3,  255, 0,   0,   0,   0,   0,  1,   0,
    0,   1,   0,  9,  3,   0,   0,  2,   1,   3,   9,  2,   0,   1,   2,   1,   4,  2,   4,
    0,   2,   1,  1,  1,   1,   0,  11,  7,   1,   16, 23,  1,   32,  1,   16,  3,  0,   92,
    144, 0,   0,  0,  96,  128, 0,  255, 5,   0,   0,  254, 3,   0,   0,   0,   0,  255, 7,
    0,   0,   0,  0,  128, 191, 0,  0,   128, 191, 0,  0,   0,   0,   0,   0,   0,  64,  11,
    1,   1,   1,  0,  3,   3,   1,  32,  1,   32,  3,  0,   240, 131, 166, 0,   0,  0,   0,
    0,   255, 7,  0,  0,   0,   0,  0,   0,   0,   0,  0,   0,   0,   0,   128, 63, 11,  1,
    1,   1,   0,  2,  3,   1,   64, 1,   0,   1,   0,  0,   0,   0,   0,   1,   0,  0,   0};

class GltfDraco : public GltfReading {
 protected:
    /// The square, its indices, positions, UVs and joints in Draco's data.
    static GltfWriter square(const std::vector<std::uint8_t>& data) {
        GltfWriter gltf = square_gltf();
        for (json& accessor : gltf.root["accessors"]) accessor.erase("bufferView");
        const int joints =
            gltf.add("accessors", {{"componentType", kUbyte}, {"count", 4}, {"type", "VEC4"}});
        json& attributes = primitive(gltf)["attributes"];
        attributes.erase("NORMAL");
        attributes["JOINTS_0"] = joints;
        primitive(gltf)["extensions"]["KHR_draco_mesh_compression"] = {
            {"bufferView", gltf.view(data)},
            {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}, {"JOINTS_0", 2}}}};
        gltf.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
        gltf.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
        return gltf;
    }
    static json& extension(GltfWriter& gltf) {
        return primitive(gltf)["extensions"]["KHR_draco_mesh_compression"];
    }

    const std::string place_ =
        "scene.glb: /meshes/0/primitives/0/extensions/KHR_draco_mesh_compression: ";
};

TEST_F(GltfDraco, TrianglesAreWhatWasEncoded) {
    for (const auto* data : {&kSequential, &kEdgebreaker}) {
        const float tolerance = data == &kSequential ? 0.0f : 2.0f / 2047.0f;
        const SourceScene scene = read(square(*data));
        ASSERT_EQ(triangle_count(scene), 2u);
        EXPECT_EQ(scene.positions.size(), 4u);
        // Draco keeps neither the order of triangles nor where they start.
        std::size_t raised = 0;
        for (std::size_t corner = 0; corner < 6; ++corner) {
            const glm::vec3 p = position(scene, corner);
            EXPECT_NEAR(uv(scene, corner).x, 0.5f * (p.x + 1), tolerance);
            EXPECT_NEAR(uv(scene, corner).y, 0.5f * (p.y + 1), tolerance);
            EXPECT_NEAR(std::abs(p.x), 1, tolerance);
            if (p.x > 0 || p.y > 0) continue;
            ++raised;
            EXPECT_NEAR(p.z, 0.25f, tolerance);
        }
        EXPECT_EQ(raised, 2u);
        EXPECT_GT(face_normal(scene, 0).z, 0.9f);
        EXPECT_GT(face_normal(scene, 1).z, 0.9f);
        EXPECT_TRUE(warnings_.empty());
    }
}

TEST_F(GltfDraco, IntegersStayWhatTheyAre) {
    // Each vertex belongs to joint 1 of two.
    GltfWriter gltf = square(kSequential);
    primitive(gltf)["attributes"]["WEIGHTS_0"] =
        gltf.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4");
    gltf.root["skins"] = {{{"joints", {0, 1}}}};
    gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"translation", {0, 0, 5}}}};
    const SourceScene scene = read(gltf);
    for (const glm::vec3& p : scene.positions) EXPECT_GE(p.z, 5);
}

TEST_F(GltfDraco, WhatDoesNotFitIsRefusedWithItsPlace) {
    EXPECT_EQ(error(square({0, 0, 0, 0})),
              place_ + "its Draco data is damaged: Failed to parse Draco header.");
    GltfWriter gltf = square(kSequential);
    extension(gltf)["attributes"]["POSITION"] = 7;
    EXPECT_EQ(error(gltf), place_ + "its Draco data is damaged: it holds no attribute 7");
    extension(gltf)["attributes"]["POSITION"] = 1;
    EXPECT_EQ(
        error(gltf),
        place_ + "its Draco data is damaged: an attribute and its accessor differ in components");
    extension(gltf)["attributes"]["POSITION"] = -1;
    EXPECT_EQ(error(gltf),
              place_.substr(0, place_.size() - 2) + "/attributes/POSITION: is no whole number");
    extension(gltf)["bufferView"] = 70;
    EXPECT_EQ(error(gltf), place_.substr(0, place_.size() - 2) +
                               "/bufferView: is 70, but there are 5 bufferViews");
    // A mesh that no node shows is not looked at.
    gltf = square({0, 0, 0, 0});
    gltf.root["meshes"].push_back(square_gltf().root["meshes"][0]);
    gltf.root["nodes"][0]["mesh"] = 1;
    EXPECT_EQ(error(gltf), "scene.glb: shows no triangles");
}

TEST_F(GltfDraco, EveryTruncationIsRefused) {
    const std::vector<std::uint8_t>& whole = kSequential;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string message =
            error(square({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}));
        EXPECT_TRUE(message.starts_with(place_ + "its Draco data is damaged: ")) << message;
    }
}

// 100 million triangles, of which the library would make tables before it reads them.
TEST_F(GltfDraco, ClaimsBeyondWhatBytesHoldAreRefused) {
    std::vector<std::uint8_t> data{'D',  'R',  'A',  'C', 'O',  2,    2,    1,
                                   1,    0,    0,    0,   0x80, 0xE1, 0xEB, 0x17,  // vertices
                                   0x80, 0xC2, 0xD7, 0x2F};                        // triangles
    data.resize(200, 1);
    const std::string refusal =
        place_ + "its Draco data is damaged: it claims to hold more than its bytes can";
    EXPECT_EQ(error(square(data)), refusal);
    // Before version 2 numbers were not packed, and there was one more.
    data = {'D', 'R', 'A', 'C', 'O',  1,    3,    1,    1,    0,    0,    0,
            0,   0,   0,   0,   0x80, 0xF0, 0xFA, 0x02, 0x00, 0xE1, 0xF5, 0x05};
    data.resize(200, 1);
    EXPECT_EQ(error(square(data)), refusal);
}

/// With metadata before the claims, of an attribute and of the whole, each with a value and a part;
/// and in the sequential encoding, where entropy codes take no byte for a vertex.
TEST_F(GltfDraco, ClaimsAreFoundBehindMetadataAndInEitherEncoding) {
    const std::string refusal =
        place_ + "its Draco data is damaged: it claims to hold more than its bytes can";
    std::vector<std::uint8_t> data{'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0x80, 1, 0};
    for (int i = 0; i < 2; ++i)
        data.insert(data.end(), {1, 1, 'n', 2, 0xFF, 0xFF, 1, 2, 'p', 'q', 0, 0});
    data.insert(data.end(), {0, 0x80, 0xE1, 0xEB, 0x17, 0x80, 0xC2, 0xD7, 0x2F});
    data.resize(200, 1);
    EXPECT_EQ(error(square(data)), refusal);
    data = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0, 1, 0x80, 0xC2, 0xD7, 0x2F};
    data.resize(200, 1);
    EXPECT_EQ(error(square(data)), refusal);
    data = {'D', 'R', 'A', 'C', 'O', 1, 3, 1, 0, 0, 0, 1, 0, 0, 0, 0x00, 0xE1, 0xF5, 0x05};
    data.resize(200, 1);
    EXPECT_EQ(error(square(data)), refusal);
}

/// In one view or in two of one range, and whether or not they ask for the same attributes.
TEST_F(GltfDraco, PrimitivesThatShareTheirBytesAreDecodedOnce) {
    std::vector<std::uint8_t> data = kSequential;
    data.resize(10'000);  // most of the file
    GltfWriter gltf = square(data);
    json& primitives = gltf.root["meshes"][0]["primitives"];
    primitives.push_back(json(primitives[0]));
    primitives.push_back(json(primitives[0]));
    primitives[1]["attributes"].erase("TEXCOORD_0");
    json& again = primitives[2]["extensions"]["KHR_draco_mesh_compression"];
    again["bufferView"] =
        gltf.add("bufferViews", json(gltf.root["bufferViews"][again["bufferView"].get<int>()]));
    const SourceScene scene = read(gltf);
    ASSERT_EQ(triangle_count(scene), 6u);
    const glm::vec2 none(0, 1);  // glTF's v is downward
    for (std::size_t corner = 0; corner < 18; ++corner) {
        const glm::vec3 p = position(scene, corner % 6);
        EXPECT_EQ(position(scene, corner), p);
        EXPECT_EQ(uv(scene, corner), corner / 6 == 1 ? none : 0.5f * (glm::vec2(p.x, p.y) + 1.0f));
    }
}

TEST_F(GltfDraco, PartsThatOverlapAreBounded) {
    std::vector<std::uint8_t> data = kSequential;
    data.resize(10'000);
    GltfWriter gltf = square(data);
    json& primitives = gltf.root["meshes"][0]["primitives"];
    primitives.push_back(json(primitives[0]));
    json& other = primitives[1]["extensions"]["KHR_draco_mesh_compression"];
    json shorter = gltf.root["bufferViews"][other["bufferView"].get<int>()];
    shorter["byteLength"] = 9'000;
    other["bufferView"] = gltf.add("bufferViews", std::move(shorter));
    const std::string message = error(gltf);
    EXPECT_TRUE(message.ends_with(": its bytes belong to others, too")) << message;
}

TEST_F(GltfDraco, OnlyTrianglesAreDecoded) {
    GltfWriter gltf = square({0});
    primitive(gltf)["mode"] = 1;
    EXPECT_EQ(error(gltf), "scene.glb: shows no triangles");
}

}  // namespace
