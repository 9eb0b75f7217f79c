#include <gtest/gtest.h>

#include <numbers>

#include "cw2-bake/gltf/materials.h"
#include "tests/unit/gltf_reading.h"

namespace {

using mesh_format::MapUse;

using bake::Channel;
using bake::SourceMaterial;
using bake::SourceScene;

using nlohmann::json;

class GltfMaterials : public GltfReading {
 protected:
    /// The square with this material; its textures 0, 1 and 2 are of the images a, b and c.
    static GltfWriter with_material(const json& material) {
        GltfWriter gltf = square_gltf();
        gltf.root["materials"] = json::array({material});
        gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
        for (const char* name : {"a", "b", "c"}) {
            const int image = gltf.add("images", {{"uri", std::string(name) + ".png"}});
            gltf.add("textures", {{"source", image}});
        }
        return gltf;
    }
    SourceMaterial material(const json& material) {
        const SourceScene scene = read(with_material(material));
        EXPECT_EQ(scene.materials.size(), 1u);
        return scene.materials.at(0);
    }
    static std::string name(const std::optional<bake::TextureMap>& map) {
        return map ? map->file.filename().string() : "";
    }
};

TEST_F(GltfMaterials, TheDefaultIsWhiteMetalSeenFromTheFront) {
    const SourceScene scene = read(square_gltf());
    ASSERT_EQ(scene.materials.size(), 1u);
    const SourceMaterial& material = scene.materials[0];
    EXPECT_EQ(material.name, "default");
    EXPECT_EQ(material.base_color, glm::vec3(1));
    EXPECT_EQ(material.roughness, 1);
    EXPECT_EQ(material.metalness, 1);
    EXPECT_TRUE(material.cull_back);
    EXPECT_FALSE(material.flip_back_normals);
    EXPECT_FALSE(material.base_color_alpha_is_mask);
}

TEST_F(GltfMaterials, FactorsTexturesAndChannelsAreTakenApart) {
    const SourceMaterial m = material({{"name", "stone"},
                                       {"doubleSided", true},
                                       {"pbrMetallicRoughness",
                                        {{"baseColorFactor", {0.25, 0.5, 0.75, 0.5}},
                                         {"baseColorTexture", {{"index", 0}}},
                                         {"metallicFactor", 0.125},
                                         {"roughnessFactor", 0.375},
                                         {"metallicRoughnessTexture", {{"index", 1}}}}},
                                       {"normalTexture", {{"index", 2}, {"scale", 1.5}}}});
    EXPECT_EQ(m.name, "stone");
    EXPECT_EQ(m.base_color, glm::vec3(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(m.metalness, 0.125f);
    EXPECT_EQ(m.roughness, 0.375f);
    EXPECT_EQ(m.normal_scale, 1.5f);
    EXPECT_FALSE(m.cull_back);
    EXPECT_TRUE(m.flip_back_normals);
    EXPECT_EQ(name(m.maps[MapUse::base_color]), "a.png");
    EXPECT_EQ(name(m.maps[MapUse::roughness]), "b.png");
    EXPECT_EQ(name(m.maps[MapUse::metalness]), "b.png");
    EXPECT_EQ(name(m.maps[MapUse::normal]), "c.png");
    EXPECT_EQ(m.maps[MapUse::base_color]->channel, Channel::standard);
    EXPECT_EQ(m.maps[MapUse::roughness]->channel, Channel::g);
    EXPECT_EQ(m.maps[MapUse::metalness]->channel, Channel::b);
    EXPECT_FALSE(m.maps[MapUse::base_color]->clamp);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfMaterials, TheCutoffIsHeldAgainstFactorTimesTexture) {
    json source{{"name", "leaf"}, {"alphaMode", "MASK"}};
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    EXPECT_TRUE(material(source).base_color_alpha_is_mask);
    EXPECT_EQ(material(source).alpha_cutoff, 0.5f);
    // A mask of its own, which counts even if it hides all.
    const auto mask = material(source).maps[MapUse::alpha_mask];
    EXPECT_EQ(name(mask), "a.png");
    EXPECT_EQ(mask.value().channel, Channel::alpha);
    source["alphaCutoff"] = 0.25;
    EXPECT_EQ(material(source).alpha_cutoff, 0.25f);
    source["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
    EXPECT_EQ(material(source).alpha_cutoff, 0.5f);
    EXPECT_TRUE(warnings_.empty());

    // Below the cutoff everywhere: nothing is left of it.
    source["alphaCutoff"] = 0.75;
    GltfWriter gltf = with_material(source);
    json& primitives = gltf.root["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives[1].erase("material");
    const SourceScene scene = read(gltf);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].name, "default");
    EXPECT_EQ(triangle_count(scene), 2u);
    EXPECT_EQ(warnings_, std::vector<std::string>{"scene.glb: /materials/0: 'leaf' is invisible: "
                                                  "its alpha is below its cutoff"});
}

TEST_F(GltfMaterials, BlendedMaterialsAreOpaqueOrMaskedAndTheWarningSaysWhich) {
    json source{{"name", "glass"}, {"alphaMode", "BLEND"}};
    source["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.3};
    SourceMaterial m = material(source);
    EXPECT_TRUE(m.blend);
    EXPECT_EQ(m.opacity, 0.3f);
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             "scene.glb: /materials/0: 'glass' has alpha 0.3; drawn opaque"});
    material({{"name", "glass"}, {"alphaMode", "BLEND"}});
    EXPECT_TRUE(warnings_.empty());  // nothing of it can be seen through
    m = material({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.3}}}}});
    EXPECT_FALSE(m.blend);
    EXPECT_EQ(m.opacity, 1);
    EXPECT_TRUE(warnings_.empty());

    // With a texture it is known only later whether there is a mask.
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    m = material(source);
    EXPECT_TRUE(m.base_color_alpha_is_mask);
    EXPECT_EQ(m.alpha_cutoff, 0.5f);
    EXPECT_TRUE(warnings_.empty());
    std::vector<std::string> said;
    const auto warn = [&](const std::string& what) {
        said.push_back(what.substr(what.find("scene.glb")));
    };
    bake::MaterialTextures with_mask;
    with_mask.textures[MapUse::alpha_mask] = 0;
    SourceMaterial whole = m;
    whole.opacity = 1;
    bake::warn_of_blending(std::vector{m, m, m, whole}, std::vector{with_mask, with_mask, {}, {}},
                           warn);
    const std::string place = "scene.glb: /materials/0: 'glass' ";
    EXPECT_EQ(said, (std::vector<std::string>{
                        place + "is blended; it is drawn with a mask that cuts below alpha 0.5 (2 "
                                "such materials)",
                        place + "has alpha 0.3; drawn opaque"}));
}

