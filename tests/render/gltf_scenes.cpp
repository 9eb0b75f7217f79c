#include "tests/render/gltf_scenes.h"

#include <cmath>

#include "tests/support/gltf_writer.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A mesh of the rectangle from (0, -1, 0) to (width, -1 + height, 0), its image upright.
GltfWriter plate_gltf(float width, float height, bool tangents) {
    GltfWriter gltf = square_gltf();
    const float top = height - 1.0f;
    json& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["POSITION"] =
        gltf.accessor<float>({0, -1, 0, width, -1, 0, width, top, 0, 0, top, 0}, kFloat, "VEC3");
    if (tangents) {
        attributes["TANGENT"] =
            gltf.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, kFloat, "VEC4");
    }
    gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
    return gltf;
}

GltfWriter mirrored_node(bool tangents) {
    GltfWriter gltf = plate_gltf(2.0f, 2.0f, tangents);
    gltf.root["images"] = {{{"uri", "bumps.png"}}};
    gltf.root["textures"] = {{{"source", 0}}};
    gltf.root["materials"] = {{{"pbrMetallicRoughness",
                                {{"baseColorFactor", {0.6, 0.6, 0.6, 1}},
                                 {"roughnessFactor", 0.4},
                                 {"metallicFactor", 0}}},
                               {"normalTexture", {{"index", 0}}}}};
    gltf.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}}};
    gltf.root["scenes"][0]["nodes"] = {0, 1};
    return gltf;
}

void write_texture_transform(const fs::path& folder) {
    GltfWriter gltf = plate_gltf(1.0f, 1.0f, false);
    gltf.root["images"] = {{{"uri", "letter.png"}}};
    gltf.root["textures"] = {{{"source", 0}}};
    const json transforms = {
        json::object(),
        {{"rotation", M_PI / 6}},
        {{"scale", {3, 2}}},
        {{"offset", {0.25, 0.1}}, {"rotation", -M_PI / 2}, {"scale", {1, -1}}}};
    for (std::size_t i = 0; i < transforms.size(); ++i) {
        json texture{{"index", 0}};
        texture["extensions"]["KHR_texture_transform"] = transforms[i];
        gltf.root["materials"].push_back(
            {{"pbrMetallicRoughness", {{"baseColorTexture", texture}, {"metallicFactor", 0}}}});
        json mesh = gltf.root["meshes"][0];
        mesh["primitives"][0]["material"] = i;
        if (i > 0) gltf.root["meshes"].push_back(mesh);
        gltf.root["nodes"][i] = {{"mesh", i},
                                 {"translation", {1.1 * static_cast<double>(i) - 2.15, 0.5, 0}}};
        gltf.root["scenes"][0]["nodes"][i] = i;
    }
    gltf.root["extensionsUsed"] = {"KHR_texture_transform"};
    gltf.write_glb(folder / "texture_transform.glb");
}

void write_sides(const fs::path& folder) {
    GltfWriter gltf = mirrored_node(false);
    json single = gltf.root["materials"][0];
    json both = single;
    both["doubleSided"] = true;
    both["pbrMetallicRoughness"]["baseColorFactor"] = {0.6, 0.3, 0.2, 1};
    gltf.root["materials"] = {single, both};
    json mesh = gltf.root["meshes"][0];
    mesh["primitives"][0]["material"] = 1;
    gltf.root["meshes"].push_back(mesh);
    // Half a turn about y.
    gltf.root["nodes"] = {{{"mesh", 0}, {"translation", {-3.2, 0, 0}}},
                          {{"mesh", 0}, {"translation", {1, 0, 0}}, {"rotation", {0, 1, 0, 0}}},
                          {{"mesh", 1}, {"translation", {3.2, 0, 0}}, {"rotation", {0, 1, 0, 0}}}};
    gltf.root["scenes"][0]["nodes"] = {0, 1, 2};
    gltf.write_glb(folder / "sides.glb");
}

}  // namespace

void write_gltf_scenes(const fs::path& folder) {
    mirrored_node(false).write_gltf(folder / "mirrored_node.gltf");
    mirrored_node(true).write_glb(folder / "mirrored_node_tangents.glb");
    write_texture_transform(folder);
    write_sides(folder);
}
