#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>

#include "tests/unit/gltf_reading.h"

namespace {

using nlohmann::json;

class GltfMalformed : public GltfReading {
 protected:
    std::string error_of_text(const std::string& text, const std::string& name = "scene.gltf") {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return error_of_file(name);
    }
};

struct Damage {
    const char* message;  ///< after "scene.glb: "
    std::function<void(GltfWriter&)> apply;
};

const Damage kDamages[] = {
    {"/: has no asset", [](GltfWriter& g) { g.root.erase("asset"); }},
    {"/asset/version: is glTF 1.0; only 2.0 is read",
     [](GltfWriter& g) { g.root["asset"]["version"] = "1.0"; }},
    {"/asset/version: is glTF 1.0; only 2.0 is read",
     [](GltfWriter& g) { g.root["asset"]["version"] = 1; }},
    {"/asset/version: is glTF 1.1; only 2.0 is read",
     [](GltfWriter& g) {
         g.root = {{"asset", {{"version", 1.1}}}, {"meshes", json::object()}};
     }},
    {"/asset/version: is missing, so this is glTF 1.0; only 2.0 is read",
     [](GltfWriter& g) {
         g.root = {{"meshes", json::object()}, {"scene", "a"}};
     }},
    {"/asset/version: is glTF 3.0; only 2.0 is read",
     [](GltfWriter& g) { g.root["asset"]["version"] = "3.0"; }},
    {"/asset/version: is glTF 'two'; only 2.0 is read",
     [](GltfWriter& g) { g.root["asset"]["version"] = "two"; }},
    {"/asset/version: is no string",
     [](GltfWriter& g) { g.root["asset"]["version"] = json::array(); }},
    {"/asset: has no version", [](GltfWriter& g) { g.root["asset"] = json::object(); }},
    {"/extensionsRequired/1: the extension 'KHR_materials_sheen' is not supported",
     [](GltfWriter& g) {
         g.root["extensionsRequired"] = {"KHR_texture_transform", "KHR_materials_sheen"};
     }},
    {"/materials/0/normalTexture/scale: is too large",
     [](GltfWriter& g) {
         g.root["images"] = {{{"uri", "a.png"}}};
         g.root["textures"] = {{{"source", 0}}};
         g.root["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", 1e300}}}}};
         primitive(g)["material"] = 0;
     }},
    {"/accessors: is no array", [](GltfWriter& g) { g.root["accessors"] = 3; }},
    {"/accessors/1: is no object", [](GltfWriter& g) { g.root["accessors"][1] = "x"; }},
    {"/accessors/0/count: is no whole number",
     [](GltfWriter& g) { g.root["accessors"][0]["count"] = "4"; }},
    {"/accessors/0/count: is no whole number",
     [](GltfWriter& g) { g.root["accessors"][0]["count"] = 3.5; }},
    {"/accessors/0/count: is no whole number",
     [](GltfWriter& g) { g.root["accessors"][0]["count"] = -4; }},
    {"/accessors/0/count: is 0", [](GltfWriter& g) { g.root["accessors"][0]["count"] = 0; }},
    {"/accessors/0/count: is absurdly large",
     [](GltfWriter& g) { g.root["accessors"][0]["count"] = 1e18; }},
    {"/accessors/0: reaches past its buffer view",
     [](GltfWriter& g) { g.root["accessors"][0]["count"] = 1'000'000'000'000; }},
    {"/accessors/0: reaches past its buffer view",
     [](GltfWriter& g) { g.root["accessors"][0]["byteOffset"] = 4; }},
    {"/accessors/0: claims too many elements without a view",
     [](GltfWriter& g) {
         g.root["accessors"][0].erase("bufferView");
         g.root["accessors"][0]["count"] = 1'000'000'000;
         primitive(g)["attributes"].erase("NORMAL");
         primitive(g)["attributes"].erase("TEXCOORD_0");
     }},
    {"/accessors/0/componentType: is 5124, which is none",
     [](GltfWriter& g) { g.root["accessors"][0]["componentType"] = 5124; }},
    {"/accessors/0/type: is 'VEC5', which is none",
     [](GltfWriter& g) { g.root["accessors"][0]["type"] = "VEC5"; }},
    {"/accessors/0: has not 3 components, as its use asks",
     [](GltfWriter& g) { g.root["accessors"][0]["type"] = "VEC2"; }},
    {"/accessors/0/bufferView: is 9, but there are 4 bufferViews",
     [](GltfWriter& g) { g.root["accessors"][0]["bufferView"] = 9; }},
    {"/accessors/0: element 2 is not finite",
     [](GltfWriter& g) {
         const float nan = NAN;
         std::memcpy(g.bytes.data() + 2 * 12, &nan, sizeof nan);
     }},
    {"/accessors/0: a sparse index is out of range",
     [](GltfWriter& g) {
         g.root["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", g.view<std::uint8_t>({4})}, {"componentType", kUbyte}}},
             {"values", {{"bufferView", g.view<float>({1, 2, 3})}}}};
     }},
    {"/bufferViews/0: reaches past its buffer",
     [](GltfWriter& g) { g.root["bufferViews"][0]["byteLength"] = 100'000; }},
    {"/bufferViews/0: reaches past its buffer",
     [](GltfWriter& g) { g.root["bufferViews"][0]["byteOffset"] = 1'000'000'000'000; }},
    {"/bufferViews/0/byteStride: is 6, no multiple of 4 from 4 to 252",
     [](GltfWriter& g) { g.root["bufferViews"][0]["byteStride"] = 6; }},
    {"/meshes/0/primitives/0/indices: refers to vertex 4 of 4",
     [](GltfWriter& g) {
         primitive(g)["indices"] = g.accessor<std::uint16_t>({0, 1, 4}, kUshort, "SCALAR");
     }},
    {"/accessors/0: holds no indices: scalars of an unsigned type",
     [](GltfWriter& g) { primitive(g)["indices"] = 0; }},
    {"/meshes/0/primitives/0/attributes: its accessors differ in count",
     [](GltfWriter& g) { g.root["accessors"][1]["count"] = 3; }},
    {"/meshes/0/primitives/0/mode: is no mode", [](GltfWriter& g) { primitive(g)["mode"] = 7; }},
    {"/meshes/0/primitives/0/attributes/POSITION: is 12, but there are 4 accessors",
     [](GltfWriter& g) { primitive(g)["attributes"]["POSITION"] = 12; }},
    {"/nodes/0/mesh: is 1, but there are 1 meshes",
     [](GltfWriter& g) { g.root["nodes"][0]["mesh"] = 1; }},
    {"/nodes/0/matrix: is not of 16 numbers",
     [](GltfWriter& g) {
         g.root["nodes"][0]["matrix"] = {1, 2, 3};
     }},
    {"/nodes/0/scale/1: is no finite number",
     [](GltfWriter& g) {
         g.root["nodes"][0]["scale"] = {1, "x", 1};
     }},
    {"/nodes/0: is its own descendant",
     [](GltfWriter& g) { g.root["nodes"][0]["children"] = {0}; }},
    {"/nodes/2: is its own descendant",
     [](GltfWriter& g) {
         g.root["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
     }},
    {"/nodes/1/children/0: is a child of node 0, too",
     [](GltfWriter& g) {
         g.root["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
     }},
    {"/meshes/0/primitives/0: its node takes it out of the range of floats",
     [](GltfWriter& g) {
         g.root["nodes"][0]["scale"] = {1e300, 1, 1};
     }},
    {"/cameras/0/type: is 'round', which is none",
     [](GltfWriter& g) {
         g.root["cameras"] = {{{"type", "round"}}};
     }},
    {"/cameras/0: has no perspective",
     [](GltfWriter& g) {
         g.root["cameras"] = {{{"type", "perspective"}}};
     }},
    {"/nodes/0/extensions/KHR_lights_punctual/light: is absurdly large",
     [](GltfWriter& g) {
         g.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
         g.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0xFFFF'FFFF;
     }},
    {"/accessors/0/sparse/values/byteOffset: is absurdly large",
     [](GltfWriter& g) {
         g.root["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", 0}, {"componentType", kUbyte}}},
             {"values", {{"bufferView", 0}, {"byteOffset", (std::int64_t{1} << 32) - 12}}}};
     }},
    {"/meshes/0/primitives/0: its texture's transform takes it out of the range of floats",
     [](GltfWriter& g) {
         g.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {
             {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {1e39, 0}}}}}}};
         g.root["textures"] = {{{"source", 0}}};
         g.root["images"] = {{{"uri", "a.png"}}};
         primitive(g)["material"] = 0;
     }},
    {"/scene: is 4, but there are 1 scenes", [](GltfWriter& g) { g.root["scene"] = 4; }},
    {"/buffers/1: has no contents",
     [](GltfWriter& g) {
         g.root["buffers"] = {{{"byteLength", g.bytes.size()}}, {{"byteLength", 4}}};
     }},
};

