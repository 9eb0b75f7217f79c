#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/io.h"
#include "cw2-bake/obj/read_mtl.h"
#include "mesh-format/file.h"
#include "obj_text.h"

namespace {

using mesh_format::MapUse;

using bake::Channel;
using bake::MtlMaterial;
using bake::SourceMaterial;

class ReadMtl : public testing::Test {
 protected:
    std::vector<MtlMaterial> read_all(const std::string& text) {
        warnings_.clear();
        const std::string prefix = folder_.path().string() + "/";
        return bake::read_mtl(
            folder_.write("m.mtl", text), [](std::string_view) { return true; }, finder_,
            [&](const std::string& warning) {
                EXPECT_TRUE(warning.starts_with(prefix)) << warning;
                warnings_.push_back(warning.substr(prefix.size()));
            });
    }
    /// One material with these statements.
    MtlMaterial stated(const std::string& statements) {
        const auto materials = read_all("newmtl m\n" + statements);
        EXPECT_EQ(materials.size(), 1u);
        return materials.at(0);
    }
    SourceMaterial material(const std::string& statements) { return stated(statements).source; }
    std::string file(const bake::TextureMap& map) const {
        return map.file.lexically_relative(folder_.path()).generic_string();
    }
    TemporaryFolder folder_;
    bake::FileFinder finder_;
    std::vector<std::string> warnings_;
};

TEST_F(ReadMtl, BaseColourIsTheFactorTimesTheMap) {
    EXPECT_EQ(material("").base_color, glm::vec3(0.8f));
    EXPECT_EQ(material("Kd 0.1 0.2 0.3\n").base_color, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(material("Kd 0.5\n").base_color, glm::vec3(0.5f));
    EXPECT_EQ(material("Kd 0 0 0\n").base_color, glm::vec3(0));
    EXPECT_EQ(material("map_Kd a.png\n").base_color, glm::vec3(1));
    EXPECT_EQ(material("map_Kd a.png\nKd 0 0 0\n").base_color, glm::vec3(1));
    EXPECT_EQ(material("Kd 0.5 0 0.5\nmap_Kd a.png\n").base_color, glm::vec3(0.5f, 0, 0.5f));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, RoughnessInvertsTheExponent) {
    EXPECT_EQ(material("").roughness, 1);
    EXPECT_EQ(material("Pr 0.25\n").roughness, 0.25f);
    EXPECT_EQ(material("Pr 0.25\nNs 100\n").roughness, 0.25f);
    EXPECT_EQ(material("Ns 0\n").roughness, 1);
    EXPECT_EQ(material("Ns -5\n").roughness, 1);
    for (const double ns : {1.0, 30.0, 1000.0}) {
        const double alpha = material("Ns " + std::to_string(ns) + "\n").roughness;
        EXPECT_NEAR(2 / std::pow(alpha, 4) - 2, ns, 1e-5 * (ns + 2));
    }
    EXPECT_EQ(material("Ns 100\nmap_Pr r.png\n").roughness, 1);
    EXPECT_EQ(material("Pr 0.5\nmap_Pr r.png\n").roughness, 0.5f);
}

TEST_F(ReadMtl, MetalnessIsOneBesideAMapAndElseZero) {
    EXPECT_EQ(material("").metalness, 0);
    EXPECT_EQ(material("map_Pm m.png\n").metalness, 1);
    EXPECT_EQ(material("map_Pm m.png\nPm 0.5\n").metalness, 0.5f);
    EXPECT_EQ(material("Pm 0.75\n").metalness, 0.75f);
}

TEST_F(ReadMtl, ClampsFactorsAndSaysSo) {
    EXPECT_EQ(material("Pr 1.5\nPm -1\nKd 2 0.5 0\n").base_color, glm::vec3(1, 0.5f, 0));
    ASSERT_EQ(warnings_.size(), 3u);
    EXPECT_EQ(warnings_[0], "m.mtl:2: Pr 1.5 is outside 0 to 1; 1 is used");
    EXPECT_EQ(warnings_[1], "m.mtl:3: Pm -1 is outside 0 to 1; 0 is used");
    EXPECT_EQ(warnings_[2], "m.mtl:4: Kd 2 is outside 0 to 1; 1 is used");
}

TEST_F(ReadMtl, KeepsEachMapInItsPlace) {
    const auto m = material(
        "map_Kd kd.png\nmap_Pr pr.png\nmap_Pm pm.png\nnorm n.png\nmap_d d.png\nbump b.png\n");
    EXPECT_EQ(file(m.maps[MapUse::base_color].value()), "kd.png");
    EXPECT_EQ(file(m.maps[MapUse::roughness].value()), "pr.png");
    EXPECT_EQ(file(m.maps[MapUse::metalness].value()), "pm.png");
    EXPECT_EQ(file(m.maps[MapUse::normal].value()), "n.png");
    EXPECT_EQ(file(m.maps[MapUse::alpha_mask].value()), "d.png");
    EXPECT_EQ(file(m.bump_map.value().map), "b.png");
    EXPECT_EQ(m.bump_map->scale, 1);
    EXPECT_EQ(m.maps[MapUse::roughness]->stated_in, (folder_.path() / "m.mtl:3").string());
    EXPECT_FALSE(m.cull_back);
    EXPECT_FALSE(material("").maps[MapUse::normal] || material("").maps[MapUse::alpha_mask] ||
                 material("").bump_map);
}

TEST_F(ReadMtl, HonoursBumpScaleClampAndChannel) {
    for (const char* keyword : {"bump", "map_bump", "map_Bump"}) {
        const auto bump = material(std::string(keyword) + " -bm 2.5 -clamp on b.png\n").bump_map;
        EXPECT_EQ(bump.value().scale, 2.5f);
        EXPECT_TRUE(bump->map.clamp);
        EXPECT_EQ(file(bump->map), "b.png");
    }
    EXPECT_FALSE(material("map_Kd -clamp off a.png\n").maps[MapUse::base_color]->clamp);
    const std::vector<std::pair<std::string, Channel>> channels{
        {"r", Channel::r},     {"g", Channel::g},         {"b", Channel::b},
        {"m", Channel::alpha}, {"l", Channel::luminance},
    };
    for (const auto& [letter, channel] : channels) {
        EXPECT_EQ(
            material("map_Pr -imfchan " + letter + " a.png\n").maps[MapUse::roughness]->channel,
            channel);
    }
    EXPECT_EQ(material("map_Pr a.png\n").maps[MapUse::roughness]->channel, Channel::standard);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, FindsThePathBehindAnyOptions) {
    for (const char* options :
         {"-t 1", "-t 2 2", "-t 2 2 2", "-o .5 -t 1 1 -s 2", "-mm 0.1 2", "-blendu off",
          "-texres 512", "-boost 2", "-cc on", "-type sphere", "-bm q", "-imfchan z", "-s x",
          "-s 2 2 -clamp on -mm 0 .5", "-T 2"}) {
        const auto m = material(std::string("map_Kd ") + options + " three little pigs.png\n");
        EXPECT_EQ(file(m.maps[MapUse::base_color].value()), "three little pigs.png") << options;
        ASSERT_EQ(warnings_.size(), 1u) << options;
    }
    EXPECT_EQ(file(*material("map_Kd -s 2 2 brick.png\n").maps[MapUse::base_color]), "brick.png");
    EXPECT_EQ(file(*material("map_Kd -s 2 2 2 4 bricks.png\n").maps[MapUse::base_color]),
              "4 bricks.png");
    EXPECT_EQ(file(*material("map_Kd -o 1 2.png\n").maps[MapUse::base_color]), "2.png");
    EXPECT_EQ(file(*material("map_Kd -s 2 7\n").maps[MapUse::base_color]), "7");
    EXPECT_EQ(file(*material("map_Kd -unknown.png\n").maps[MapUse::base_color]), "-unknown.png");
}

TEST_F(ReadMtl, NamesEachOptionWithoutEffectOnce) {
    read_all(
        "newmtl a\nmap_Kd -t 2 2 a.png\nnorm -mm 1 2 a.png\nnewmtl b\nmap_Pr -t 3 -mm 1 1 a.png\n"
        "map_Kd -t 4 a.png\n");
    EXPECT_EQ(warnings_, (std::vector<std::string>{
                             "m.mtl:2: the texture option -t is not supported and left out (2 "
                             "materials)",
                             "m.mtl:3: the texture option -mm is not supported and left out (2 "
                             "materials)"}));
    material("map_Kd -s 1 1.0 1 -o 0 0 0 -t 0 -mm 0 1 -blendu on -cc off -bm 1 -boost 0 a.png\n");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, ScaleAndOffsetAreTheMaterials) {
    const auto transform = stated("map_Kd -o 0.5 .25 1 -s 4 2 a.png\n").transform;
    EXPECT_EQ(transform.scale, glm::vec2(4, 2));
    EXPECT_EQ(transform.offset, glm::vec2(0.5f, 0.25f));
    EXPECT_EQ(stated("norm -s 3 a.png\n").transform.scale, glm::vec2(3, 1));
    EXPECT_EQ(stated("map_Kd -s 2 2 a.png\nnorm -s 2 2 n.png\nmap_Ks -s 9 k.png\n").transform.scale,
              glm::vec2(2));
    EXPECT_EQ(warnings_.size(), 1u);  // of map_Ks
    const std::string differ =
        "textures of a material differ in -s or -o; all take those of its base colour, or of the "
        "first that it has (1 material)";
    EXPECT_EQ(stated("norm -s 3 3 a.png\nmap_Kd -s 2 2 a.png\n").transform.scale, glm::vec2(2));
    EXPECT_EQ(warnings_, std::vector<std::string>{"m.mtl:2: " + differ});
    EXPECT_EQ(stated("map_Kd a.png\nmap_d -s 2 2 a.png\n").transform.scale, glm::vec2(1));
    EXPECT_EQ(warnings_, std::vector<std::string>{"m.mtl:3: " + differ});
}

TEST_F(ReadMtl, EmissionIsTheFactorTimesTheMap) {
    EXPECT_EQ(material("").emission, glm::vec3(0));
    EXPECT_EQ(material("Ke 5 0.5 0\n").emission, glm::vec3(5, 0.5f, 0));
    EXPECT_EQ(material("Ke 2\n").emission, glm::vec3(2));
    EXPECT_FALSE(material("Ke 2\n").maps[MapUse::emission]);
    for (const char* keyword : {"map_Ke", "map_emissive"}) {
        const auto m = material(std::string(keyword) + " -clamp on e.png\nKe 0 0 0\n");
        EXPECT_EQ(m.emission, glm::vec3(1));
        EXPECT_EQ(file(m.maps[MapUse::emission].value()), "e.png");
        EXPECT_TRUE(m.maps[MapUse::emission]->clamp);
    }
    EXPECT_EQ(material("Ke 3 0 0\nmap_Ke e.png\n").emission, glm::vec3(3, 0, 0));
    EXPECT_TRUE(warnings_.empty());
    EXPECT_EQ(material("Ke -1 2 -3\n").emission, glm::vec3(0, 2, 0));
    EXPECT_EQ(warnings_,
              std::vector<std::string>{"m.mtl:2: Ke is negative; 0 is used (1 material)"});
    EXPECT_EQ(material("Ke nan 1 1\n").emission, glm::vec3(0));
    EXPECT_EQ(warnings_.size(), 1u);
}

TEST_F(ReadMtl, ReadsPackedMapsAndOtherNames) {
    EXPECT_EQ(file(material("map_Kn -bm 0.5 n.png\n").maps[MapUse::normal].value()), "n.png");
    EXPECT_EQ(material("map_Kn -bm 0.5 n.png\n").normal_scale, 0.5f);
    const auto rma = material("map_RMA a.png\n");
    EXPECT_EQ(warnings_, std::vector<std::string>{"m.mtl:2: the ambient occlusion of map_RMA or "
                                                  "map_ORM is left out (1 material)"});
    EXPECT_EQ(rma.maps[MapUse::roughness].value().channel, Channel::r);
    EXPECT_EQ(rma.maps[MapUse::metalness].value().channel, Channel::g);
    EXPECT_EQ(rma.roughness, 1);
    EXPECT_EQ(rma.metalness, 1);
    const auto orm = material("Ns 10\nPm 0.5\nmap_ORM a.png\n");
    EXPECT_EQ(orm.maps[MapUse::roughness].value().channel, Channel::g);
    EXPECT_EQ(orm.maps[MapUse::metalness].value().channel, Channel::b);
    EXPECT_EQ(orm.roughness, 1);
    EXPECT_EQ(orm.metalness, 0.5f);
    const auto own = material("map_Pr r.png\nmap_ORM a.png\n");
    EXPECT_EQ(file(own.maps[MapUse::roughness].value()), "r.png");
    EXPECT_EQ(own.maps[MapUse::roughness]->channel, Channel::standard);
    EXPECT_EQ(file(own.maps[MapUse::metalness].value()), "a.png");
}

TEST_F(ReadMtl, WarnsOnceOfEachStatementThatIsNotRead) {
    read_all(
        "newmtl a\nmap_Ks a.png\nrefl -type sphere a.png\nTf 0.5 1 1\nillum 4\nPc 1\nPcr 0.5\n"
        "newmtl b\nmap_Ks a.png\nillum 7\nmap_Ka a.png\nmap_aat off\nsharpness 100\nwhat ever\n"
        "newmtl c\nmap_Kd b.png\nmap_Ka a.png\nmap_Ks a.png\nmap_Ks b.png\ndecal d.png\n");
    const auto left_out = [](int line, const std::string& keyword, int count) {
        return fmt::format("m.mtl:{}: '{}' is not supported and left out ({} material{})", line,
                           keyword, count, count == 1 ? "" : "s");
    };
    std::vector<std::string> expected{
        left_out(2, "map_Ks", 3),
        left_out(3, "refl", 1),
        left_out(4, "Tf", 1),
        left_out(6, "Pc", 1),
        left_out(7, "Pcr", 1),
        left_out(11, "map_Ka", 2),
        left_out(12, "map_aat", 1),
        left_out(14, "what", 1),
        left_out(13, "sharpness", 1),
        left_out(20, "decal", 1),
        "m.mtl:5: illum 4 or 9, glass, is not supported and left out (1 material)",
        "m.mtl:10: illum 3 to 10, reflections and refraction, are not supported and left out, the "
        "first 7 (1 material)"};
    std::ranges::sort(expected);
    std::ranges::sort(warnings_);
    EXPECT_EQ(warnings_, expected);
}

// What Blender, Maya, 3ds Max, MeshLab and others write for a plain material.
TEST_F(ReadMtl, SaysNothingOfWhatEveryExporterWrites) {
    read_all(
        "newmtl a\nNs 250\nKa 1 1 1\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1\nillum 2\nTr 0\n"
        "Tf 1.0 1.00 1\nmap_Ks\nmap_Kd a b.png\nmap_Ka a b.png\nmap_aat on\n# note\n\nillum 0\n"
        "newmtl b\nPr 0.5\nPm 0\nPs 0.000000\nPc 0.0\nPcr 0.03\naniso 0\nanisor 0.5\nTf 0 0 0\n"
        "sharpness 60\nillum 1\nTf 1\nKe 0 # dark\n"
        "newmtl c\nillum 4\nKd 0 0 0\nKa 0 0 0\nTf 1.00 1.00 1.00\nd 1\nmap_Kd a.png\nNi 1.00\n");
    EXPECT_EQ(warnings_, std::vector<std::string>{});
}

TEST_F(ReadMtl, PathsMayHoldBlanksBackslashesAndQuotes) {
    EXPECT_EQ(file(*material("map_Kd a b/c d.png \t\r\n").maps[MapUse::base_color]), "a b/c d.png");
    EXPECT_EQ(file(*material("map_Kd tex\\sub\\a.png\n").maps[MapUse::base_color]),
              "tex/sub/a.png");
    EXPECT_EQ(file(*material("map_Kd \"a b.png\"\n").maps[MapUse::base_color]), "a b.png");
    EXPECT_EQ(file(*material("map_Kd a#1.png\n").maps[MapUse::base_color]), "a#1.png");
    EXPECT_EQ(material("map_Kd /abs/a.png\n").maps[MapUse::base_color]->file, "/abs/a.png");
    EXPECT_FALSE(material("map_Kd\n").maps[MapUse::base_color]);
    EXPECT_EQ(warnings_, std::vector<std::string>{"m.mtl:2: no image is named"});
}

TEST_F(ReadMtl, TransparencyWithoutAMapIsOneWarning) {
    read_all("newmtl a\nd 0.5\nnewmtl b\nTr 0.25\nnewmtl c\nd -halo 0.5\n");
    EXPECT_EQ(warnings_,
              std::vector<std::string>{
                  "m.mtl:2: material 'a' and 2 more should be see-through but will be opaque"});
    EXPECT_TRUE(material("d 0.25\n").blend);
    EXPECT_EQ(material("d 0.25\n").opacity, 0.25f);
    EXPECT_EQ(material("Tr 0.25\n").opacity, 0.75f);
    EXPECT_EQ(material("d -5\n").opacity, 0);
    EXPECT_FALSE(material("d 0.5\nmap_d a.png\n").blend);
    EXPECT_TRUE(warnings_.empty());
    material("d 1\nTr 1\n");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, ReadsTheFirstOfANameAndOnlyWhatIsWanted) {
    const auto path = folder_.write(
        "m.mtl", "Kd x\nfoo\nnewmtl a\nKd 1 0 0\nnewmtl b\nKd x\nd 0.5\nnewmtl a\nKd 0 1 0\n");
    const auto materials = bake::read_mtl(
        path, [](std::string_view name) { return name == "a"; }, finder_,
        [](const std::string& warning) { ADD_FAILURE() << warning; });
    ASSERT_EQ(materials.size(), 1u);
    EXPECT_EQ(materials[0].source.base_color, glm::vec3(1, 0, 0));
}

TEST_F(ReadMtl, AcceptsAnyLineEndsAndCase) {
    for (const std::string end : {"\n", "\r", "\r\n"}) {
        const auto m =
            material("# c" + end + "\tkd 0.5 0.5 \\" + end + " 0.5" + end + "PR .5" + end);
        EXPECT_EQ(m.base_color, glm::vec3(0.5f));
        EXPECT_EQ(m.roughness, 0.5f);
    }
}

TEST_F(ReadMtl, WhatIsNoNumberLeavesTheDefault) {
    const auto m = material("Kd 1 x 0\nPr nan\nPm\nNs 1e99\nd 1.#QNAN\nbump -bm q a.png\n");
    EXPECT_EQ(m.base_color, glm::vec3(0.8f));
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.metalness, 0);
    EXPECT_EQ(m.bump_map.value().scale, 1);
    EXPECT_EQ(
        warnings_,
        (std::vector<std::string>{
            "m.mtl:2: Kd holds no finite number and is left out, the first 'x' (1 material)",
            "m.mtl:3: Pr holds no finite number and is left out, the first 'nan' (1 material)",
            "m.mtl:4: Pm lacks a number and is left out (1 material)",
            "m.mtl:5: Ns holds no finite number and is left out, the first '1e99' (1 material)",
            "m.mtl:6: d holds no finite number and is left out, the first '1.#QNAN' (1 "
            "material)",
            "m.mtl:7: the texture option -bm is not supported and left out (1 material)"}));
    EXPECT_EQ(material("Kd 1 0\n").base_color, glm::vec3(0.8f));
    EXPECT_EQ(material("Kd 1 0 # 0\n").base_color, glm::vec3(0.8f));
    EXPECT_EQ(material("map_Kd a.png\nKd nan nan nan\n").base_color, glm::vec3(1));
    read_all("newmtl a\nKd nan\nnewmtl b\nPr 1\nnewmtl c\nKd -inf 0 0\n");
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             "m.mtl:2: Kd holds no finite number and is left out, the first 'nan' "
                             "(2 materials)"});
    EXPECT_EQ(material("Kd 0.5 0.5 0.5\n\x1A" + std::string(4, '\0')).base_color, glm::vec3(0.5f));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, ANumberTooSmallForAFloatIsZero) {
    EXPECT_EQ(material("Kd 1e-50 0.5 -1e-999\n").base_color, glm::vec3(0, 0.5f, 0));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, NeedsTheFile) {
    EXPECT_THROW(bake::read_mtl(
                     folder_.path() / "no.mtl", [](std::string_view) { return true; }, finder_,
                     [](const std::string&) {}),
                 common::FileError);
}

}  // namespace
