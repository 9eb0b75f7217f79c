// Bakes as glTF, and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/io.h"
#include "mesh-format/file.h"
#include "mesh-format/tangent_frame.h"
#include "tests/cli/scene_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace mesh_format;

/// A corner of a triangle of a file in the forms f32.
struct Corner {
    std::array<float, 5> place;  ///< position and UV
    TangentFrame frame;
};
using Triangle = std::array<Corner, 3>;

std::vector<Triangle> triangles_of(const Document& document) {
    std::vector<Triangle> triangles;
    for (const MeshRecord& mesh : document.meshes) {
        EXPECT_TRUE(mesh.forms.position == PositionForm::f32 && mesh.forms.uv == UvForm::f32);
        const VertexLayout layout = vertex_layout(mesh.forms);
        const auto corner = [&](std::uint32_t i) {
            const std::byte* vertex = document.vertices.data() + mesh.vertex_offset +
                                      document.indices[mesh.first_index + i] * layout.stride;
            Corner result;
            std::memcpy(result.place.data(), vertex, 12);
            std::memcpy(result.place.data() + 3, vertex + layout.uv_offset, 8);
            result.frame = unpack_frame(mesh.forms.frame, vertex + layout.frame_offset);
            return result;
        };
        for (std::uint32_t i = 0; i < mesh.index_count; i += 3) {
            Triangle triangle{corner(i), corner(i + 1), corner(i + 2)};
            std::ranges::rotate(triangle, std::ranges::min_element(triangle, {}, &Corner::place));
            triangles.push_back(triangle);
        }
    }
    std::ranges::sort(triangles, {}, [](const Triangle& t) {
        return std::array{t[0].place, t[1].place, t[2].place};
    });
    return triangles;
}

class Export : public SceneFolder {
 protected:
    /// The baked file, which stays mapped until the next call.
    Document open(const std::string& name) {
        const common::MappedFile& file = files_.emplace_back(here(name));
        return parse(file.bytes(), name);
    }
    std::vector<std::string> texts(const Document& document, const auto& records) {
        std::vector<std::string> result;
        for (const auto& record : records) result.emplace_back(document.text(record.name));
        return result;
    }

 private:
    std::vector<common::MappedFile> files_;
};

const std::vector<std::string> kExact{"--positions", "f32",      "--tangent-frame", "f32",
                                      "--textures",  "lossless", "--quiet"};

std::vector<std::string> exactly(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), kExact.begin(), kExact.end());
    return arguments;
}

TEST_F(Export, NamesThatAreNoUtf8AreValidInJson) {
    write("gr\xFCn.obj",
          "mtllib gr\xFCn.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
          "usemtl gr\xFCn\nf 1/1 2/2 3/3\n");
    std::filesystem::copy(here("mask.png"), here("gr\xFCn.png"));
    write("gr\xFCn.mtl", "newmtl gr\xFCn\nmap_Kd gr\xFCn.png\n");
    bake_well({"gr\xFCn.obj", "-o", "gr\xFCn.cw2mesh", "--quiet", "--stats", "stats.json"});
    const auto names_of = [](const nlohmann::json& json, const char* textures) {
        return std::vector<std::string>{json.at("materials").at(0).at("name"),
                                        json.at(textures).at(0).at("name")};
    };
    const std::vector<std::string> names{"gr\uFFFDn", "gr\uFFFDn.png"};
    EXPECT_TRUE(nlohmann::json::accept(read("stats.json")));
    const Outcome inspection = bake({"--inspect", "--json", "gr\xFCn.cw2mesh"});
    EXPECT_EQ(names_of(nlohmann::json::parse(inspection.out), "textures"), names);
    bake_well({"gr\xFCn.cw2mesh", "-o", "gr\xFCn.gltf", "--quiet"});
    EXPECT_EQ(names_of(nlohmann::json::parse(read("gr\xFCn.gltf")), "images"), names);
}