TEST_F(GltfMalformed, IsRefusedWithItsPlace) {
    for (const Damage& damage : kDamages) {
        GltfWriter gltf = square_gltf();
        damage.apply(gltf);
        EXPECT_EQ(error(gltf), std::string("scene.glb: ") + damage.message);
    }
}

TEST_F(GltfMalformed, BuffersThatCannotBeHadAreErrors) {
    GltfWriter gltf = square_gltf();
    const auto message = [&](const json& buffer) {
        gltf.root["buffers"] = json::array({buffer});
        gltf.write_gltf(folder_ / "scene.gltf");
        return error_of_file("scene.gltf");
    };
    EXPECT_EQ(message({{"byteLength", 4}}), "scene.gltf: /buffers/0: has no contents");
    const std::string missing = message({{"byteLength", 4}, {"uri", "none.bin"}});
    EXPECT_TRUE(missing.starts_with("scene.gltf: /buffers/0: ")) << missing;
    EXPECT_NE(missing.find("none.bin"), missing.npos);
    EXPECT_EQ(
        message({{"byteLength", 10'000}, {"uri", "scene.bin"}}),
        "scene.gltf: /buffers/0: holds " + std::to_string(gltf.bytes.size()) + " bytes of 10000");
    EXPECT_EQ(message({{"byteLength", 6}, {"uri", "data:;base64,AAAA"}}),
              "scene.gltf: /buffers/0: holds 3 bytes of 6");
    EXPECT_EQ(message({{"byteLength", gltf.bytes.size()}, {"uri", "scene.bin"}}), "");
}

TEST_F(GltfMalformed, JsonIsRefusedWithItsLine) {
    EXPECT_EQ(error_of_text("{\"asset\": {\n\"version\" \"2.0\"}}"),
              "scene.gltf:2: is no JSON: unexpected '\"'");
    EXPECT_EQ(error_of_text("{\"asset\":\n\n"), "scene.gltf:3: is no JSON: unexpected end");
    EXPECT_EQ(error_of_text(""), "scene.gltf:1: is no JSON: unexpected end");
    EXPECT_EQ(error_of_text("[]"), "scene.gltf: /: is no object");
    EXPECT_EQ(error_of_text("{\"a\": \"1e999 \\\" 2\", \"b\": 1e-999,\n\"c\": [4, -1e309]}"),
              "scene.gltf:2: is no JSON: the number -1e309 is too large");
    EXPECT_EQ(error_of_text("{\n\"extras\": " + std::string(100'000, '[')),
              "scene.gltf:2: is nested deeper than 64 levels");
}

TEST_F(GltfMalformed, AVersionMayBeANumber) {
    for (const json& version : {json(2), json(2.0), json("2"), json("2.0"), json("2.1")}) {
        GltfWriter gltf = square_gltf();
        gltf.root["asset"]["version"] = version;
        EXPECT_EQ(error(gltf), "");
    }
}

TEST_F(GltfMalformed, EveryTruncationOfABinaryIsRefused) {
    const std::string whole = square_gltf().glb();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string message = error_of_text(whole.substr(0, size), "scene.glb");
        ASSERT_TRUE(message.starts_with("scene.glb:")) << size << ": " << message;
    }
    EXPECT_EQ(error_of_text(whole.substr(0, 100), "scene.glb"),
              "scene.glb: is truncated: 100 of " + std::to_string(whole.size()) + " bytes");
}

TEST_F(GltfMalformed, ManyInstancesOfAMeshDoNotTakeAllMemory) {
    GltfWriter gltf = square_gltf();
    std::vector<std::uint16_t> indices;
    for (int i = 0; i < 100'000; ++i) indices.insert(indices.end(), {0, 1, 2});
    primitive(gltf)["indices"] = gltf.accessor(indices, kUshort, "SCALAR");
    json nodes = json::array();
    for (int i = 0; i < 10'000; ++i) nodes.push_back({{"mesh", 0}});
    gltf.root["nodes"] = nodes;
    gltf.root.erase("scene");
    const std::string message = error(gltf);
    EXPECT_NE(message.find("implausible for the file's bytes"), message.npos) << message;
}

TEST_F(GltfMalformed, MeshesThatTakeTurnsDoNotTakeAllDay) {
    GltfWriter gltf = square_gltf();
    const std::vector<float> zeros(3 << 20);
    json meshes = json::array(), nodes = json::array();
    for (int i = 0; i < 2; ++i) {
        json mesh = gltf.root["meshes"][0];
        mesh["primitives"][0]["attributes"] = {{"POSITION", gltf.accessor(zeros, kFloat, "VEC3")}};
        meshes.push_back(mesh);
    }
    for (int i = 0; i < 10'000; ++i) nodes.push_back({{"mesh", i % 2}});
    gltf.root["meshes"] = meshes;
    gltf.root["nodes"] = nodes;
    gltf.root.erase("scene");
    const std::string message = error(gltf);
    EXPECT_NE(message.find("take turns"), message.npos) << message;
}

/// Any bytes are read or refused with one line, and nothing else happens.
TEST_F(GltfMalformed, AlteredFilesAreReadOrRefused) {
    GltfWriter gltf = square_gltf();
    gltf.root["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}, {"alphaMode", "MASK"}}};
    primitive(gltf)["material"] = 0;
    gltf.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
    gltf.root["samplers"] = {{{"wrapS", 33071}}};
    gltf.root["images"] = {{{"bufferView", 0}}};
    gltf.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    gltf.root["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"camera", 0}, {"scale", {1, 2, 3}}}};
    gltf.root["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", gltf.view<std::uint8_t>({1})}, {"componentType", kUbyte}}},
        {"values", {{"bufferView", gltf.view<float>({1, 2, 3})}}}};
    const std::string whole = gltf.glb();
    ASSERT_EQ(error_of_text(whole, "scene.glb"), "");

    std::mt19937 random(7);
    const std::string_view alphabet = "0123456789-.{}[]\",:eE truenfals\\";
    for (int round = 0; round < 4000; ++round) {
        std::string altered = whole;
        const std::size_t changes = 1 + random() % 4;
        for (std::size_t i = 0; i < changes; ++i) {
            char& byte = altered[random() % altered.size()];
            byte = random() % 4 == 0 ? static_cast<char>(random())
                                     : alphabet[random() % alphabet.size()];
        }
        const std::string message = error_of_text(altered, "scene.glb");
        ASSERT_EQ(message.find('\n'), message.npos) << message;
        ASSERT_TRUE(message.empty() || message.starts_with("scene.glb:")) << message;
    }
}

}  // namespace
