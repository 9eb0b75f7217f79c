#include <fstream>
#include <numbers>

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
        gltf.root["materials"] = {material};
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

TEST_F(GltfMaterials, BlendedMaterialsBecomeMasksWithAWarning) {
    const SourceMaterial m = material({{"name", "glass"}, {"alphaMode", "BLEND"}});
    EXPECT_TRUE(m.base_color_alpha_is_mask);
    EXPECT_EQ(m.alpha_cutoff, 0.5f);
    ASSERT_EQ(warnings_.size(), 1u);
    EXPECT_TRUE(warnings_[0].starts_with("scene.glb: /materials/0: 'glass' is blended"));
}

TEST_F(GltfMaterials, SamplersClampOrRepeat) {
    json source;
    source["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
    const auto clamps = [&](const json& sampler) {
        GltfWriter gltf = with_material(source);
        gltf.root["samplers"] = {sampler};
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
