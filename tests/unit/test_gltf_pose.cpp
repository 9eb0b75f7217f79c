// The pose at load: skins, morph targets, and nodes in odd places.
#include <cmath>

#include "tests/unit/gltf_reading.h"

namespace {

using bake::SourceScene;
using nlohmann::json;

class GltfPose : public GltfReading {};

void expect_near(const glm::vec3& actual, const glm::vec3& expected) {
    EXPECT_NEAR(glm::distance(actual, expected), 0, 1e-5)
        << actual.x << ' ' << actual.y << ' ' << actual.z;
}

/// The square, its vertices bound to joints 0 and 1: node 1, moved by 5 along x, and node 2, moved
/// by 7 along y. Node 0 shows it, 100 away.
GltfWriter skinned_square(const std::vector<std::uint8_t>& joints,
                          const std::vector<float>& weights) {
    GltfWriter gltf = square_gltf();
    primitive(gltf)["attributes"]["JOINTS_0"] = gltf.accessor(joints, kUbyte, "VEC4");
    primitive(gltf)["attributes"]["WEIGHTS_0"] = gltf.accessor(weights, kFloat, "VEC4");
    gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                          {{"translation", {5, 0, 0}}},
                          {{"translation", {0, 7, 0}}}};
    gltf.root["skins"] = {{{"joints", {1, 2}}}};
    gltf.root["scenes"][0]["nodes"] = {0, 1, 2};
    return gltf;
}

const std::vector<std::uint8_t> kFirstJoint(16, 0);
const std::vector<float> kWholly{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

int matrices(GltfWriter& gltf, const std::vector<float>& values) {
    return gltf.add("accessors", {{"bufferView", gltf.view(values)},
                                  {"componentType", kFloat},
                                  {"count", values.size() / 16},
                                  {"type", "MAT4"}});
}

TEST_F(GltfPose, SkinsStandWhereTheirJointsDoWhateverTheirNode) {
    GltfWriter gltf = skinned_square(kFirstJoint, kWholly);
    const SourceScene scene = read(gltf);
    expect_near(position(scene, 0), {4, -1, 0});
    expect_near(position(scene, 2), {6, 1, 0});
    EXPECT_TRUE(warnings_.empty());

    // What the joint moves is the vertex as its inverse bind matrix has it: here by -2 along z.
    gltf.root["skins"][0]["inverseBindMatrices"] =
        matrices(gltf, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -2, 1,  //
                        1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1});
    expect_near(position(read(gltf), 0), {4, -1, -2});
    // A joint stands where its parents put it, in the scene or not.
    gltf.root["nodes"].push_back({{"children", {1}}, {"scale", {1, 1, 3}}});
    gltf.root["scenes"][0]["nodes"] = {0};
    expect_near(position(read(gltf), 0), {4, -1, -6});
}

