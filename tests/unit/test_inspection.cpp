// --inspect tells all that a file says of its scene, its materials and its meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cw2-bake/inspection.h"

namespace {

using namespace mesh_format;

/// A document of one mesh and one material, no two of whose properties have the same value.
struct Inspected : testing::Test {
    Inspected() {
        material.name = {0, 4};
        const float color[3] = {0.125f, 0.25f, 0.375f}, emission[3] = {5.5f, 6.5f, 7.5f};
        std::copy_n(color, 3, material.base_color);
        std::copy_n(emission, 3, material.emission);
        material.roughness = 0.625f;
        material.metalness = 0.75f;
        material.alpha_cutoff = 0.3f;
        material.normal_scale = 1.5f;
        material.opacity = 0.875f;
        for (std::uint32_t use = 0; use < kMapUseCount; ++use) {
            material.textures.values[use] = use == 2 ? kNoTexture : 20 + use;
        }
        mesh.forms = {PositionForm::f32, FrameForm::quat32, UvForm::quantised, ColorForm::rgba8};
        mesh.vertex_count = 3;
        mesh.index_count = 3;
        const double origin[3] = {500'000.25, 0.0, -4'000'000.5};
        std::copy_n(origin, 3, document.scene.origin);
        document.materials = {&material, 1};
        document.meshes = {&mesh, 1};
        document.strings = "n\"\xFCx";
    }

    std::string text() const { return bake::inspection(document, 1000); }
    nlohmann::json json() const {
        return nlohmann::json::parse(bake::inspection_json(document, 1000));
    }

    MaterialRecord material{};
    MeshRecord mesh{};
    Document document;
};

TEST_F(Inspected, HasEveryPropertyOfAMaterial) {
    const std::string words = text();
    for (const char* const part :
         {"base colour 0.125 0.25 0.375", "roughness 0.625", "metalness 0.75", "alpha cutoff 0.3",
          "normal scale 1.5", "emission 5.5 6.5 7.5", "opacity 0.875", "base colour texture 20",
          "roughness texture 21", "normal texture 23", "alpha mask texture 24",
          "emission texture 25"}) {
        EXPECT_NE(words.find(part), std::string::npos) << part << " in\n" << words;
    }
    EXPECT_EQ(words.find("metalness texture"), std::string::npos);
    EXPECT_EQ(json()["materials"][0], nlohmann::json({{"name", "n\"\uFFFDx"},
                                                      {"base_color", {0.125, 0.25, 0.375}},
                                                      {"roughness", 0.625},
                                                      {"metalness", 0.75},
                                                      {"alpha_cutoff", 0.3},
                                                      {"normal_scale", 1.5},
                                                      {"emission", {5.5, 6.5, 7.5}},
                                                      {"opacity", 0.875},
                                                      {"alpha_mask", false},
                                                      {"culled", false},
                                                      {"flips_back_normals", false},
                                                      {"unlit", false},
                                                      {"blend", false},
                                                      {"base_color_texture", 20},
                                                      {"roughness_texture", 21},
                                                      {"metalness_texture", nullptr},
                                                      {"normal_texture", 23},
                                                      {"alpha_mask_texture", 24},
                                                      {"emission_texture", 25}}));
}

TEST_F(Inspected, HasEveryFlagOfAMaterial) {
    const std::vector<std::pair<MaterialFlags, std::pair<const char*, const char*>>> flags{
        {kAlphaMask, {", alpha mask,", "alpha_mask"}},
        {kCullBack, {"seen from the front", "culled"}},
        {kFlipBackNormals, {"lit on both sides", "flips_back_normals"}},
        {kUnlit, {"unlit", "unlit"}},
        {kBlend, {"blended", "blend"}}};
    for (const auto& [flag, names] : flags) {
        material.flags = 0;
        EXPECT_EQ(text().find(names.first), std::string::npos) << names.first;
        material.flags = flag;
        EXPECT_NE(text().find(names.first), std::string::npos) << names.first << text();
        for (const auto& other : flags) {
            EXPECT_EQ(json()["materials"][0][other.second.second], other.first == flag);
        }
    }
}

TEST_F(Inspected, HasOriginAndColors) {
    EXPECT_NE(text().find("500000.25 0 -4000000.5"), std::string::npos) << text();
    EXPECT_NE(text().find("with colours"), std::string::npos) << text();
    EXPECT_EQ(json()["origin"], nlohmann::json({500'000.25, 0.0, -4'000'000.5}));
    EXPECT_EQ(json()["meshes"][0]["color"], "rgba8");
    mesh.forms.color = ColorForm::none;
    EXPECT_EQ(json()["meshes"][0]["color"], "none");
}

}  // namespace
