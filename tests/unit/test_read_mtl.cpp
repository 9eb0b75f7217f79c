#include <cmath>

#include "common/io.h"
#include "cw2-bake/obj/read_mtl.h"
#include "mesh-format/file.h"
#include "obj_text.h"

namespace {

using mesh_format::MapUse;

using bake::BakeError;
using bake::Channel;
using bake::SourceMaterial;

class ReadMtl : public testing::Test {
 protected:
    std::vector<SourceMaterial> read_all(const std::string& text) {
        warnings_.clear();
        const std::string prefix = folder_.path().string() + "/";
        return bake::read_mtl(
            folder_.write("m.mtl", text), [](std::string_view) { return true; },
            [&](const std::string& warning) {
                EXPECT_TRUE(warning.starts_with(prefix)) << warning;
                warnings_.push_back(warning.substr(prefix.size()));
            });
    }
    /// One material with these statements.
    SourceMaterial material(const std::string& statements) {
        const auto materials = read_all("newmtl m\n" + statements);
        EXPECT_EQ(materials.size(), 1u);
        return materials.at(0);
    }
    std::string file(const bake::TextureMap& map) const {
        return map.file.lexically_relative(folder_.path()).generic_string();
    }
    std::string error(const std::string& statements) {
        try {
            material(statements);
        } catch (const BakeError& caught) {
            return std::string(caught.what()).substr(folder_.path().string().size() + 1);
        }
        return "";
    }

    TempFolder folder_;
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
         {"-s 2", "-s 2 2", "-s 2 2 2", "-o .5 -t 1 1 -s 2", "-mm 0.1 2", "-blendu off -blendv off",
          "-texres 512", "-boost 2", "-cc on", "-type sphere", "-bm 3", "-imfchan z",
          "-s 2 2 -clamp on -mm 0 .5", "-S 2"}) {
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

TEST_F(ReadMtl, NamesOptionsWithoutEffectInOneWarning) {
    material("map_Kd -s 2 2 a.png\nnorm -o 1 a.png\nmap_Pr -s 3 a.png\n");
    EXPECT_EQ(warnings_, std::vector<std::string>{
                             "m.mtl:2: texture options that have no effect here: -o, -s"});
    material("map_Kd -s 1 1.0 1 -o 0 0 0 -t 0 -blendu on -cc off -bm 1 a.png\n");
    EXPECT_TRUE(warnings_.empty());
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
    material("d 0.5\nmap_d a.png\n");
    EXPECT_TRUE(warnings_.empty());
    material("d 1\nTr 1\n");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ReadMtl, ReadsTheFirstOfANameAndOnlyWhatIsWanted) {
    const auto path = folder_.write(
        "m.mtl", "Kd x\nnewmtl a\nKd 1 0 0\nnewmtl b\nKd x\nd 0.5\nnewmtl a\nKd 0 1 0\n");
    const auto materials = bake::read_mtl(
        path, [](std::string_view name) { return name == "a"; },
        [](const std::string& warning) { ADD_FAILURE() << warning; });
    ASSERT_EQ(materials.size(), 1u);
    EXPECT_EQ(materials[0].base_color, glm::vec3(1, 0, 0));
}

TEST_F(ReadMtl, AcceptsAnyLineEndsAndCase) {
    for (const std::string end : {"\n", "\r", "\r\n"}) {
        const auto m =
            material("# c" + end + "\tkd 0.5 0.5 \\" + end + " 0.5" + end + "PR .5" + end);
        EXPECT_EQ(m.base_color, glm::vec3(0.5f));
        EXPECT_EQ(m.roughness, 0.5f);
    }
}

TEST_F(ReadMtl, RefusesMalformedNumbersAtTheirLine) {
    EXPECT_EQ(error("\nKd 1 x 0\n"), "m.mtl:3: 'x' is not a number");
    EXPECT_EQ(error("Kd 1 0\n"), "m.mtl:2: a number is missing");
    EXPECT_EQ(error("Pr nan\n"), "m.mtl:2: 'nan' is not a finite number");
    EXPECT_EQ(error("Pm\n"), "m.mtl:2: a number is missing");
    EXPECT_EQ(error("Ns 1e99\n"), "m.mtl:2: '1e99' is not a finite number");
    EXPECT_EQ(error("bump -bm q a.png\n"), "m.mtl:2: 'q' is not a number");
    EXPECT_THROW(bake::read_mtl(
                     folder_.path() / "no.mtl", [](std::string_view) { return true; },
                     [](const std::string&) {}),
                 common::FileError);
}

}  // namespace
