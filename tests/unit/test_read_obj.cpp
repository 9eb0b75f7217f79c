#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "cw2-bake/obj/read_obj.h"
#include "obj_text.h"

namespace {

using bake::BakeError;
using bake::kAbsent;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) {
        text.replace(at, from.size(), to);
    }
    return text;
}

struct Twin {
    const char* what;
    std::string odd;
    std::string plain;
};

class OddSyntax : public testing::TestWithParam<Twin> {};

TEST_P(OddSyntax, ReadsLikeItsPlainTwin) {
    for (const std::size_t chunk : {1, 20, 1 << 18}) {
        const TemporaryFolder folder;
        EXPECT_EQ(corner_values(read(folder, GetParam().odd, chunk).scene),
                  corner_values(read(GetParam().plain).scene));
    }
}

const std::string kPlain =
    kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\ns 2\nusemtl a b\nf 1/1/1 2/2/1 3/3/1\nf 1 3 4\n";

INSTANTIATE_TEST_SUITE_P(
    ReadObj, OddSyntax,
    testing::Values(
        Twin{"crlf", replaced(kPlain, "\n", "\r\n"), kPlain},
        Twin{"cr", replaced(kPlain, "\n", "\r"), kPlain},
        Twin{"mixed_line_ends", replaced(replaced(kPlain, "\nvt", "\r\nvt"), "\nf", "\rf"), kPlain},
        Twin{"no_last_line_end", kPlain.substr(0, kPlain.size() - 1), kPlain},
        Twin{"bom", "\xEF\xBB\xBF" + kPlain, kPlain},
        Twin{"tabs", replaced(kPlain, " ", "\t"), replaced(kPlain, "a b", "a\tb")},
        Twin{"leading_blanks", "  " + replaced(kPlain, "\n", "\n \t "), kPlain},
        Twin{"trailing_blanks", replaced(kPlain, "\n", " \t\n"), kPlain},
        Twin{"blank_lines", replaced(kPlain, "\n", "\n\n \n"), kPlain},
        Twin{"comments", replaced(kPlain, "\nf", "\n# f 9 9 9 \\\nf"), kPlain},
        Twin{"comment_behind_face", replaced(kPlain, "3 4\n", "3 4 # a face\n"), kPlain},
        Twin{"comment_behind_vertex", replaced(kPlain, "v 1 1 0\n", "v 1 1 0#\n"), kPlain},
        Twin{"comment_that_ends_in_a_backslash", replaced(kPlain, "v 1 1 0\n", "v 1 1 0 # c:\\\n"),
             kPlain},
        Twin{"continued_polygon", kSquare + "f 1 2 3 \\\n4\nf 1 2 3 4\\\n",
             kSquare + "f 1 2 3 4\nf 1 2 3 4\n"},
        Twin{"continuations", replaced(kPlain, " 3", " \\\n3"), kPlain},
        Twin{"continuation_without_blank", replaced(kPlain, "f 1 3", "f 1\\\n3"), kPlain},
        Twin{"continuations_crlf", replaced(kPlain, " 1", " \\\r\n 1"), kPlain},
        Twin{"continuations_cr", replaced(kPlain, " 1", " \\\r 1"), kPlain},
        Twin{"continued_keyword", replaced(kPlain, "v 1 1 0", "v\\\n 1 1 0"), kPlain},
        Twin{"continued_name", replaced(kPlain, "usemtl a", "usemtl \\\na"), kPlain},
        Twin{"continuation_at_the_end", kPlain.substr(0, kPlain.size() - 1) + "\\", kPlain},
        Twin{"continued_extra_words", replaced(kPlain, "v 1 1 0", "v 1 1 0 .5 \\\n .5 .5"), kPlain},
        Twin{"negative_indices", replaced(kPlain, "f 1 3 4", "f -4 -2 -1"), kPlain},
        Twin{"mixed_indices", replaced(kPlain, "1/1/1 2/2/1", "1/-3/1 -3/2/-1"), kPlain},
        Twin{"negative_index_of_then",
             replaced(kPlain, "f 1 3 4\n", "f 1 3 -1\nv 7 7 7\nvt 7 7\nvn 1 0 0\n"), kPlain},
        Twin{"faces_before_vertices", "s 2\nusemtl a b\nf 1 2 3 4\n" + kSquare,
             kSquare + "s 2\nusemtl a b\nf 1 2 3 4\n"},
        Twin{"empty_uv_and_normal", replaced(kPlain, "f 1 3 4", "f 1/ 3// 4/"), kPlain},
        Twin{"mixed_within_a_face", kSquare + "vt 0 1\nf 1/1 2 3/1\n",
             kSquare + "vt 0 1\nvt 0 1\nf 1/1 2 3/2\n"},
        Twin{"vertex_colours", replaced(kPlain, "v 1 1 0", "v 1 1 0 0.5 0.25 nan"), kPlain},
        Twin{"vertex_colours_and_alpha", replaced(kPlain, "v 1 1 0", "v 1 1 0 0.5 1 .25 1"),
             kPlain},
        Twin{"w", replaced(kPlain, "v 1 1 0", "v 1 1 0 2.0"), kPlain},
        Twin{"uv_of_three", replaced(kPlain, "vt 1 1", "vt 1 1 0.5"), kPlain},
        Twin{"uv_of_one", replaced(kPlain, "vt 1 0", "vt 1"), kPlain},
        Twin{"number_forms", replaced(kPlain, "v 1 1 0", "v +1. 10e-1 -.0e+3"), kPlain},
        Twin{"too_small_a_number", replaced(kPlain, "v 1 1 0", "v 1 1 1e-999"), kPlain},
        Twin{"normal_of_any_length", replaced(kPlain, "vn 0 0 1", "vn 0 -0 1e-30"), kPlain},
        Twin{"points_and_lines", replaced(kPlain, "\nf", "\np 1\nl 1 2 \\\n 3\nf"), kPlain},
        Twin{"unknown_statements", replaced(kPlain, "\nf", "\nlod 3\nfoo bar\nvp 1 2\nf"), kPlain},
        Twin{"groups", replaced(kPlain, "\nf", "\ng a b\no c d\nmg 1\nf"), kPlain},
        Twin{"smoothing_off", replaced(kPlain, "s 2", "s off"), replaced(kPlain, "s 2\n", "")},
        Twin{"smoothing_0", replaced(kPlain, "s 2", "s 0"), replaced(kPlain, "s 2\n", "")},
        Twin{"smoothing_on", replaced(kPlain, "s 2", "s on"), replaced(kPlain, "s 2", "s 1")},
        Twin{"smoothing_mask", replaced(kPlain, "s 2", "s 4294967295"),
             replaced(kPlain, "s 2", "s \t4294967295 ")},
        Twin{"smoothing_without_a_group", replaced(kPlain, "s 2", "s"),
             replaced(kPlain, "s 2", "s 1")},
        Twin{"smoothing_with_a_comment", replaced(kPlain, "s 2", "s 2 # two"), kPlain},
        Twin{"smoothing_of_nonsense", replaced(kPlain, "s 2", "s 2\ns x\ns -1"), kPlain},
        Twin{"nul_at_the_end", kPlain + std::string(3, '\0'), kPlain},
        Twin{"nul_before_the_last_line_end",
             kPlain.substr(0, kPlain.size() - 1) + std::string(1, '\0') + "\n", kPlain},
        Twin{"control_z_at_the_end", kPlain + "\x1A\r\n" + std::string(600, '\0'), kPlain},
        Twin{"face_outline", replaced(kPlain, "f 1 3", "fo 1 3"), kPlain},
        Twin{"long_line", replaced(kPlain, "f 1 3", "f 1" + std::string(300'000, ' ') + "3"),
             kPlain}),
    [](const auto& test) { return std::string(test.param.what); });

TEST(ReadObj, KeepsValuesNormalisesNormalsAndHasNoMinusZero) {
    const auto scene = read(kSquare +
                            "v -0 -0.0 1\nvn 0 3 -4\nvn -0 -1e-50 2\nvt -0 0.3\n"
                            "f 5/1/1 2/1/1 3/1/2\n")
                           .scene;
    EXPECT_EQ(scene.positions[4], glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.normals[0], glm::vec3(0, 0.6f, -0.8f));
    EXPECT_EQ(scene.uvs[0], glm::vec2(0, 0.3f));
    for (const float zero : {scene.positions[4].x, scene.positions[4].y, scene.normals[1].x,
                             scene.normals[1].y, scene.uvs[0].x}) {
        EXPECT_FALSE(std::signbit(zero));
    }
    EXPECT_TRUE(scene.smoothing_group.empty());
}

TEST(ReadObj, CountsAZeroNormalAsMissing) {
    const auto scene = read(kSquare + "vn 0 0 0\nvn 0 0 1\ns 3\nf 1//1 2//2 3//1\n").scene;
    EXPECT_EQ(scene.corners[0].normal, kAbsent);
    EXPECT_EQ(scene.corners[1].normal, 1u);
    EXPECT_EQ(numbers(scene.smoothing_group), std::vector<std::uint32_t>{3});
}

// The letter U, of area 7, whose fan about its first corner would cross its opening.
TEST(ReadObj, CutsConcavePolygonsAndKeepsTheirCornersTogether) {
    const std::string outline[] = {"0 3", "0 0", "3 0", "3 3", "2 3", "2 1", "1 1", "1 3"};
    std::string vertices, face = "f";
    for (int i = 1; i <= 8; ++i) {
        vertices += "v " + outline[i - 1] + " 0\nvt " + outline[i - 1] + "\n";
        face += " " + std::to_string(i) + "/" + std::to_string(i);
    }
    for (const std::string& text :
         {vertices + face + "\n", face + "\nusemtl b\n" + face + "\n" + vertices}) {
        const auto scene = read(text).scene;
        double area = 0;
        for (std::size_t t = 0; t < scene.corners.size(); t += 3) {
            glm::vec3 p[3];
            for (int i = 0; i < 3; ++i) {
                const bake::Corner& corner = scene.corners[t + i];
                p[i] = scene.positions[corner.position];
                EXPECT_EQ(scene.uvs[corner.uv], glm::vec2(p[i]));
            }
            const glm::vec3 u = p[1] - p[0], v = p[2] - p[0];
            EXPECT_GT(u.x * v.y - u.y * v.x, 0);
            area += (u.x * v.y - u.y * v.x) / 2;
        }
        EXPECT_EQ(area, 7.0 * static_cast<double>(scene.materials.size()));
        EXPECT_EQ(scene.corners.size(), 18 * scene.materials.size());
    }
}

TEST(ReadObj, OrdersMaterialsByFirstUseAndDropsUnused) {
    const auto scene = read(kSquare +
                            "usemtl x\nusemtl c\nf 1 2 3\nusemtl a\nf 1 2 3\n"
                            "usemtl c\nf 1 2 3\n")
                           .scene;
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[0].name, "c");
    EXPECT_EQ(scene.materials[1].name, "a");
    EXPECT_EQ(numbers(scene.triangle_material), (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(ReadObj, GivesFacesBeforeAnyUsemtlADefaultMaterialOfNoLibrary) {
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl default\nKd 1 0 0\n");
    const auto reading = read(folder, "mtllib m.mtl\n" + kSquare + "f 1 2 3\n");
    ASSERT_EQ(reading.scene.materials.size(), 1u);
    EXPECT_EQ(reading.scene.materials[0].name, "default");
    EXPECT_EQ(reading.scene.materials[0].base_color, glm::vec3(0.8f));
    EXPECT_TRUE(reading.warnings.empty());
}

float red_of(const TemporaryFolder& folder, const std::string& text) {
    const auto reading = read(folder, text);
    for (const std::string& warning : reading.warnings) ADD_FAILURE() << warning;
    return reading.scene.materials.at(0).base_color.x;
}

TEST(ReadObj, FindsLibrariesHoweverTheyAreNamed) {
    const TemporaryFolder folder;
    folder.write("one.mtl", "newmtl a\nKd 0.25 0 0\n");
    folder.write("two.mtl", "newmtl b\nKd 0.5 0 0\nnewmtl a\nKd 0.9 0 0\n");
    folder.write("sub dir/with blanks.mtl", "\xEF\xBB\xBFnewmtl a b\r\nKd 0.75 0 0\r\n");
    const std::string face = kSquare + "f 1 2 3\n";
    EXPECT_EQ(red_of(folder, "mtllib one.mtl\nusemtl a\n" + face), 0.25f);
    EXPECT_EQ(red_of(folder, "usemtl a\n" + face + "mtllib one.mtl\n"), 0.25f);
    EXPECT_EQ(red_of(folder, "mtllib one.mtl\ttwo.mtl \nusemtl b\n" + face), 0.5f);
    EXPECT_EQ(red_of(folder, "mtllib one.mtl\nmtllib two.mtl\nusemtl a\n" + face), 0.25f);
    EXPECT_EQ(red_of(folder, "mtllib sub dir\\with blanks.mtl\nusemtl a b\n" + face), 0.75f);
    EXPECT_EQ(red_of(folder, "mtllib ./sub dir/with blanks.mtl \nusemtl  a b \r\n" + face), 0.75f);
}

TEST(ReadObj, WarnsOfWhatIsMissingAndGoesOn) {
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl a\n");
    const std::string faces = kSquare + "usemtl q\nf 1 2 3\nusemtl r\nf 1 2 3\nusemtl q\nf 1 2 3\n";
    auto reading = read(folder, "\nmtllib no such.mtl\n" + faces);
    EXPECT_EQ(reading.warnings,
              std::vector<std::string>{"scene.obj:2: no material library 'no such.mtl'"});
    EXPECT_EQ(reading.scene.materials.at(1).name, "r");
    reading = read(folder, "mtllib m.mtl gone.mtl\n" + faces);
    EXPECT_EQ(reading.warnings,
              std::vector<std::string>{"scene.obj:1: no material library 'gone.mtl'"});
    reading = read(folder, "mtllib m.mtl\n" + faces);
    ASSERT_EQ(reading.warnings.size(), 2u);
    EXPECT_TRUE(reading.warnings[0].starts_with("scene.obj:6: no material library defines 'q'"));
    EXPECT_TRUE(reading.warnings[1].starts_with("scene.obj:8: no material library defines 'r'"));
    std::filesystem::create_directory(folder.path() / "folder.mtl");
    EXPECT_EQ(read(folder, "mtllib folder.mtl\n" + faces).warnings.size(), 1u);
}

TEST(ReadObj, WarnsOnceOfEachKindOfThingItLeavesOut) {
    const TemporaryFolder folder;
    const std::string text = kSquare +
                             "f 1 2\nf\ncurv 0 1 1 2\nsurf 1 2\ncurv 0 1 1 3\nf 1 2 3\n"
                             "l 1 2\np 1 2\nl 2 3\nbevel on\nlod 2\nfoo\nBar \x01\ns x\ns -1\n";
    for (const std::size_t chunk : {1, 40, 1 << 18}) {
        const auto reading = read(folder, text, chunk);
        EXPECT_EQ(reading.warnings,
                  (std::vector<std::string>{
                      "scene.obj:5: a face of fewer than three corners is left out (2 in all)",
                      "scene.obj:7: 'curv' is not supported and left out (2 in all)",
                      "scene.obj:8: 'surf' is not supported and left out (1 in all)",
                      "scene.obj:11: points and lines are left out (3 in all)",
                      "scene.obj:14: 'bevel' is not supported and left out (1 in all)",
                      "scene.obj:15: 'lod' is not supported and left out (1 in all)",
                      "scene.obj:16: statements that are not known are left out, the first 'foo' "
                      "(2 in all)",
                      "scene.obj:18: what is no smoothing group leaves smoothing as it was, the "
                      "first 'x' (2 in all)"}));
        EXPECT_EQ(reading.scene.corners.size(), 3u);
    }
}

TEST(ReadObj, SaysNothingOfWhatChangesNothing) {
    const auto reading =
        read(kSquare +
             "g a\no b\nmg 1 0.5\ng\nvp 1 2\nbevel off\nc_interp off\nd_interp off\nlod 0\n"
             "usemap (null)\nusemap off\ncstype bspline\ndeg 3\nend\nv 1 2 3 0.5\nf 1 2 3\n"
             "vt 0 0 0\nvn 0 0 0\ns off\n# l 1 2\n");
    EXPECT_EQ(reading.warnings, std::vector<std::string>{});
}

/// What SourceScene promises.
void expect_contract(const bake::SourceScene& scene) {
    const auto good = [](float x) { return std::isfinite(x) && !(x == 0 && std::signbit(x)); };
    for (const auto& p : scene.positions) ASSERT_TRUE(good(p.x) && good(p.y) && good(p.z));
    for (const auto& n : scene.normals) ASSERT_TRUE(good(n.x) && good(n.y) && good(n.z));
    for (const auto& uv : scene.uvs) ASSERT_TRUE(good(uv.x) && good(uv.y));
    ASSERT_FALSE(scene.corners.empty());
    ASSERT_EQ(scene.corners.size(), 3 * scene.triangle_material.size());
    bool complete = true;
    std::vector<bool> may_lack(scene.triangle_material.size());
    std::size_t end = 0;
    for (const bake::TriangleRange& range : scene.without_normals) {
        ASSERT_TRUE(range.begin >= end && range.begin < range.end);
        ASSERT_LE(end = range.end, may_lack.size());
        for (std::size_t t = range.begin; t < end; ++t) may_lack[t] = true;
    }
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        const bake::Corner& corner = scene.corners[i];
        ASSERT_TRUE(corner.normal != kAbsent || may_lack[i / 3]);
        ASSERT_LT(corner.position, scene.positions.size());
        ASSERT_TRUE(corner.uv == kAbsent || corner.uv < scene.uvs.size());
        complete &= corner.normal != kAbsent;
        if (corner.normal == kAbsent) continue;
        ASSERT_LT(corner.normal, scene.normals.size());
        const glm::vec3 n = scene.normals[corner.normal];
        ASSERT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-5);
    }
    ASSERT_EQ(scene.smoothing_group.size(), complete ? 0 : scene.triangle_material.size());
    ASSERT_EQ(scene.without_normals.empty(), complete);
    std::vector<bool> used(scene.materials.size());
    for (const std::uint32_t material : scene.triangle_material) {
        ASSERT_LT(material, scene.materials.size());
        used[material] = true;
    }
    ASSERT_EQ(std::count(used.begin(), used.end(), false), 0);
}

struct Missing {
    const char* what;
    std::string text;  ///< behind a square, vt 0.5 0.5 and vn 0 0 1
    std::string bad_corners, warning;
};

class MissingAttribute : public testing::TestWithParam<Missing> {};

/// `bad_corners` has a digit a corner: 1 where it lacks what is tested.
TEST_P(MissingAttribute, IsAbsentWithOneWarning) {
    for (const std::size_t chunk : {1, 30, 1 << 18}) {
        const TemporaryFolder folder;
        const auto reading =
            read(folder, kSquare + "vt 0.5 0.5\nvn 0 0 1\n" + GetParam().text, chunk);
        EXPECT_EQ(reading.warnings, std::vector<std::string>{"scene.obj:" + GetParam().warning});
        const bool is_normal = GetParam().warning.find("normal") != std::string::npos;
        std::string bad;
        bool complete = true;
        for (const bake::Corner& corner : reading.scene.corners) {
            bad += (is_normal ? corner.normal : corner.uv) == kAbsent ? '1' : '0';
            complete &= corner.normal != kAbsent;
        }
        EXPECT_EQ(bad, GetParam().bad_corners);
        EXPECT_EQ(reading.scene.smoothing_group.empty(), complete);
        expect_contract(reading.scene);
        for (const glm::vec3& n : reading.scene.normals) EXPECT_FALSE(std::isnan(n.x));
        for (const glm::vec2& uv : reading.scene.uvs) EXPECT_FALSE(std::isnan(uv.x));
    }
}

INSTANTIATE_TEST_SUITE_P(
    ReadObj, MissingAttribute,
    testing::Values(
        Missing{"large_uv", "f 1/1/1 2/2/1 3/9/1\n", "011",
                "7: 2 corners have a texture coordinate that is missing; 0 is used (texture "
                "coordinate index 2 is out of range: the file has 1)"},
        Missing{"negative_uv", "f 1/-1/1 2/-1/1 3/-2/1\n", "001",
                "7: 1 corner has a texture coordinate that is missing; 0 is used (texture "
                "coordinate index -2 is out of range: 1 come before it)"},
        Missing{"unsigned_minus_one", "f 1/4294967295/1 2/1/1 3/1/1\n", "100",
                "7: 1 corner has a texture coordinate that is missing; 0 is used (texture "
                "coordinate index 4294967295 is out of range: the file has 1)"},
        Missing{"zero_normal", "f 1//1 2//1 3//1\nf 1//0 2//0 3//1\n", "000110",
                "8: 2 corners have a normal that is missing; made (normal index 0: indices count "
                "from 1)"},
        Missing{"of_a_polygon", "f 1//9 2//1 3//9 4//9\n", "101111",
                "7: 3 corners have a normal that is missing; made (normal index 9 is out of range: "
                "the file has 1)"},
        Missing{"nan", "vn nan nan nan\nvn 0 0 1\n# c\nf 1//3 2//2 3//3\n", "010",
                "10: 1 corner has a normal that is missing; made (line 7: 'nan' is not a finite "
                "number)"},
        Missing{"microsoft", "vn 0 0 1.#QNAN\nf 1//2 2//1 3//1\n", "100",
                "8: 1 corner has a normal that is missing; made (line 7: '1.#QNAN' is not a finite "
                "number)"},
        Missing{"microsoft_rounded", "vn 0 -1.#J 0\nf 1//2 2//1 3//1\n", "100",
                "8: 1 corner has a normal that is missing; made (line 7: '-1.#J' is not a finite "
                "number)"},
        Missing{"new_microsoft", "vn -nan(ind) 0 0\nf 1//2 2//1 3//1\n", "100",
                "8: 1 corner has a normal that is missing; made (line 7: '-nan(ind)' is not a "
                "finite number)"},
        Missing{
            "infinite", "vt -inf 0\nf 1/2/1 2/1/1 3/1/1\n", "100",
            "8: 1 corner has a texture coordinate that is missing; 0 is used (line 7: '-inf' is "
            "not a finite number)"},
        Missing{
            "too_large", "vt 0 1e39\nf 1/2/1 2/1/1 3/1/1\n", "100",
            "8: 1 corner has a texture coordinate that is missing; 0 is used (line 7: '1e39' is "
            "not a finite number)"},
        Missing{"no_number", "vt x\nf 1/2/1 2/1/1 3/1/1\n", "100",
                "8: 1 corner has a texture coordinate that is missing; 0 is used (line 7: 'x' is "
                "not a number)"},
        Missing{"too_few", "vn 1 \\\n 0\nf 1//2 2//1 3//1\n", "100",
                "9: 1 corner has a normal that is missing; made (line 7: a number is missing)"},
        Missing{"no_length", "vn 0 0 0\nvn 0 -0 0e9\nf 1//2 2//1 3//3\n", "101",
                "9: 2 corners have a normal that is missing; made (its length is 0)"},
        Missing{"unused", "vn 1 0\nf 1//1 2//1 3//1\n", "000",
                "7: a number is missing; no corner has this normal"}),
    [](const auto& test) { return std::string(test.param.what); });

TEST(ReadObj, KeepsTheSmoothingOfMissingNormals) {
    const auto scene = read(kSquare + "s 3\nf 1//1 2//1 3//1\n").scene;
    EXPECT_EQ(numbers(scene.smoothing_group), std::vector<std::uint32_t>{3});
}

/// 0xBBGGRR of the corner, which must be opaque.
std::uint32_t color_at(const bake::SourceScene& scene, std::size_t corner) {
    EXPECT_EQ(scene.colors.at(corner) >> 24, 0xFFu);
    return scene.colors.at(corner) & 0xFFFFFF;
}

TEST(ReadObj, ReadsVertexColoursAsTheyAreEncoded) {
    const std::string text =
        "v 0 0 0 1 0 0\nv 1 0 0 0.5 0.25 0.2 1\nv 1 1 0\nv 0 1 0 0.1 \\\n 0 1 255\nf 1 2 3 4\n"
        "f 3 2 1\n";
    for (const std::size_t chunk : {1, 30, 1 << 18}) {
        const TemporaryFolder folder;
        const auto reading = read(folder, text, chunk);
        EXPECT_EQ(reading.warnings, std::vector<std::string>{});
        const std::vector<std::uint32_t> by_position{0x0000FF, 0x334080, 0xE7E7E7, 0xFF001A};
        ASSERT_EQ(reading.scene.colors.size(), 9u);
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_EQ(color_at(reading.scene, i), by_position[reading.scene.corners[i].position]);
        }
        EXPECT_EQ(reading.scene.materials.at(0).base_color, glm::vec3(1));
    }
    EXPECT_TRUE(read(kSquare + "f 1 2 3\n").scene.colors.empty());
    EXPECT_TRUE(read(kSquare + "v 1 2 3 0.5\nv 1 2 3 0.5 0.5\nf 1 2 3\n").scene.colors.empty());
}

// The grey of a corner without colour is 0.8, encoded by the curve of sRGB.
TEST(ReadObj, AColouredMaterialsFactorIsWhatItStates) {
    const double grey = 255 * (1.055 * std::pow(0.8, 1 / 2.4) - 0.055);
    EXPECT_EQ(std::lround(grey), 0xE7);
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl kd\nKd 0.5 0.5 0.5\nnewmtl map\nmap_Kd a.png\nnewmtl none\n");
    const auto scene = read(folder,
                            "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nusemtl kd\nf 1 2 3\n"
                            "usemtl map\nf 1 2 3\nusemtl none\nf 1 2 3\nusemtl gone\nf 2 3 2\n")
                           .scene;
    EXPECT_EQ(scene.materials[0].base_color, glm::vec3(0.5f));
    EXPECT_EQ(scene.materials[1].base_color, glm::vec3(1));
    EXPECT_EQ(scene.materials[2].base_color, glm::vec3(1));
    EXPECT_EQ(scene.materials[3].base_color, glm::vec3(0.8f));
    const std::vector<std::uint32_t> second{0xFFFFFF, 0xFFFFFF, 0xE7E7E7};
    for (std::size_t material = 0; material < 3; ++material) {
        EXPECT_EQ(color_at(scene, 3 * material), 0x0000FFu);
        EXPECT_EQ(color_at(scene, 3 * material + 1), second[material]);
    }
    EXPECT_EQ(color_at(scene, 9), 0xFFFFFFu);
}

TEST(ReadObj, VertexColoursMayBeBytesAndAreClampedElse) {
    const std::string face = "f 1 2 3\n";
    auto reading = read("v 0 0 0 255 128 0\nv 1 0 0 1 0 0\nv 1 1 0 0 2 300\n" + face);
    EXPECT_EQ(reading.warnings, std::vector<std::string>{
                                    "scene.obj:1: vertex colours are taken as 0 to 255, for some "
                                    "are above 1 (2 in all)"});
    EXPECT_EQ(color_at(reading.scene, 0), 0x0080FFu);
    EXPECT_EQ(color_at(reading.scene, 1), 0x000001u);
    EXPECT_EQ(color_at(reading.scene, 2), 0xFF0200u);
    reading = read("v 0 0 0 1.5 0.2 0\nv 1 0 0 1 0 0\nv 1 1 0 -1 0 1\n" + face);
    EXPECT_EQ(reading.warnings,
              std::vector<std::string>{
                  "scene.obj:1: vertex colours outside 0 to 1 are clamped (2 in all)"});
    EXPECT_EQ(color_at(reading.scene, 0), 0x0033FFu);
    EXPECT_EQ(color_at(reading.scene, 2), 0xFF0000u);
    reading =
        read("v 0 0 0 nan 0 0\nv 1 0 0 1.#IND 0 0\nv 1 1 0 a b c\nv 0 0 1 0 0 0 0.5\n" + face);
    EXPECT_EQ(reading.warnings,
              (std::vector<std::string>{
                  "scene.obj:1: vertex colours that are no finite numbers are left out (3 in all)",
                  "scene.obj:4: the alpha of vertex colours is left out (1 in all)"}));
}

TEST(ReadObj, ReadsThePaintOfZBrush) {
    const std::string text = kSquare +
                             "#MRGB ff102030ff405060\n#MRGB ff708090\n#MRGB \n#MRGBx\n#MRGB zz\n"
                             "v 0 0 1\n#MRGB 00FFFF00\nf 1 2 3\nf 4 5 1\n";
    for (const std::size_t chunk : {1, 30, 1 << 18}) {
        const TemporaryFolder folder;
        const auto reading = read(folder, text, chunk);
        EXPECT_EQ(reading.warnings, std::vector<std::string>{});
        const std::vector<std::uint32_t> expected{0xE7E7E7, 0x302010, 0x605040,
                                                  0x908070, 0x00FFFF, 0xE7E7E7};
        for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(color_at(reading.scene, i), expected[i]);
    }
}

TEST(ReadObj, AnUnnamedMaterialIsOneThatIsNamedNothing) {
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n");
    const std::string face = "f 1 2 3\n";
    const auto reading =
        read(folder, "mtllib m.mtl\n" + kSquare + face + "usemtl b\n" + face + "usemtl \n" + face);
    EXPECT_EQ(reading.warnings, std::vector<std::string>{});
    ASSERT_EQ(reading.scene.materials.size(), 3u);
    EXPECT_EQ(reading.scene.materials[0].base_color, glm::vec3(0.8f));
    EXPECT_EQ(reading.scene.materials[2].base_color, glm::vec3(1, 0, 0));
    EXPECT_EQ(reading.scene.materials[2].name, "default");
}

TEST(ReadObj, AMaterialCalledNullIsOneOnlyWhereALibraryHasIt) {
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl a\nKd 1 0 0\n");
    const std::string text = "mtllib m.mtl\n" + kSquare + "usemtl (null)\nf 1 2 3\n";
    const auto none = read(folder, text);
    EXPECT_EQ(none.warnings, std::vector<std::string>{});
    EXPECT_EQ(none.scene.materials.at(0).base_color, glm::vec3(0.8f));
    folder.write("m.mtl", "newmtl (null)\nKd 1 0 0\n");
    EXPECT_EQ(read(folder, text).scene.materials.at(0).base_color, glm::vec3(1, 0, 0));
}

TEST(ReadObj, TransformsTheUvsOfAMaterialThatAsksForIt) {
    const TemporaryFolder folder;
    folder.write("m.mtl",
                 "newmtl a\nmap_Kd -s 4 2 1 -o .5 -1 a.png\nnewmtl b\nmap_Kd b.png\n"
                 "newmtl c\nmap_Kd -s 3e38 1 a.png\n");
    const std::string text = "mtllib m.mtl\n" + kSquare + "vt 0.25 0.5\nvt 10 0\n";
    const auto uv = [](const bake::SourceScene& scene, std::size_t corner) {
        return scene.uvs[scene.corners[corner].uv];
    };
    const auto scene =
        read(folder, text + "usemtl a\nf 1/1 2/2 3/1\nusemtl b\nf 1/1 2/2 3\n").scene;
    EXPECT_EQ(uv(scene, 0), glm::vec2(1.5f, 0));
    EXPECT_EQ(uv(scene, 1), glm::vec2(40.5f, -1));
    EXPECT_EQ(scene.corners[0].uv, scene.corners[2].uv);
    EXPECT_EQ(uv(scene, 3), glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(scene.corners[5].uv, kAbsent);
    const auto huge = read(folder, text + "usemtl c\nf 1/1 2/2 3/1\n");
    EXPECT_EQ(uv(huge.scene, 1), glm::vec2(0));
    EXPECT_EQ(huge.warnings.size(), 1u);
}

struct Bad {
    const char* what;
    std::string text;
    std::string message;  ///< or how it starts
};

class BadObj : public testing::TestWithParam<Bad> {};

TEST_P(BadObj, IsRefusedAtTheRightLine) {
    std::string text = GetParam().text;
    for (const auto* line_end : {"\n", "\r", "\r\n"}) {
        for (const std::size_t chunk : {1, 30, 1 << 18}) {
            const std::string message = error_of(replaced(text, "\n", line_end), chunk);
            EXPECT_EQ(message.substr(0, GetParam().message.size()), GetParam().message);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    ReadObj, BadObj,
    testing::Values(
        Bad{"empty", "", "scene.obj: has no faces"},
        Bad{"only_vertices", kSquare, "scene.obj: has no faces"},
        Bad{"prose", "Dear reader,\nthis is no model.\n", "scene.obj: has no faces"},
        Bad{"binary", std::string("\x89PNG\n\x1a\n\0\0\0\rIHDR", 15), "scene.obj: is no OBJ"},
        Bad{"too_large", kSquare + "f 1 2 5\n",
            "scene.obj:5: vertex index 5 is out of range: the file has 4"},
        Bad{"far_too_large", kSquare + "f 1 2 4294967297\n",
            "scene.obj:5: vertex index 4294967297 is out of range: the file has 4"},
        Bad{"enormous", kSquare + "f 1 2 184467440737095516170001\n",
            "scene.obj:5: vertex index 184467440737095516170001 is out of range: the file has 4"},
        Bad{"too_negative", kSquare + "f 1 2 3\nf 1 2 -5\nv 1 2 3\n",
            "scene.obj:6: vertex index -5 is out of range: 4 come before it"},
        Bad{"far_too_negative", kSquare + "f 1 2 -4294967297\n",
            "scene.obj:5: vertex index -4294967297 is out of range: 4 come before it"},
        Bad{"far_too_negative_then", kSquare + "f -99999999999999999999 2 3\nv 1 2 3\n",
            "scene.obj:5: vertex index -99999999999999999999 is out of range: 4 come before it"},
        Bad{"first_of_two", kSquare + "f 1 2 9\nf 1 2 -9\n", "scene.obj:5: vertex index 9"},
        Bad{"zero", kSquare + "f 0 1 2\n", "scene.obj:5: vertex index 0: indices count from 1"},
        Bad{"no_index", kSquare + "f 1 2 x\n", "scene.obj:5: 'x' is not an index"},
        Bad{"fraction", kSquare + "f 1 2 3.5\n", "scene.obj:5: '3.5' is not a corner"},
        Bad{"four_parts", kSquare + "f 1/1/1/1 2 3\n", "scene.obj:5: "},
        Bad{"lone_minus", kSquare + "f 1 2 -\n", "scene.obj:5: '-' is not an index"},
        Bad{"nan", kSquare + "v 1 nan 0\n", "scene.obj:5: 'nan' is not a finite number"},
        Bad{"microsoft_nan", kSquare + "v 1 2 -1.#IND\n",
            "scene.obj:5: '-1.#IND' is not a finite number"},
        Bad{"overflow", kSquare + "v 1e39 0 0\n", "scene.obj:5: '1e39' is not a finite number"},
        Bad{"word", kSquare + "v 1 two 3\n", "scene.obj:5: 'two' is not a number"},
        Bad{"comma", kSquare + "v 1,5 2 3\n", "scene.obj:5: '1,5' is not a number"},
        Bad{"too_few", kSquare + "v 1 2\n", "scene.obj:5: a number is missing"},
        Bad{"none", kSquare + "v\n", "scene.obj:5: a number is missing"},
        Bad{"commented_away", kSquare + "v 1 2 # 3\n", "scene.obj:5: a number is missing"},
        Bad{"statement_of_lines", kSquare + "# c\n\nf 1 \\\n 2 \\\n 9\nf 1 2 3\n",
            "scene.obj:7: vertex index 9"},
        Bad{"behind_continuation", kSquare + "f 1 \\\n 2 \\\n 3\nv 1 2 x\n",
            "scene.obj:8: 'x' is not a number"},
        Bad{"last_line", kSquare + "f 1 2 3\nf 1 2 x", "scene.obj:6: 'x' is not an index"}),
    [](const auto& test) { return std::string(test.param.what); });

TEST(ReadObj, NamesAMissingFileAndADirectory) {
    const TemporaryFolder folder;
    const auto message = [](const std::filesystem::path& path) -> std::string {
        try {
            bake::read_obj(path, [](const std::string&) {});
        } catch (const BakeError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_TRUE(
        message(folder.path() / "no.obj").starts_with((folder.path() / "no.obj: ").string()));
    EXPECT_TRUE(message(folder.path()).starts_with(folder.path().string() + ": "));
}

bool same(const bake::SourceScene& a, const bake::SourceScene& b) {
    return a.positions == b.positions && a.normals == b.normals && a.uvs == b.uvs &&
           a.triangle_material == b.triangle_material && corner_values(a) == corner_values(b);
}

TEST(ReadObj, DependsNeitherOnThePiecesNorOnTheThreads) {
    std::mt19937 random(1);
    for (int i = 0; i < 10; ++i) {
        const TemporaryFolder folder;
        const std::string text = random_obj(random, 60, 8);
        const auto whole = read(folder, text, text.size()).scene;
        EXPECT_FALSE(whole.corners.empty());
        for (const std::size_t chunk : {1, 13, 100, 1000}) {
            for (const std::size_t threads : {1, 2, 5}) {
                const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                                  threads);
                EXPECT_TRUE(same(read(folder, text, chunk).scene, whole));
            }
        }
    }
}

TEST(ReadObj, EndsInASoundSceneOrAnErrorHoweverAFileIsAltered) {
    std::mt19937 random(2);
    const auto pick = [&](std::size_t below) {
        return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
    };
    const std::string seed =
        random_obj(random, 6, 7) + "f 1 2 \\\n 3 4\ns off\r\nusemtl x y\rf 1 2 3";
    const std::string odd("\\\n\r \t/-+.0123456789eEvtnfs#\0\xFFnaif", 33);
    const TemporaryFolder folder;
    folder.write("scene.mtl", "newmtl m1\nKd 1 0 0\n");
    int scenes = 0, errors = 0;
    for (int i = 0; i < 2500; ++i) {
        std::string text = seed;
        for (std::size_t n = 1 + pick(4); n > 0 && !text.empty(); --n) {
            const std::size_t at = pick(text.size()), length = pick(12);
            switch (pick(5)) {
                case 0:
                    text[at] = odd[pick(odd.size())];
                    break;
                case 1:
                    text.insert(at, 1, odd[pick(odd.size())]);
                    break;
                case 2:
                    text.erase(at, length);
                    break;
                case 3:
                    text.insert(pick(text.size()), text.substr(at, length));
                    break;
                default:
                    text.resize(at);
                    break;
            }
        }
        try {
            expect_contract(read(folder, text, 1 + pick(300)).scene);
            ++scenes;
        } catch (const BakeError& error) {
            ++errors;
            EXPECT_EQ(std::string(error.what()).find((folder.path() / "scene.obj:").string()), 0u);
        }
        if (HasFatalFailure()) FAIL() << text;
    }
    EXPECT_GT(scenes, 200);
    EXPECT_GT(errors, 200);
}

TEST(ReadObj, PositionsFarAwayAreReadInDoubleRelativeToAnOrigin) {
    const std::string text =
        "v 500000.120001 4600000.340002 0.1\nv 500000.620003 4600000.340004 0.2\n"
        "v 500000.120005 4600000.840006 0.3\nv 0 0 0\nf 1 2 3\n";
    const Reading reading = read(text);
    const glm::dvec3 origin = reading.scene.origin;
    EXPECT_NE(origin, glm::dvec3(0.0));
    const glm::dvec3 truth[] = {{500000.120001, 4600000.340002, 0.1},
                                {500000.620003, 4600000.340004, 0.2},
                                {500000.120005, 4600000.840006, 0.3}};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 position = origin + glm::dvec3(reading.scene.positions[i]);
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(position[axis], truth[i][axis], 1e-7);
    }
    // The same in pieces of a line or two.
    EXPECT_EQ(read(TemporaryFolder(), text, 40).scene.positions, reading.scene.positions);
}

TEST(ReadObj, PositionsRelativeToAnOriginHaveNoMinusZero) {
    const bake::SourceScene scene =
        read("v -1e-50 4600000 -0\nv 0.75 4600000 0\nv 0 4600001 1\nf 1 2 3\n").scene;
    ASSERT_NE(scene.origin.y, 0.0);
    ASSERT_EQ(scene.origin.x, 0.0);
    EXPECT_EQ(scene.positions[0].x, 0.0f);
    EXPECT_FALSE(std::signbit(scene.positions[0].x));
}

TEST(ReadObj, WhatFloatsCannotTellApartIsReadRelativeToAnOrigin) {
    for (const double size : {1e-3, 0.01, 0.09, 1.0}) {
        for (const double place : {1e6, 1e6 + 0.031, -3e8}) {
            const Reading reading = read(fmt::format(
                "v {0:.17g} {0:.17g} 0\nv {1:.17g} {0:.17g} 0\nv {0:.17g} {1:.17g} 0\nf 1 2 3\n",
                place, place + size));
            const auto& p = reading.scene.positions;
            EXPECT_NEAR(reading.scene.origin.x + p[0].x, place, 1e-7) << size;
            // As near as doubles of that place are.
            EXPECT_NEAR(double{p[1].x} - p[0].x, (place + size) - place, 3e-6 * size) << place;
        }
    }
}

TEST(ReadObj, PositionsNearEnoughHaveNoOrigin) {
    EXPECT_EQ(read("v 9 0 0\nv 10 0 0\nv 9 1 0\nf 1 2 3\n").scene.origin, glm::dvec3(0.0));
    EXPECT_EQ(read("v 7 7 7\nf 1 1 1\n").scene.origin, glm::dvec3(0.0)) << "a point";
}

}  // namespace
