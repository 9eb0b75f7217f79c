#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <set>

#include "tests/unit/gltf_reading.h"

namespace {

using bake::kAbsent;
using bake::SourceScene;

class GltfGeometry : public GltfReading {};

/// The triangles as sets of x coordinates in their cyclic order, smallest first.
std::multiset<std::array<float, 3>> triangles_by_x(const SourceScene& scene) {
    std::multiset<std::array<float, 3>> result;
    for (std::size_t t = 0; t < triangle_count(scene); ++t) {
        std::array<float, 3> x{};
        for (std::size_t k = 0; k < 3; ++k) x[k] = position(scene, 3 * t + k).x;
        std::rotate(x.begin(), std::ranges::min_element(x), x.end());
        result.insert(x);
    }
    return result;
}

/// Six vertices of x = 0..5 on a circle, so that no triangle is degenerate.
GltfWriter hexagon(int mode, const std::vector<std::uint16_t>& indices) {
    GltfWriter gltf;
    std::vector<float> positions;
    for (int i = 0; i < 6; ++i) {
        const double angle = i * glm::pi<double>() / 3.0;
        positions.insert(positions.end(),
                         {static_cast<float>(i), static_cast<float>(std::sin(angle)),
                          static_cast<float>(std::cos(angle))});
    }
    nlohmann::json primitive{
        {"attributes", {{"POSITION", gltf.accessor(positions, kFloat, "VEC3")}}}, {"mode", mode}};
    if (!indices.empty()) primitive["indices"] = gltf.accessor(indices, kUshort, "SCALAR");
    gltf.root["meshes"][0]["primitives"] = nlohmann::json::array({primitive});
    gltf.root["nodes"][0]["mesh"] = 0;
    return gltf;
}

TEST_F(GltfGeometry, EveryModeThatMakesTrianglesIsRead) {
    using Set = std::multiset<std::array<float, 3>>;
    EXPECT_EQ(triangles_by_x(read(hexagon(4, {}))), (Set{{0, 1, 2}, {3, 4, 5}}));
    EXPECT_EQ(triangles_by_x(read(hexagon(4, {5, 1, 0, 2, 3, 4}))), (Set{{0, 5, 1}, {2, 3, 4}}));
    EXPECT_EQ(triangles_by_x(read(hexagon(5, {}))),
              (Set{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}}));
    // A strip that is continued by repeating vertices; what has no area is left out.
    EXPECT_EQ(triangles_by_x(read(hexagon(5, {0, 1, 2, 2, 3, 3, 4, 5}))),
              (Set{{0, 1, 2}, {3, 5, 4}}));
    EXPECT_EQ(triangles_by_x(read(hexagon(6, {}))),
              (Set{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfGeometry, PointsAndLinesAreLeftOutWithOneWarning) {
    GltfWriter gltf = hexagon(4, {});
    nlohmann::json& primitives = gltf.root["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives.push_back(primitives[0]);
    primitives[1]["mode"] = 0;
    primitives[2]["mode"] = 3;
    EXPECT_EQ(triangle_count(read(gltf)), 2u);
    EXPECT_EQ(
        warnings_,
        std::vector<std::string>{
            "scene.glb: /meshes/0/primitives/1: points and lines are left out (2 primitives)"});
    primitives.erase(0);
    EXPECT_EQ(error(gltf), "scene.glb: shows no triangles");
}

TEST_F(GltfGeometry, IndicesOfEveryWidthMeanTheSame) {
    const auto with_indices = [](const auto& indices, int type) {
        GltfWriter gltf = square_gltf();
        gltf.root["meshes"][0]["primitives"][0]["indices"] = gltf.accessor(indices, type, "SCALAR");
        return gltf;
    };
    const SourceScene bytes = read(with_indices(std::vector<std::uint8_t>{2, 3, 0}, kUbyte));
    const SourceScene words = read(with_indices(std::vector<std::uint32_t>{2, 3, 0}, kUint));
    for (const SourceScene* scene : {&bytes, &words}) {
        ASSERT_EQ(triangle_count(*scene), 1u);
        EXPECT_EQ(position(*scene, 0), glm::vec3(1, 1, 0));
        EXPECT_EQ(position(*scene, 1), glm::vec3(-1, 1, 0));
        EXPECT_EQ(position(*scene, 2), glm::vec3(-1, -1, 0));
    }
}

TEST_F(GltfGeometry, QuantisedAttributesAreWhatTheirTypeSays) {
    GltfWriter gltf = square_gltf();
    gltf.root["extensionsUsed"] = {"KHR_mesh_quantization"};
    gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    nlohmann::json& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
    // Padded to 4 words, as vertex attributes are.
    const int positions = gltf.view<std::int16_t>(
        {-32767, -32768, 0, 0, 32767, -16384, 0, 0, 32767, 32767, 0, 0, -32767, 32767, 0, 0}, 8);
    attributes["POSITION"] = gltf.add("accessors", {{"bufferView", positions},
                                                    {"componentType", kShort},
                                                    {"normalized", true},
                                                    {"count", 4},
                                                    {"type", "VEC3"}});
    const int normals =
        gltf.view<std::int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 90, 90, 0}, 4);
    attributes["NORMAL"] = gltf.add("accessors", {{"bufferView", normals},
                                                  {"componentType", kByte},
                                                  {"normalized", true},
                                                  {"count", 4},
                                                  {"type", "VEC3"}});
    attributes["TEXCOORD_0"] =
        gltf.accessor<std::uint16_t>({0, 65535, 13107, 0, 0, 0, 0, 0}, kUshort, "VEC2", true);
    const SourceScene scene = read(gltf);
    EXPECT_EQ(position(scene, 0), glm::vec3(-1, -1, 0));  // -32768 is -1, too
    EXPECT_EQ(position(scene, 1), glm::vec3(1, -16384.0f / 32767.0f, 0));
    EXPECT_EQ(normal(scene, 0), glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::distance(normal(scene, 5), glm::vec3(0, std::sqrt(0.5f), std::sqrt(0.5f))), 0,
                1e-6);
    EXPECT_EQ(uv(scene, 0), glm::vec2(0, 0));  // v turns up
    EXPECT_EQ(uv(scene, 1), glm::vec2(13107.0f / 65535.0f, 1));

    attributes["POSITION"] =
        gltf.accessor<std::uint8_t>({0, 0, 0, 0, 200, 0, 0, 0, 200, 255, 0, 0}, kUbyte, "VEC3");
    attributes["TEXCOORD_0"] = gltf.accessor<std::int8_t>({0, 3, -5, 0, 0, 0, 0, 0}, kByte, "VEC2");
    const SourceScene integers = read(gltf);
    EXPECT_EQ(position(integers, 1), glm::vec3(0, 200, 0));
    EXPECT_EQ(uv(integers, 0), glm::vec2(0, -2));
    EXPECT_EQ(uv(integers, 1), glm::vec2(-5, 1));
}

TEST_F(GltfGeometry, InterleavedAttributesShareAView) {
    GltfWriter gltf = square_gltf();
    const int view = gltf.view<float>({-2, -2, 0, 0, 0, 1, 9, 2,  -2, 0, 0, 0, 1, 9,  //
                                       2,  2,  0, 0, 0, 1, 9, -2, 2,  0, 0, 0, 1, 9},
                                      28);
    nlohmann::json& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
    nlohmann::json accessor{
        {"bufferView", view}, {"componentType", kFloat}, {"count", 4}, {"type", "VEC3"}};
    attributes["POSITION"] = gltf.add("accessors", accessor);
    accessor["byteOffset"] = 12;
    attributes["NORMAL"] = gltf.add("accessors", accessor);
    const SourceScene scene = read(gltf);
    EXPECT_EQ(position(scene, 2), glm::vec3(2, 2, 0));
    EXPECT_EQ(position(scene, 5), glm::vec3(-2, 2, 0));
    EXPECT_EQ(normal(scene, 5), glm::vec3(0, 0, 1));
}

TEST_F(GltfGeometry, SparseElementsReplaceThoseOfTheView) {
    GltfWriter gltf = square_gltf();
    const nlohmann::json sparse{
        {"count", 2},
        {"indices", {{"bufferView", gltf.view<std::uint8_t>({1, 3})}, {"componentType", kUbyte}}},
        {"values", {{"bufferView", gltf.view<float>({5, 6, 7, 8, 9, 10})}}}};
    gltf.root["accessors"][0]["sparse"] = sparse;
    SourceScene scene = read(gltf);
    EXPECT_EQ(position(scene, 0), glm::vec3(-1, -1, 0));
    EXPECT_EQ(position(scene, 1), glm::vec3(5, 6, 7));
    EXPECT_EQ(position(scene, 5), glm::vec3(8, 9, 10));
    gltf.root["accessors"][0].erase("bufferView");  // then the others are 0
    scene = read(gltf);
    EXPECT_EQ(position(scene, 0), glm::vec3(0));
    EXPECT_EQ(position(scene, 1), glm::vec3(5, 6, 7));
}

TEST_F(GltfGeometry, NodesMoveWhatIsBelowThem) {
    GltfWriter gltf = square_gltf();
    // A quarter turn about z, scaled before it and moved after it; below it one that moves by x.
    const double h = std::sqrt(0.5);
    gltf.root["nodes"] = {
        {{"children", {1}},
         {"translation", {10, 0, 0}},
         {"rotation", {0, 0, h, h}},
         {"scale", {2, 3, 1}}},
        {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1}}}};
    const SourceScene scene = read(gltf);
    // (1, -1, 0) -> (2, -1, 0) -> (4, -3, 0) -> (3, 4, 0) -> (13, 4, 0)
    EXPECT_NEAR(glm::distance(position(scene, 1), glm::vec3(13, 4, 0)), 0, 1e-5);
    EXPECT_NEAR(glm::distance(normal(scene, 1), glm::vec3(0, 0, 1)), 0, 1e-6);
}