TEST_F(GltfPose, WeightsBlendJointsAndNeedNotSumToOne) {
    const std::vector<std::uint8_t> joints{0, 1, 0, 0, 0, 1, 0, 0, 1, 9, 0, 0, 1, 0, 0, 0};
    // Half and half; a quarter of joint 1; joint 9 without weight; none at all.
    const std::vector<float> weights{0.5f, 0.5f, 0, 0, 0.75f, 0.25f, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0};
    GltfWriter gltf = skinned_square(joints, weights);
    SourceScene scene = read(gltf);
    expect_near(position(scene, 0), {-1 + 2.5, -1 + 3.5, 0});
    expect_near(position(scene, 1), {1 + 3.75, -1 + 1.75, 0});
    expect_near(position(scene, 2), {1, 1 + 7, 0});
    expect_near(position(scene, 5), {-1, 1 + 7, 0});
    EXPECT_TRUE(warnings_.empty());

    primitive(gltf)["attributes"]["WEIGHTS_0"] = gltf.accessor<std::uint8_t>(
        {51, 204, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, kUbyte, "VEC4", true);
    expect_near(position(read(gltf), 0), {-1 + 1, -1 + 5.6, 0});

    // A fifth joint and further.
    primitive(gltf)["attributes"]["WEIGHTS_0"] = gltf.accessor(kWholly, kFloat, "VEC4");
    primitive(gltf)["attributes"]["JOINTS_0"] = gltf.accessor(kFirstJoint, kUbyte, "VEC4");
    primitive(gltf)["attributes"]["WEIGHTS_1"] = gltf.accessor(kWholly, kFloat, "VEC4");
    primitive(gltf)["attributes"]["JOINTS_1"] =
        gltf.accessor(std::vector<std::uint16_t>(16, 1), kUshort, "VEC4");
    expect_near(position(read(gltf), 0), {-1 + 2.5, -1 + 3.5, 0});
}

TEST_F(GltfPose, NormalsAndTangentsFollowTheJoints) {
    GltfWriter gltf = skinned_square(kFirstJoint, kWholly);
    primitive(gltf)["attributes"]["TANGENT"] =
        gltf.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, kFloat, "VEC4");
    const double h = std::sqrt(0.5);
    gltf.root["nodes"][1]["rotation"] = {0, h, 0, h};  // +z to +x, +x to -z
    SourceScene scene = read(gltf);
    expect_near(normal(scene, 0), {1, 0, 0});
    expect_near(glm::vec3(scene.tangents[0]), {0, 0, -1});
    EXPECT_EQ(scene.tangents[0].w, 1);

    // A joint that mirrors turns the triangles, so that they face what their normals do.
    gltf.root["nodes"][1] = {{"scale", {-1, 1, 1}}};
    scene = read(gltf);
    for (std::size_t corner = 0; corner < 6; ++corner) {
        expect_near(normal(scene, corner), {0, 0, 1});
        expect_near(face_normal(scene, corner / 3), {0, 0, 1});
        EXPECT_EQ(scene.tangents[corner], glm::vec4(-1, 0, 0, -1));
    }
    // Uneven scales keep normals upright.
    gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}},
                          {{"rotation", {0, std::sin(M_PI / 8), 0, std::cos(M_PI / 8)}}},
                          {{"children", {1}}, {"scale", {0.25, 1, 1}}}};
    gltf.root["skins"] = {{{"joints", {1}}}};
    scene = read(gltf);
    for (std::size_t corner = 0; corner < 6; ++corner)
        expect_near(normal(scene, corner), face_normal(scene, corner / 3));
    EXPECT_GT(normal(scene, 0).x, 0.9f);
}

TEST_F(GltfPose, SkinsThatDoNotFitAreErrors) {
    GltfWriter gltf = skinned_square({0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0}, kWholly);
    const int joints = primitive(gltf)["attributes"]["JOINTS_0"];
    EXPECT_EQ(error(gltf),
              "scene.glb: /accessors/" + std::to_string(joints) + ": element 2 names joint 2 of 2");
    gltf = skinned_square(kFirstJoint, kWholly);
    gltf.root["skins"][0]["inverseBindMatrices"] = matrices(gltf, std::vector<float>(16, 0.0f));
    EXPECT_EQ(error(gltf),
              "scene.glb: /skins/0/inverseBindMatrices: gives 1 matrices for 2 joints");
    gltf.root["skins"][0]["joints"] = {1, 8};
    EXPECT_EQ(error(gltf), "scene.glb: /skins/0/joints/1: is 8, but there are 3 nodes");
    gltf.root["nodes"][0]["skin"] = 1;
    gltf.root["skins"][0]["joints"] = {1};
    EXPECT_EQ(error(gltf), "scene.glb: /nodes/0/skin: is 1, but there are 1 skins");
    // Without weights it is a mesh like any other.
    gltf.root["nodes"][0]["skin"] = 0;
    primitive(gltf)["attributes"].erase("WEIGHTS_0");
    const SourceScene scene = read(gltf);
    expect_near(glm::vec3(scene.origin) + position(scene, 0), {99, -1, 0});
}

