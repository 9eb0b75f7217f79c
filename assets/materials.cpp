#include "assets/textures.h"

namespace assets {
namespace {

using glm::vec3;

std::string file(const std::string& set, const char* kind) {
    return "textures/" + set + "_" + kind + ".png";
}

/// A dielectric with maps for colour, roughness and normal.
MaterialStatement mapped(const std::string& name, const std::string& set, vec3 tint = vec3(1.0f)) {
    return {.name = name,
            .base_color = tint,
            .base_color_map = file(set, "color"),
            .roughness_map = file(set, "roughness"),
            .normal_map = file(set, "normal")};
}

MaterialStatement metal(const std::string& name, const std::string& set) {
    MaterialStatement material = mapped(name, set);
    material.metalness = 1.0f;
    return material;
}

MaterialStatement rusty(const std::string& name, const std::string& set) {
    MaterialStatement material = metal(name, set);
    material.metalness_map = file(set, "metalness");
    return material;
}

MaterialStatement masked(MaterialStatement material, const std::string& set) {
    material.alpha_map = file(set, "mask");
    return material;
}

MaterialStatement leaf(const std::string& set, float roughness) {
    MaterialStatement material = masked(mapped(set, set), set);
    material.roughness_map.clear();
    material.roughness = roughness;
    return material;
}

MaterialStatement plain(const std::string& name, vec3 color, float roughness) {
    return {.name = name, .base_color = color, .roughness = roughness};
}

MaterialStatement cloth(const std::string& set) {
    MaterialStatement material = mapped(set, set);
    material.normal_map = file("curtain_red", "normal");
    return material;
}

}  // namespace

std::vector<TextureSet> texture_sets() {
    std::vector<TextureSet> all;
    for (const auto& group : {stone_textures(), ceramic_textures(), metal_textures(),
                              cloth_and_wood_textures(), leaf_textures()}) {
        all.insert(all.end(), group.begin(), group.end());
    }
    return all;
}

std::vector<MaterialStatement> materials() {
    MaterialStatement water = mapped("water", "water");
    water.roughness_map.clear();
    water.roughness = 0.09f;
    MaterialStatement carpet = mapped("carpet", "carpet");
    carpet.roughness_map.clear();
    carpet.roughness = 0.93f;
    MaterialStatement gilded = cloth("curtain_red");
    gilded.metalness = 1.0f;
    gilded.metalness_map = file("curtain_red", "metalness");
    MaterialStatement brass = metal("brass", "pierced");
    brass.normal_map.clear();
    return {
        mapped("marble_tile", "marble_tile"),
        mapped("flagstone", "flagstone"),
        mapped("limestone", "limestone"),
        mapped("voussoir", "voussoir"),
        mapped("plaster", "plaster"),
        mapped("brick", "brick"),
        mapped("azulejo", "azulejo"),
        mapped("terracotta", "terracotta"),
        mapped("paver", "paver"),
        water,
        metal("bronze", "bronze"),
        rusty("iron", "iron"),
        masked(rusty("chain", "chain"), "chain"),
        masked(metal("pierced_brass", "pierced"), "pierced"),
        brass,
        gilded,
        cloth("curtain_teal"),
        carpet,
        mapped("wood", "wood"),
        leaf("laurel", 0.42f),
        leaf("ivy", 0.50f),
        leaf("frond", 0.48f),
        plain("orange_peel", vec3(0.80f, 0.27f, 0.02f), 0.38f),
        plain("soil", vec3(0.075f, 0.05f, 0.032f), 0.95f),
        plain("lamp_glass", vec3(0.90f, 0.72f, 0.40f), 0.12f),
    };
}

}  // namespace assets