TEST_F(GltfGeometry, TheDefaultSceneIsShownElseEveryRoot) {
    GltfWriter gltf = square_gltf();
    gltf.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"children", {2}}}, {{"mesh", 0}}};
    gltf.root["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {0}}}};
    gltf.root["scene"] = 1;
    EXPECT_EQ(triangle_count(read(gltf)), 2u);
    gltf.root["scene"] = 0;
    EXPECT_EQ(triangle_count(read(gltf)), 6u);
    gltf.root.erase("scene");
    gltf.root.erase("scenes");
    EXPECT_EQ(triangle_count(read(gltf)), 6u);
}

TEST_F(GltfGeometry, UnevenScalesKeepNormalsUpright) {
    GltfWriter gltf = square_gltf();
    // Turned by 45 degrees about y, then squeezed along x: the surface turns, its normal otherwise.
    gltf.root["nodes"] = {
        {{"children", {1}}, {"scale", {0.25, 1, 1}}},
        {{"mesh", 0}, {"rotation", {0, std::sin(M_PI / 8), 0, std::cos(M_PI / 8)}}}};
    gltf.root["scenes"][0]["nodes"] = {0};
    const SourceScene scene = read(gltf);
    for (std::size_t corner = 0; corner < 6; ++corner)
        EXPECT_NEAR(glm::distance(normal(scene, corner), face_normal(scene, corner / 3)), 0, 1e-6);
    EXPECT_GT(normal(scene, 0).x, 0.9f);
}