TEST_F(GltfPose, MorphTargetsMoveWhatTheirWeightsSay) {
    GltfWriter gltf = square_gltf();
    const auto everywhere = [&](const glm::vec3& v) {
        return gltf.accessor<float>({v.x, v.y, v.z, v.x, v.y, v.z, v.x, v.y, v.z, v.x, v.y, v.z},
                                    kFloat, "VEC3");
    };
    primitive(gltf)["attributes"]["TANGENT"] =
        gltf.accessor<float>({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, kFloat, "VEC4");
    primitive(gltf)["targets"] = {{{"POSITION", everywhere({0, 0, 6})}},
                                  {{"POSITION", everywhere({1, 0, 0})},
                                   {"NORMAL", everywhere({1, 0, 0})},
                                   {"TANGENT", everywhere({0, 0, -1})}}};
    expect_near(position(read(gltf), 0), {-1, -1, 0});  // weights are 0 unless they are stated
    gltf.root["meshes"][0]["weights"] = {0.5, 0};
    SourceScene scene = read(gltf);
    expect_near(position(scene, 0), {-1, -1, 3});
    expect_near(normal(scene, 0), {0, 0, 1});
    gltf.root["nodes"][0]["weights"] = {0, 1};  // the node has the last word
    scene = read(gltf);
    expect_near(position(scene, 0), {0, -1, 0});
    const float h = std::sqrt(0.5f);
    expect_near(normal(scene, 0), {h, 0, h});
    expect_near(glm::vec3(scene.tangents[0]), {h, 0, -h});
    EXPECT_EQ(scene.tangents[0].w, -1);
    EXPECT_TRUE(warnings_.empty());

    // Only some vertices move: a sparse accessor over zeros. Then the joints take them.
    primitive(gltf)["targets"][0]["POSITION"] = gltf.add(
        "accessors",
        {{"componentType", kFloat},
         {"count", 4},
         {"type", "VEC3"},
         {"sparse",
          {{"count", 1},
           {"indices", {{"bufferView", gltf.view<std::uint8_t>({2})}, {"componentType", kUbyte}}},
           {"values", {{"bufferView", gltf.view<float>({0, 0, 4})}}}}}});
    gltf.root["nodes"][0]["weights"] = {1, 0};
    scene = read(gltf);
    expect_near(position(scene, 0), {-1, -1, 0});
    expect_near(position(scene, 2), {1, 1, 4});
    primitive(gltf)["attributes"]["JOINTS_0"] = gltf.accessor(kFirstJoint, kUbyte, "VEC4");
    primitive(gltf)["attributes"]["WEIGHTS_0"] = gltf.accessor(kWholly, kFloat, "VEC4");
    gltf.root["skins"] = {{{"joints", {1}}}};
    gltf.root["nodes"][0]["skin"] = 0;
    gltf.root["nodes"].push_back({{"scale", {1, 1, 10}}});
    expect_near(position(read(gltf), 2), {1, 1, 40});
}

TEST_F(GltfPose, MorphTargetsThatDoNotFitAreErrors) {
    GltfWriter gltf = square_gltf();
    const int three = gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, kFloat, "VEC3");
    primitive(gltf)["targets"] = {{{"POSITION", three}}};
    EXPECT_EQ(error(gltf), "");  // without a weight it is not looked at
    gltf.root["meshes"][0]["weights"] = {1, 2, 3};
    EXPECT_EQ(error(gltf), "scene.glb: /accessors/" + std::to_string(three) +
                               ": differs in count from the accessor of the positions");
    primitive(gltf)["targets"] = {{{"POSITION", 70}}};
    EXPECT_EQ(error(gltf),
              "scene.glb: /meshes/0/primitives/0/targets/0/POSITION: is 70, but there "
              "are 5 accessors");
    // What they add up to has a place in floats, too: 0 x infinity or infinity - infinity has none.
    const int color = gltf.accessor(std::vector<float>(16, 0.5f), kFloat, "VEC4");
    const int up = gltf.accessor(std::vector<float>(16, 1e30f), kFloat, "VEC4");
    const int down = gltf.accessor(std::vector<float>(16, -1e30f), kFloat, "VEC4");
    primitive(gltf)["attributes"]["COLOR_0"] = color;
    primitive(gltf)["targets"] = {{{"COLOR_0", up}}, {{"COLOR_0", down}}};
    gltf.root["meshes"][0]["weights"] = {1e30, 1e30};
    EXPECT_EQ(error(gltf), "scene.glb: /accessors/" + std::to_string(up) +
                               ": element 0 times its weight is beyond the range of floats");
    primitive(gltf)["attributes"].erase("COLOR_0");
    // Each would take no byte of the file, and as much time as the square has vertices.
    gltf.root["accessors"][0] = {{"componentType", kFloat}, {"count", 1 << 24}, {"type", "VEC3"}};
    primitive(gltf)["attributes"] = {{"POSITION", 0}};
    primitive(gltf)["targets"] = std::vector<json>(1000, json{{"POSITION", 0}});
    const std::string message = error(gltf);
    EXPECT_NE(message.find("/meshes/0: its morph targets are so many"), message.npos) << message;
}

