// Geometry that EXT_meshopt_compression and KHR_draco_mesh_compression hold, against what went into
// their encoders.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/unit/gltf_reading.h"

namespace {

using bake::SourceScene;
using nlohmann::json;

json& primitive(GltfWriter& gltf) {
    return gltf.root["meshes"][0]["primitives"][0];
}

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
    meshopt_encodeFilterExp(exponential.data(), 4, 12, 20, kPositions.data());
    compress(gltf, 0, encode_vertices(exponential, 12), "ATTRIBUTES", 12, "EXPONENTIAL");
    const SourceScene scene = read(gltf);
    EXPECT_NEAR(glm::distance(normal(scene, 1), glm::vec3(0, a, a)), 0, 0.02);
    EXPECT_NEAR(glm::distance(normal(scene, 2), glm::vec3(a, 0, a)), 0, 0.02);
    EXPECT_NEAR(glm::distance(position(scene, 0), glm::vec3(-1, -1, 0.25f)), 0, 1e-4);
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

class GltfDraco : public GltfReading {
 protected:
    /// Two triangles of four corners with UVs, encoded by Draco.
    static std::vector<char> encoded(int method = draco::MESH_EDGEBREAKER_ENCODING) {
        draco::TriangleSoupMeshBuilder builder;
        builder.Start(2);
        const int position =
            builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
        const int uv =
            builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
        const int color =
            builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
        const glm::vec3 p[] = {{-1, -1, 0.25f}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        const glm::vec2 t[] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
        const std::uint8_t zeros[4] = {};
        for (std::uint32_t face = 0; face < 2; ++face) {
            const std::size_t a = kIndices[3 * face], b = kIndices[3 * face + 1],
                              c = kIndices[3 * face + 2];
            const draco::FaceIndex f(face);
            builder.SetAttributeValuesForFace(position, f, &p[a], &p[b], &p[c]);
            builder.SetAttributeValuesForFace(uv, f, &t[a], &t[b], &t[c]);
            builder.SetAttributeValuesForFace(color, f, zeros, zeros, zeros);
        }
        const auto mesh = builder.Finalize();
        draco::ExpertEncoder encoder(*mesh);
        encoder.SetEncodingMethod(method);
        draco::EncoderBuffer buffer;
        EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
        return {buffer.data(), buffer.data() + buffer.size()};
    }

    /// The square, its indices, positions, UVs and joints in Draco's data.
    static GltfWriter square(const std::vector<char>& data) {
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
    for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
        const SourceScene scene = read(square(encoded(method)));
        ASSERT_EQ(triangle_count(scene), 2u);
        EXPECT_EQ(scene.positions.size(), 4u);
        // Draco keeps neither the order of triangles nor where they start.
        std::size_t seen = 0;
        for (std::size_t corner = 0; corner < 6; ++corner) {
            const glm::vec3 p = position(scene, corner);
            EXPECT_EQ(uv(scene, corner), glm::vec2(0.5f * (p.x + 1), 0.5f * (p.y + 1)));
            seen += p == glm::vec3(-1, -1, 0.25f);
        }
        EXPECT_EQ(seen, 2u);
        EXPECT_GT(face_normal(scene, 0).z, 0.9f);
        EXPECT_GT(face_normal(scene, 1).z, 0.9f);
        EXPECT_TRUE(warnings_.empty());
    }
}

TEST_F(GltfDraco, WhatDoesNotFitIsRefusedWithItsPlace) {
    EXPECT_EQ(error(square({0, 0, 0, 0})), place_ + "its Draco data is damaged: Not a Draco file.");
    GltfWriter gltf = square(encoded());
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

TEST_F(GltfDraco, EveryTruncationAndAlterationIsReadOrRefused) {
    const std::vector<char> whole = encoded();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string message =
            error(square({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}));
        EXPECT_TRUE(message.starts_with(place_ + "its Draco data is damaged: ")) << message;
    }
}

}  // namespace