TEST_F(GltfGeometry, MirroredNodesKeepFacesAndFramesConsistent) {
    GltfWriter gltf = square_gltf();
    gltf.root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
        gltf.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, kFloat, "VEC4");
    for (const auto& scale : {glm::vec3(-1, 1, 1), glm::vec3(1, -2, 1), glm::vec3(1, 1, -1),
                              glm::vec3(-1, -1, 1), glm::vec3(-1, -1, -3)}) {
        gltf.root["nodes"][0]["scale"] = {scale.x, scale.y, scale.z};
        const SourceScene scene = read(gltf);
        ASSERT_EQ(scene.tangents.size(), 6u);
        for (std::size_t corner = 0; corner < 6; ++corner) {
            const glm::vec3 n = normal(scene, corner);
            const glm::vec3 t(scene.tangents[corner]);
            // What was +z, +x and +y of the square is where the scale takes it.
            EXPECT_EQ(face_normal(scene, corner / 3), n);
            EXPECT_EQ(n, glm::sign(glm::vec3(0, 0, scale.z)));
            EXPECT_EQ(t, glm::sign(glm::vec3(scale.x, 0, 0)));
            EXPECT_EQ(scene.tangents[corner].w * glm::cross(n, t),
                      glm::sign(glm::vec3(0, scale.y, 0)));
        }
    }
}