TEST_F(GltfPose, ANodeThatASceneListsThoughItIsAChildIsShownOnceWhereItsParentsPutIt) {
    GltfWriter gltf = square_gltf();
    gltf.root["nodes"] = {{{"children", {1}}, {"translation", {0, 0, 7}}}, {{"mesh", 0}}};
    gltf.root["scenes"][0]["nodes"] = {1};
    const std::string said =
        "is a child of another node, or listed twice: shown once, where its parents put it";
    SourceScene scene = read(gltf);
    EXPECT_EQ(triangle_count(scene), 2u);
    expect_near(position(scene, 0), {-1, -1, 7});
    EXPECT_EQ(warnings_, std::vector<std::string>{"scene.glb: /scenes/0/nodes/0: " + said});

    for (const std::vector<int>& nodes : {std::vector{0, 1}, {1, 0}, {0, 0}, {1, 0, 1}}) {
        gltf.root["scenes"][0]["nodes"] = nodes;
        scene = read(gltf);
        EXPECT_EQ(triangle_count(scene), 2u);
        expect_near(position(scene, 0), {-1, -1, 7});
        EXPECT_EQ(warnings_.size(), 1u);
    }
    gltf.root["scenes"][0]["nodes"] = {0};
    EXPECT_EQ(triangle_count(read(gltf)), 2u);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfPose, AnimationsAreSaidToBeLeftOut) {
    GltfWriter gltf = square_gltf();
    gltf.root["animations"] = json::array({json::object()});
    read(gltf);
    EXPECT_EQ(warnings_,
              std::vector<std::string>{"scene.glb: /animations: animations are left out: the scene "
                                       "is in its pose at load"});
}