TEST_F(Export, ComesBackAsItWas) {
    bake_well(exactly({"scene.obj", "-o", "first.cw2mesh"}));
    bake_well({"first.cw2mesh", "-o", "scene.glb", "--quiet"});
    bake_well(exactly({"scene.glb", "-o", "second.cw2mesh"}));
    const Document first = open("first.cw2mesh");
    const Document second = open("second.cw2mesh");

    const std::vector<Triangle> before = triangles_of(first);
    const std::vector<Triangle> after = triangles_of(second);
    ASSERT_EQ(before.size(), 6u);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(before[i][k].place, after[i][k].place);
            EXPECT_LT(frame_angle(before[i][k].frame, after[i][k].frame), 1e-4);
        }
    }
    std::uint64_t vertices[2] = {};
    for (const MeshRecord& mesh : first.meshes) vertices[0] += mesh.vertex_count;
    for (const MeshRecord& mesh : second.meshes) vertices[1] += mesh.vertex_count;
    EXPECT_EQ(vertices[0], vertices[1]);

    EXPECT_EQ(texts(first, first.materials), texts(second, second.materials));
    ASSERT_EQ(first.materials.size(), second.materials.size());
    const auto texels = [](const Document& document, std::uint32_t texture) {
        const auto bytes = texture == kNoTexture ? std::span<const std::byte>()
                                                 : document.payload(document.textures[texture]);
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    };
    for (std::size_t i = 0; i < first.materials.size(); ++i) {
        const MaterialRecord& a = first.materials[i];
        const MaterialRecord& b = second.materials[i];
        EXPECT_TRUE(std::ranges::equal(a.base_color, b.base_color));
        EXPECT_EQ(a.roughness, b.roughness);
        EXPECT_EQ(a.metalness, b.metalness);
        EXPECT_EQ(a.alpha_cutoff, b.alpha_cutoff);
        EXPECT_EQ(a.normal_scale, b.normal_scale);
        EXPECT_EQ(a.flags, b.flags);
        EXPECT_EQ(texels(first, a.textures[MapUse::base_color]),
                  texels(second, b.textures[MapUse::base_color]));
        EXPECT_EQ(texels(first, a.textures[MapUse::roughness]),
                  texels(second, b.textures[MapUse::roughness]));
        EXPECT_EQ(texels(first, a.textures[MapUse::normal]),
                  texels(second, b.textures[MapUse::normal]));
        EXPECT_EQ(texels(first, a.textures[MapUse::alpha_mask]),
                  texels(second, b.textures[MapUse::alpha_mask]));
    }
}

TEST_F(Export, AnySourceAndBothFormsOfGltfHoldTheSame) {
    bake_well(exactly({"scene.obj", "-o", "baked.cw2mesh"}));
    bake_well({"baked.cw2mesh", "-o", "scene.glb", "--quiet"});
    const std::string of_baked = read("scene.glb");
    bake_well({"scene.obj", "-o", "scene.glb", "--quiet"});
    EXPECT_TRUE(read("scene.glb") == of_baked);
    bake_well(exactly({"scene.obj", "-o", "small.cw2mesh", "--compress"}));
    bake_well({"small.cw2mesh", "-o", "scene.glb", "--quiet"});
    EXPECT_EQ(read("scene.glb").size(), of_baked.size());

    bake_well({"scene.obj", "-o", "scene.gltf", "--quiet"});
    bake_well(exactly({"scene.gltf", "-o", "of_text.cw2mesh"}));
    bake_well(exactly({"scene.glb", "-o", "of_binary.cw2mesh"}));
    EXPECT_TRUE(read("of_text.cw2mesh") == read("of_binary.cw2mesh"));
}