TEST_F(GltfGeometry, MissingNormalsAreLeftToTheTriangles) {
    GltfWriter gltf = square_gltf();
    nlohmann::json& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["TANGENT"] = gltf.accessor<float>(std::vector<float>(16, 1.0f), kFloat, "VEC4");
    attributes.erase("NORMAL");
    const SourceScene scene = read(gltf);
    for (const bake::Corner& corner : scene.corners) EXPECT_EQ(corner.normal, kAbsent);
    EXPECT_EQ(scene.smoothing_group.size(), 2u);
    EXPECT_EQ(scene.smoothing_group.runs().size(), 1u);
    EXPECT_EQ(scene.smoothing_group[0], 0u);
    EXPECT_TRUE(scene.tangents.empty());  // without normals they mean nothing
}

TEST_F(GltfGeometry, TangentsThatAreOfNoUseCountAsMissing) {
    GltfWriter gltf = square_gltf();
    gltf.root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
        gltf.accessor<float>({1, 0, 0, -1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 0, 1}, kFloat, "VEC4");
    // A second primitive without tangents after it, and one before it.
    nlohmann::json& primitives = gltf.root["meshes"][0]["primitives"];
    nlohmann::json plain = primitives[0];
    plain["attributes"].erase("TANGENT");
    primitives = {plain, primitives[0], plain};
    const SourceScene scene = read(gltf);
    ASSERT_EQ(scene.tangents.size(), 18u);
    const auto is_missing = [&](std::size_t corner) {
        return scene.tangents[corner] == glm::vec4(0.0f);
    };
    for (std::size_t corner = 0; corner < 6; ++corner) {
        EXPECT_TRUE(is_missing(corner));
        EXPECT_TRUE(is_missing(corner + 12));
    }
    EXPECT_EQ(scene.tangents[6], glm::vec4(1, 0, 0, -1));
    EXPECT_TRUE(is_missing(7));  // no direction
    EXPECT_TRUE(is_missing(8));  // along the normal
    EXPECT_EQ(scene.tangents[11], glm::vec4(0, 1, 0, 1));
}

TEST_F(GltfGeometry, OnlyVerticesInUseAreKept) {
    GltfWriter gltf = square_gltf();
    gltf.root["meshes"][0]["primitives"][0]["indices"] =
        gltf.accessor<std::uint16_t>({0, 1, 2}, kUshort, "SCALAR");
    EXPECT_EQ(read(gltf).positions.size(), 3u);
}

TEST_F(GltfGeometry, TheFirstCameraAndLightBecomeTheScenes) {
    GltfWriter gltf = square_gltf();
    gltf.root["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "area"}}, {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 64}}};
    gltf.root["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 2}, {"znear", 1}}}},
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.75}, {"znear", 0.1}}}}};
    const auto light = [](int index) {
        return nlohmann::json{{"KHR_lights_punctual", {{"light", index}}}};
    };
    const double h = std::sqrt(0.5);
    gltf.root["nodes"] = {{{"mesh", 0}, {"children", {1, 2, 3, 4}}, {"translation", {0, 0, 1}}},
                          {{"camera", 0}, {"extensions", light(0)}},
                          // A quarter turn about y: it looks along -x.
                          {{"camera", 1}, {"translation", {5, 0, 0}}, {"rotation", {0, h, 0, h}}},
                          {{"translation", {0, 4, 0}}, {"extensions", light(1)}},
                          {{"camera", 1}, {"extensions", light(1)}}};
    const SourceScene scene = read(gltf);
    ASSERT_TRUE(scene.camera && scene.light);
    EXPECT_EQ(scene.camera->position, glm::vec3(5, 0, 1));
    const glm::vec3 sight = glm::normalize(scene.camera->target - scene.camera->position);
    EXPECT_NEAR(glm::distance(sight, glm::vec3(-1, 0, 0)), 0, 1e-6);
    EXPECT_FLOAT_EQ(scene.camera->vertical_fov, 0.75f);
    EXPECT_EQ(scene.light->position, glm::vec3(0, 4, 1));
    // 64 at a distance of 4 from the box's centre.
    EXPECT_NEAR(glm::distance(scene.light->color, glm::vec3(4, 2, 0)), 0, 1e-5);
    EXPECT_EQ(warnings_,
              (std::vector<std::string>{
                  "scene.glb: /cameras/0: is not in perspective, and left out",
                  "scene.glb: /extensions/KHR_lights_punctual/lights/0: is left out, for "
                  "one light is used, the first (2 left out in all)"}));
}

}  // namespace