TEST_F(GltfMaterials, EmissionHasItsStrengthAndUnlitHasNone) {
    json source{{"emissiveFactor", {1, 0.5, 0}}, {"emissiveTexture", {{"index", 2}}}};
    SourceMaterial m = material(source);
    EXPECT_EQ(m.emission, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(name(m.maps[MapUse::emission]), "c.png");
    EXPECT_FALSE(m.unlit);
    source["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 8;
    EXPECT_EQ(material(source).emission, glm::vec3(8, 4, 0));
    source["extensions"]["KHR_materials_unlit"] = json::object();
    m = material(source);
    EXPECT_TRUE(m.unlit);
    EXPECT_EQ(m.emission, glm::vec3(0));
    EXPECT_FALSE(m.maps[MapUse::emission]);
    EXPECT_TRUE(warnings_.empty());
    source = {{"emissiveTexture", {{"index", 2}}}};  // the factor is 0 unless it is stated
    EXPECT_FALSE(material(source).maps[MapUse::emission]);
}

TEST_F(GltfMaterials, VertexColoursAreEncodedAndLackingOnesAreWhite) {
    GltfWriter gltf = with_material({{"name", "stone"}});
    json& primitives = gltf.root["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives.push_back(primitives[0]);
    primitives[1]["attributes"]["COLOR_0"] = gltf.accessor<float>(
        {1, 0.5f, 0, 0.25f, 0, 0, 0, 1, 1, 1, 1, 1, -1, 2, 0.2f, 0}, kFloat, "VEC4");
    SourceScene scene = read(gltf);
    ASSERT_EQ(scene.colors.size(), 18u);
    EXPECT_EQ(scene.colors[0], 0xFFFF'FFFF);
    EXPECT_EQ(scene.colors[6], 0x4000'BCFF);  // linear 0.5 is sRGB 188
    EXPECT_EQ(scene.colors[7], 0xFF00'0000);
    EXPECT_EQ(scene.colors[11], 0x007C'FF00);
    EXPECT_EQ(scene.colors[17], 0xFFFF'FFFF);
    primitives[1]["attributes"]["COLOR_0"] = gltf.accessor<std::uint8_t>(
        {255, 55, 0, 0, 0, 0, 255, 255, 255, 1, 1, 1}, kUbyte, "VEC3", true);
    scene = read(gltf);
    EXPECT_EQ(scene.colors[6], 0xFF00'80FF);  // linear 55/255 is sRGB 128
    primitives[1]["attributes"]["COLOR_0"] = gltf.accessor<std::uint16_t>(
        {65535, 0, 0, 65535, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, kUshort, "VEC4", true);
    EXPECT_EQ(read(gltf).colors[6], 0xFF00'00FF);
    EXPECT_TRUE(warnings_.empty());
    primitives[1]["attributes"].erase("COLOR_0");
    EXPECT_TRUE(read(gltf).colors.empty());
}

TEST_F(GltfMaterials, Ktx2TexturesAreNamed) {
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    GltfWriter gltf = with_material(source);
    gltf.root["extensionsUsed"] = {"KHR_texture_basisu"};
    gltf.root["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 1;
    const std::string said =
        "scene.glb: /textures/0/extensions/KHR_texture_basisu: KTX2 textures (KHR_texture_basisu) "
        "are not read; the image beside it is taken, if there is one";
    EXPECT_EQ(name(read(gltf).materials.at(0).maps[MapUse::base_color]), "a.png");
    EXPECT_EQ(warnings_, std::vector<std::string>{said});
    gltf.root["textures"][0].erase("source");
    EXPECT_FALSE(read(gltf).materials.at(0).maps[MapUse::base_color]);
    EXPECT_EQ(warnings_,
              (std::vector<std::string>{said, "scene.glb: /materials/0: texture 0 has no image"}));
    gltf.root["extensionsRequired"] = {"KHR_texture_basisu"};
    EXPECT_EQ(error(gltf),
              "scene.glb: /extensionsRequired/0: the extension 'KHR_texture_basisu' is not "
              "supported: KTX2 textures are not read");

    gltf.root["textures"][0]["source"] = 0;  // is no more than the extension asks for
    EXPECT_EQ(name(read(gltf).materials.at(0).maps[MapUse::base_color]), "a.png");
    EXPECT_EQ(warnings_, std::vector<std::string>{said});

    // Without the extension.
    gltf = with_material(source);
    const std::vector<std::uint8_t> ktx{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n'};
    for (const json& image : {json{{"uri", "a.KTX2"}}, json{{"bufferView", gltf.view(ktx)}},
                              json{{"uri", "a.bin"}, {"mimeType", "image/ktx2"}}}) {
        gltf.root["images"][0] = image;
        read(gltf);
        EXPECT_EQ(warnings_, std::vector<std::string>{
                                 "scene.glb: /images/0: is a KTX2 texture, which is not read"});
    }
}

TEST_F(GltfMaterials, TexturesWithoutUvsAreSaid) {
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}, {"texCoord", 1}};
    read(with_material(source));
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             "scene.glb: /meshes/0/primitives/0: has no TEXCOORD_1, which "
                             "its textures ask for (1 primitives)"});
}

TEST_F(GltfMaterials, SamplersClampOrRepeat) {
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    const auto clamps = [&](const json& sampler) {
        GltfWriter gltf = with_material(source);
        gltf.root["samplers"] = json::array({sampler});
        gltf.root["textures"][0]["sampler"] = 0;
        return read(gltf).materials.at(0).maps[MapUse::base_color]->clamp;
    };
    EXPECT_FALSE(clamps({{"wrapS", 10497}}));
    EXPECT_TRUE(clamps({{"wrapS", 33071}, {"wrapT", 33071}}));
    EXPECT_TRUE(warnings_.empty());
    EXPECT_FALSE(clamps({{"wrapS", 33071}}));
    EXPECT_EQ(warnings_.size(), 1u);
    EXPECT_FALSE(clamps({{"wrapS", 33648}, {"wrapT", 33648}}));
    EXPECT_EQ(warnings_.size(), 1u);
}

TEST_F(GltfMaterials, TextureTransformsAreBakedIntoTheUvs) {
    // As the extension words it: scaled, turned counter-clockwise as one sees the image, moved.
    json use{{"index", 0}};
    use["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.25, 0.5}}, {"rotation", std::numbers::pi / 2}, {"scale", {2, 3}}};
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"] = use;
    const SourceScene scene = read(with_material(source));
    // Corner 1: (1, 1) -> (2, 3) -> (3, -2) -> (3.25, -1.5); corner 2: (1, 0) -> (2, 0) -> (0, -2).
    EXPECT_NEAR(glm::distance(uv(scene, 1), glm::vec2(3.25, 1 + 1.5)), 0, 1e-6);
    EXPECT_NEAR(glm::distance(uv(scene, 2), glm::vec2(0.25, 1 + 1.5)), 0, 1e-6);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfMaterials, TheSecondUvSetIsTakenWhereATextureAsksForIt) {
    json source;
    source["normalTexture"] = {{"index", 0}, {"texCoord", 1}};
    GltfWriter gltf = with_material(source);
    gltf.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] =
        gltf.accessor<float>({0.5f, 0.25f, 0, 0, 0, 0, 0, 0}, kFloat, "VEC2");
    EXPECT_EQ(uv(read(gltf), 0), glm::vec2(0.5f, 0.75f));
    // The extension has the last word.
    gltf.root["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"] = {
        {"texCoord", 0}};
    EXPECT_EQ(uv(read(gltf), 0), glm::vec2(0, 0));
}

TEST_F(GltfMaterials, TexturesThatDisagreeFollowTheBaseColour) {
    json source{{"name", "odd"}};
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    source["normalTexture"] = {{"index", 1}};
    source["normalTexture"]["extensions"]["KHR_texture_transform"] = {{"scale", {4, 4}}};
    EXPECT_EQ(uv(read(with_material(source)), 1), glm::vec2(1, 0));
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             "scene.glb: /materials/0: the textures of 'odd' differ in UV "
                             "set or transform; all take those of the base colour"});
}

TEST_F(GltfMaterials, ImagesAreEmbeddedOrFiles) {
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    const auto image = [&](const GltfWriter& gltf) {
        return *read(gltf).materials.at(0).maps[MapUse::base_color];
    };
    GltfWriter gltf = with_material(source);
    const std::vector<std::uint8_t> contents{1, 2, 3, 250};
    const auto bytes = std::as_bytes(std::span(contents));
    gltf.root["images"][0] = {{"name", "in/view"}, {"bufferView", gltf.view(contents)}};
    bake::TextureMap map = image(gltf);
    ASSERT_TRUE(map.embedded);
    EXPECT_TRUE(std::ranges::equal(*map.embedded, bytes));
    EXPECT_EQ(map.file, folder_.path() / "scene.glb/images/0/in_view");

    gltf.root["images"][0] = {{"uri", "data:image/png;base64,AQID+g=="}};
    map = image(gltf);
    ASSERT_TRUE(map.embedded);
    EXPECT_TRUE(std::ranges::equal(*map.embedded, bytes));

    gltf.root["images"][0] = {{"uri", "my%20textures/a+b%C3%A9.png"}};
    map = image(gltf);
    EXPECT_FALSE(map.embedded);
    EXPECT_EQ(map.file, folder_.path() / "my textures/a+b\u00e9.png");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfMaterials, ImagesOfTheSameBytesAreOneHoweverManyViewsTheyHave) {
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    source["normalTexture"]["index"] = 1;
    GltfWriter gltf = with_material(source);
    const int view = gltf.view(std::vector<std::uint8_t>(20'000));  // most of the file
    const int again = gltf.add("bufferViews", json(gltf.root["bufferViews"][view]));
    gltf.root["images"] = {{{"name", "a"}, {"bufferView", view}},
                           {{"name", "b"}, {"bufferView", again}}};
    gltf.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
    const auto maps = read(gltf).materials.at(0).maps;
    EXPECT_TRUE(warnings_.empty()) << warnings_.front();
    ASSERT_TRUE(maps[MapUse::base_color] && maps[MapUse::normal]);
    EXPECT_EQ(maps[MapUse::base_color]->embedded, maps[MapUse::normal]->embedded);
    EXPECT_EQ(maps[MapUse::base_color]->file, maps[MapUse::normal]->file);
}

TEST_F(GltfMaterials, ImagesThatCannotBeHadAreNamedOnce) {
    json source;
    source["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}},
                                      {"metallicRoughnessTexture", {{"index", 0}}}};
    GltfWriter gltf = with_material(source);
    const auto warning = [&](const json& image) {
        gltf.root["images"][0] = image;
        EXPECT_FALSE(read(gltf).materials.at(0).maps[MapUse::base_color]);
        EXPECT_EQ(warnings_.size(), 1u);
        return warnings_.empty() ? "" : warnings_[0];
    };
    const std::string place = "scene.glb: /images/0: ";
    for (const char* uri :
         {"/etc/passwd", "file:a.png", "https://example.com/a.png", "a%zz.png", "a%00.png", ""}) {
        EXPECT_EQ(warning({{"uri", uri}}), place + "'" + uri + "' is no relative path");
    }
    EXPECT_EQ(warning({{"uri", "data:image/png,AAAA"}}),
              place + "is a data URI, but not in base 64");
    EXPECT_EQ(warning({{"uri", "data:image/png;base64,A!AA"}}),
              place + "is a data URI with malformed base 64");
    EXPECT_EQ(warning({{"name", "nothing"}}), place + "needs either a uri or a bufferView");
}

TEST_F(GltfMaterials, WhatIsLeftOutIsNamedOnce) {
    GltfWriter gltf = with_material({{"occlusionTexture", {{"index", 0}}},
                                     {"extensions",
                                      {{"KHR_materials_clearcoat", json::object()},
                                       {"KHR_materials_variants", json::object()},
                                       {"KHR_materials_sheen", {{"extensions", {{"X", 1}}}}}}}});
    gltf.root["materials"].push_back(gltf.root["materials"][0]);
    gltf.root["materials"][1]["extensions"].erase("KHR_materials_sheen");
    gltf.root["extensionsUsed"] = {"KHR_materials_ior", "KHR_xmp_json_ld"};
    gltf.root["nodes"][0]["extras"]["extensions"]["Y"] = 1;
    gltf.root["samplers"] = {{{"magFilter", 9728}}, {{"magFilter", 9729}}, {{"minFilter", 9728}}};
    read(gltf);
    EXPECT_EQ(warnings_,
              (std::vector<std::string>{
                  "scene.glb: /materials/0/occlusionTexture: ambient occlusion is left out (2 such "
                  "places)",
                  "scene.glb: /samplers/0/magFilter: is nearest: textures are smooth all the same",
                  "scene.glb: /materials/0/extensions/KHR_materials_clearcoat: the extension "
                  "'KHR_materials_clearcoat' is not supported, and left out (2 such places)",
                  "scene.glb: /materials/0/extensions/KHR_materials_sheen: the extension "
                  "'KHR_materials_sheen' is not supported, and left out"}));
}

}  // namespace