TEST_F(GltfPose, AccessorsWithoutAViewAreZeros) {
    GltfWriter gltf = square_gltf();
    // Every index is 0 but for those that the sparse part states.
    json& indices = gltf.root["accessors"][3];
    indices = {
        {"componentType", kUshort},
        {"count", 6},
        {"type", "SCALAR"},
        {"sparse",
         {{"count", 2},
          {"indices", {{"bufferView", gltf.view<std::uint8_t>({1, 2})}, {"componentType", kUbyte}}},
          {"values", {{"bufferView", gltf.view<std::uint16_t>({2, 3})}}}}}};
    const SourceScene scene = read(gltf);
    ASSERT_EQ(triangle_count(scene), 1u);
    expect_near(position(scene, 1), {1, 1, 0});
    indices.erase("sparse");
    EXPECT_EQ(error(gltf), "scene.glb: shows no triangles");
    // Beside others that show something it does no harm.
    json plain = primitive(gltf);
    plain.erase("indices");
    plain["mode"] = 5;
    gltf.root["meshes"][0]["primitives"].push_back(plain);
    gltf.root["accessors"][1].erase("bufferView");  // normals, then: none
    EXPECT_EQ(triangle_count(read(gltf)), 2u);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfPose, WhatIsNoNumberIsLeftOutUnlessItIsAPosition) {
    GltfWriter gltf = square_gltf();
    gltf.root["accessors"][1]["bufferView"] =
        gltf.view<float>({0, 0, 1, 0, NAN, 1, 0, 0, INFINITY, 0, 0, 1});
    const SourceScene scene = read(gltf);
    expect_near(normal(scene, 0), {0, 0, 1});
    EXPECT_EQ(scene.corners[1].normal, bake::kAbsent);
    EXPECT_EQ(scene.corners[2].normal, bake::kAbsent);
    EXPECT_EQ(scene.smoothing_group.size(), 2u);
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             "scene.glb: /accessors/1: 2 of its elements are not finite, and left "
                             "out"});
}

/// A light at the origin of a node that is turned by 90 degrees about x: it shines up, along +y.
class GltfLights : public GltfReading {
 protected:
    SourceScene lit_by(const json& lights) {
        GltfWriter gltf = square_gltf();
        gltf.root["extensionsUsed"] = {"KHR_lights_punctual"};
        gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = lights;
        const double h = std::sqrt(0.5);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const int node =
                gltf.add("nodes", {{"translation", {0, 0, 4}},
                                   {"rotation", {h, 0, 0, h}},
                                   {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
            gltf.root["scenes"][0]["nodes"].push_back(node);
        }
        return read(gltf);
    }
    const std::string place_ = "scene.glb: /extensions/KHR_lights_punctual/lights/";
};

TEST_F(GltfLights, ADirectionalLightIsFarAwayAndAsBrightEverywhere) {
    const SourceScene scene =
        lit_by({{{"type", "directional"}, {"color", {1, 0.5, 0}}, {"intensity", 3}}});
    ASSERT_TRUE(scene.light);
    EXPECT_EQ(scene.light->color, glm::vec3(3, 1.5f, 0));
    const glm::vec3 first = glm::normalize(scene.light->position - glm::vec3(-1, -1, 0));
    const glm::vec3 last = glm::normalize(scene.light->position - glm::vec3(1, 1, 0));
    EXPECT_NEAR(glm::distance(first, glm::vec3(0, -1, 0)), 0, 2e-3);
    EXPECT_NEAR(glm::distance(last, glm::vec3(0, -1, 0)), 0, 2e-3);
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             place_ + "0: is directional: becomes a point light 1000 half "
                                      "diagonals of the scene away"});
}

TEST_F(GltfLights, ASpotBecomesAPointAndTheFirstLightIsTaken) {
    const json spot{{"type", "spot"}, {"intensity", 32}}, point{{"type", "point"}};
    SourceScene scene = lit_by({spot, point, {{"type", "directional"}}});
    ASSERT_TRUE(scene.light);
    EXPECT_EQ(scene.light->position, glm::vec3(0, 0, 4));
    EXPECT_EQ(scene.light->color, glm::vec3(2));
    EXPECT_EQ(
        warnings_,
        (std::vector<std::string>{
            place_ + "0: is a spot light: becomes a point light that shines all around",
            place_ + "1: is left out, for one light is used, the first (2 left out in all)"}));
    lit_by(json::array({point}));
    EXPECT_TRUE(warnings_.empty());
    // What is no light is left out, too.
    scene = lit_by({{{"type", "area"}}, point});
    EXPECT_TRUE(scene.light);
    EXPECT_EQ(warnings_.size(), 1u);
    EXPECT_TRUE(warnings_.at(0).starts_with(place_ + "0: is left out"));
}

}  // namespace