TEST_F(Export, KeepsTheCameraAndTheLight) {
    bake_well({"scene.obj", "-o", "scene.gltf", "--quiet", "--textures", "none"});
    nlohmann::json gltf = nlohmann::json::parse(read("scene.gltf"));
    gltf["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    gltf["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 40}}};
    gltf["nodes"].push_back({{"camera", 0}, {"translation", {1, 2, 8}}});
    gltf["nodes"].push_back(
        {{"translation", {3, 4, 5}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    gltf["scenes"][0]["nodes"] = {0, 1, 2};
    write("seen.gltf", gltf.dump());
    bake_well(exactly({"seen.gltf", "-o", "first.cw2mesh"}));
    bake_well({"first.cw2mesh", "-o", "again.glb", "--quiet"});
    bake_well(exactly({"again.glb", "-o", "second.cw2mesh"}));
    const SceneRecord a = open("first.cw2mesh").scene;
    const SceneRecord b = open("second.cw2mesh").scene;
    EXPECT_EQ(a.flags, std::uint32_t{kHasCamera | kHasLight});
    EXPECT_EQ(a.flags, b.flags);
    EXPECT_EQ(a.camera_fov, 0.5f);
    EXPECT_EQ(a.camera_fov, b.camera_fov);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(a.camera_position[axis], b.camera_position[axis]);
        EXPECT_NEAR(a.camera_target[axis], b.camera_target[axis], 1e-5);
        EXPECT_EQ(a.light_position[axis], b.light_position[axis]);
        EXPECT_NEAR(a.light_color[axis], b.light_color[axis], 1e-5);
    }
}

/// Far from the origin, with vertex colours, a lamp and a pane of glass; then one that is unlit.
TEST_F(Export, ColoursEmissionUnlitBlendingAndTheOriginComeBack) {
    write("lamp.mtl",
          "newmtl lamp\nKd 0.5 0.5 0.5\nKe 3 2 1\nmap_Ke mask.png\n"
          "newmtl glass\nKd 1 0 0\nd 0.25\n");
    write("lamp.obj",
          "mtllib lamp.mtl\nv 500000 4000000 0 1 0 0\nv 500001 4000000 0 0.2 0.4 0.6\n"
          "v 500000 4000001 0 0 0.5 1\nv 500001 4000001 0 0.1 1 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
          "usemtl lamp\nf 1/1 2/2 3/3\nusemtl glass\nf 2/2 4/1 3/3\n");
    bake_well(exactly({"lamp.obj", "-o", "first.cw2mesh"}));
    bake_well({"first.cw2mesh", "-o", "lamp.gltf", "--quiet"});
    nlohmann::json gltf = nlohmann::json::parse(read("lamp.gltf"));
    EXPECT_EQ(gltf["materials"][1]["alphaMode"], "BLEND");
    EXPECT_EQ(gltf["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"][3], 0.25);
    bake_well(exactly({"lamp.gltf", "-o", "second.cw2mesh"}));
    const Document first = open("first.cw2mesh");
    const Document second = open("second.cw2mesh");
    EXPECT_GT(first.scene.origin[0], 4e5);
    EXPECT_TRUE(std::ranges::equal(first.scene.origin, second.scene.origin));
    ASSERT_EQ(first.meshes.size(), 2u);
    EXPECT_TRUE(std::ranges::equal(first.vertices, second.vertices));  // with their colours
    ASSERT_EQ(second.materials.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(second.meshes[i].forms.color, ColorForm::rgba8);
        const MaterialRecord& a = first.materials[i];
        const MaterialRecord& b = second.materials[i];
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_FLOAT_EQ(a.emission[channel], b.emission[channel]);
        EXPECT_EQ(a.opacity, b.opacity);
        EXPECT_EQ(a.flags, b.flags);
        EXPECT_EQ(a.textures[MapUse::emission], b.textures[MapUse::emission]);
    }
    EXPECT_EQ(second.materials[0].emission[0], 3);
    EXPECT_NE(second.materials[0].textures[MapUse::emission], kNoTexture);
    EXPECT_TRUE(second.materials[1].flags & kBlend);

    gltf["materials"][0]["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
    write("unlit.gltf", gltf.dump());
    bake_well({"unlit.gltf", "-o", "unlit.glb", "--quiet"});
    bake_well({"unlit.glb", "-o", "unlit.cw2mesh", "--quiet"});
    EXPECT_TRUE(open("unlit.cw2mesh").materials[0].flags & kUnlit);
}

TEST_F(Export, AnImageOfTwoTexturesIsNotOutOfProportion) {
    const auto line = [](int width, int height) {
        return painted(width, height, 3,
                       [](int x, int y) { return std::vector(3, (x + y) % 2 == 0 ? 1.0 : 0.2); });
    };
    write_picture(here("wide.png"), line(64, 1));
    write_picture(here("tall.png"), line(1, 64));
    write("lines.mtl", "newmtl leaf\nmap_Kd wide.png\nmap_d tall.png\n");
    write("lines.obj",
          "mtllib lines.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
          "usemtl leaf\nf 1/1 2/2 3/3\n");
    const std::string warning =
        "cw2-bake: warning: a.gltf: image 'wide.png': loses texels of the smaller of its two "
        "textures\n";
    EXPECT_EQ(bake({"lines.obj", "-o", "a.gltf"}).err, warning);
    bake_well({"lines.obj", "-o", "lines.cw2mesh", "--quiet"});
    EXPECT_EQ(bake({"lines.cw2mesh", "-o", "a.gltf"}).err, warning);
    EXPECT_EQ(bake({"lines.cw2mesh", "-o", "b.gltf", "--strict"}).status, 1);
    EXPECT_FALSE(std::filesystem::exists(here("b.gltf")));
    // As large as the larger one of the two, not 64 x 64.
    bake_well({"a.gltf", "-o", "again.cw2mesh", "--quiet"});
    const Document again = open("again.cw2mesh");
    ASSERT_FALSE(again.textures.empty());
    for (const auto& texture : again.textures) EXPECT_EQ(texture.width * texture.height, 64u);
}

TEST_F(Export, RefusalsNameTheFileAndLeaveNoOther) {
    bake_well({"scene.obj", "-o", "small.cw2mesh", "--compress", "--quiet"});
    write("cut.cw2mesh", read("small.cw2mesh").substr(0, 500));
    write("out.glb", "what was there");
    for (const char* input : {"cut.cw2mesh", "missing.cw2mesh"}) {
        const Outcome outcome = bake({input, "-o", "out.glb"});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_TRUE(outcome.err.starts_with(std::string("cw2-bake: ") + input + ": "))
            << outcome.err;
    }
    EXPECT_EQ(read("out.glb"), "what was there");
    EXPECT_EQ(bake({"scene.obj", "-o", "out.glb", "--compress"}).status, 2);
}

}  // namespace
