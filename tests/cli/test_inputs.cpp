// What a bake reads: --depfile, and outputs that are refused because they are inputs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/input_files.h"
#include "tests/cli/scene_folder.h"
#include "tests/support/gltf_writer.h"

namespace {

namespace fs = std::filesystem;

class Inputs : public SceneFolder {
 protected:
    /// What GNU make would bake anew because it is older than its inputs; empty for nothing.
    std::string stale() {
        write("Makefile", "include deps.mk\n%.cw2mesh:\n\t@echo stale\n");
        const Outcome outcome = run({GNU_MAKE, "-s"}, {{}, folder_.path()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return outcome.out.starts_with("stale") ? "stale" : "";
    }
    /// The same of ninja, for which a generator's command need not be in its log.
    std::string ninja_rebakes() {
        write("build.ninja",
              "rule bake\n  command = bake\n  depfile = deps.mk\n  generator = 1\n"
              "build out.cw2mesh: bake\n");
        const Outcome outcome = run({NINJA, "-n"}, {{}, folder_.path()});
        EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
        return outcome.out.find("no work to do") == std::string::npos ? "stale" : "";
    }
    void make_older(const std::string& name) const {
        fs::last_write_time(here(name), fs::last_write_time(here(name)) - std::chrono::hours(1));
    }
    void make_newer(const std::string& name) const {
        fs::last_write_time(here(name), fs::last_write_time(here(name)) + std::chrono::hours(1));
    }
};

TEST_F(Inputs, MakeBakesAnewWhenAnyFileThatWasReadChanges) {
    bake_well({"scene.obj", "-o", "out.cw2mesh", "--quiet", "--depfile", "deps.mk"});
    EXPECT_EQ(stale(), "");
    for (const char* name :
         {"scene.obj", "scene.mtl", "colors.png", "rough 1.png", "normals.png", "mask.png"}) {
        make_newer(name);
        EXPECT_EQ(stale(), "stale") << name;
        make_older(name);
    }
    EXPECT_EQ(stale(), "");
}

TEST_F(Inputs, WhatIsMissingKeepsMakeAndNinjaBakingUntilItIsThere) {
    const std::vector<std::string> names{"scene.mtl", "colors.png", "rough 1.png", "mask.png"};
    const std::vector<std::string> arguments{"scene.obj", "-o",      "out.cw2mesh",
                                             "--depfile", "deps.mk", "--quiet"};
    // Ninja looks into its log for the command, too.
    const auto expect_stale = [&](const std::string& what, const std::string& name) {
        EXPECT_EQ(stale(), what) << name;
        EXPECT_EQ(ninja_rebakes(), what) << name;
    };
    for (const std::string& name : names) {
        fs::rename(here(name), here("away"));
        ASSERT_EQ(bake(arguments).status, 0);
        expect_stale("stale", name);
        ASSERT_EQ(bake(arguments).status, 0);
        expect_stale("stale", name);
        fs::rename(here("away"), here(name));
        fs::last_write_time(here(name), fs::file_time_type::clock::now() + std::chrono::seconds(2));
        expect_stale("stale", name);
        fs::last_write_time(here(name), fs::last_write_time(here("out.cw2mesh")));
        ASSERT_EQ(bake(arguments).status, 0);
        expect_stale("", name);
    }
    // Without textures no image is lacked.
    fs::remove(here("mask.png"));
    bake_well({"scene.obj", "-o", "out.cw2mesh", "--depfile", "deps.mk", "--textures", "none",
               "--quiet"});
    expect_stale("", "mask.png");
}

/// Every name that is not refused is one file to make and to ninja.
TEST_F(Inputs, NoNameIsSplitExpandedOrRun) {
    fs::current_path(folder_.path());
    write("last.png", "");
    std::string refused;  // in the middle of a name
    const auto expect_one_file = [&](const std::string& name, char odd, bool middle) {
        SCOPED_TRACE(name);
        write(name, "");
        try {
            write("deps.mk", bake::depfile_text("out.cw2mesh", {"scene.obj", name, "last.png"}));
        } catch (const bake::BakeError&) {
            if (middle && odd >= ' ') refused += odd;
            fs::remove(here(name));
            return;
        }
        const auto expect_stale = [&](const std::string& what) {
            EXPECT_EQ(stale(), what);
            EXPECT_EQ(ninja_rebakes(), what);
        };
        write("out.cw2mesh", "");
        make_newer("out.cw2mesh");
        expect_stale("");
        for (const std::string& input : {name, std::string("last.png")}) {
            fs::last_write_time(here(input),
                                fs::last_write_time(here(input)) + std::chrono::hours(2));
            expect_stale("stale");
            fs::last_write_time(here(input),
                                fs::last_write_time(here(input)) - std::chrono::hours(2));
        }
        fs::remove(here(name));
        if (odd != '%' && odd != '=') expect_stale("stale");
        EXPECT_FALSE(fs::exists(here("ran")));
    };
    for (char odd = 1; odd < 0x7F; ++odd) {
        if (std::isalnum(static_cast<unsigned char>(odd)) != 0 || odd == '/') continue;
        expect_one_file(std::string("a") + odd + "b.png", odd, true);
        if (odd < ' ' && odd != '\t' && odd != '\n') continue;
        expect_one_file(odd + std::string("touch ran"), odd, false);
        expect_one_file(std::string("a.png") + odd, odd, false);
        expect_one_file(std::string("a\\") + odd + "b.png", odd, false);
        expect_one_file(std::string("a") + odd + odd + "b.png", odd, false);
    }
    EXPECT_EQ(refused, "\"&'*;<>?^`|");
    EXPECT_THROW(bake::depfile_text("a%b.cw2mesh", {"scene.obj"}), bake::BakeError);
    EXPECT_THROW(bake::depfile_text("out.cw2mesh", {"a=b.obj"}), bake::BakeError);
    EXPECT_THROW(bake::depfile_text("out.cw2mesh", {"scene.obj", "gone%.png"}), bake::BakeError);
    write("tex[1].png", "");
    bake::depfile_text("out.cw2mesh", {"scene.obj", "tex[1].png"});
    write("tex1.png", "");
    EXPECT_THROW(bake::depfile_text("out.cw2mesh", {"scene.obj", "tex[1].png"}), bake::BakeError);
    fs::create_directory("a[b]");
    write("a[b]/tex.png", "");
    fs::create_directory("ab");
    bake::depfile_text("out.cw2mesh", {"scene.obj", "a[b]/tex.png"});
    write("ab/tex.png", "");
    EXPECT_THROW(bake::depfile_text("out.cw2mesh", {"scene.obj", "a[b]/tex.png"}), bake::BakeError);
    // A pattern of ever more paths costs no time.
    for (const char* many : {"/*/..", "/[!~][!~][!~]/.."}) {
        std::string name;
        for (int i = 0; i < 200; ++i) name += many;
        EXPECT_THROW(bake::depfile_text("out.cw2mesh", {"scene.obj", name + "/tm[p]"}),
                     bake::BakeError);
    }
}

TEST_F(Inputs, NamesAreEscapedForMake) {
    const std::string odd = "a #$b  c$(x).png";
    fs::rename(here("colors.png"), here(odd));
    write("scene.mtl", "newmtl stone\nmap_Kd " + odd + "\nnewmtl leaf\nnewmtl plain\n");
    bake_well({"scene.obj", "-o", "o u t.cw2mesh", "--quiet", "--depfile", "deps.mk"});
    EXPECT_EQ(stale(), "");
    make_newer(odd);
    EXPECT_EQ(stale(), "stale");
}

TEST_F(Inputs, TheBufferAndTheImagesOfAGltfAreInputs) {
    GltfWriter gltf = square_gltf();
    gltf.root["images"] = {{{"uri", "rough%201.png"}}};
    gltf.root["textures"] = {{{"source", 0}}};
    gltf.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    gltf.root["meshes"][0]["primitives"][0]["material"] = 0;
    gltf.write_gltf(here("square.gltf"));
    bake_well({"square.gltf", "-o", "out.cw2mesh", "--quiet", "--depfile", "deps.mk"});
    EXPECT_EQ(read("deps.mk"),
              "out.cw2mesh: \\\n  square.gltf \\\n  square.bin \\\n  rough\\ 1.png\n"
              "square.bin \\\n  rough\\ 1.png:\n");
    const Outcome outcome = bake({"square.gltf", "-o", "square.bin"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "cw2-bake: square.bin: is an input; the output must be another file\n");
}

TEST_F(Inputs, AnOutputThatIsAnInputIsRefused) {
    fs::create_symlink("scene.mtl", here("link"));
    const auto refused = [&](const std::vector<std::string>& options) {
        std::vector<std::string> arguments{"scene.obj", "--quiet"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const std::string obj = read("scene.obj"), mtl = read("scene.mtl"), png = read("mask.png");
        const Outcome outcome = bake(arguments);
        EXPECT_TRUE(obj == read("scene.obj") && mtl == read("scene.mtl") &&
                    png == read("mask.png"));
        EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1);
        return outcome.status == 1 && outcome.err.find("is an input") != std::string::npos;
    };
    EXPECT_TRUE(refused({"-o", "scene.obj"}));
    EXPECT_TRUE(refused({"-o", "./scene.mtl"}));
    EXPECT_TRUE(refused({"-o", "link"}));
    EXPECT_TRUE(refused({"-o", "mask.png"}));
    EXPECT_TRUE(refused({"-o", "out.cw2mesh", "--stats", "scene.mtl"}));
    EXPECT_TRUE(refused({"-o", "out.cw2mesh", "--depfile", "mask.png"}));
    fs::rename(here("mask.png"), here("away"));
    EXPECT_TRUE(refused({"-o", "out.cw2mesh", "--stats", "./mask.png"})) << "though it is missing";
    EXPECT_FALSE(fs::exists(here("mask.png")));
    fs::rename(here("away"), here("mask.png"));
    EXPECT_FALSE(fs::exists(here("out.cw2mesh")));
    const Outcome twice = bake({"scene.obj", "-o", "out.cw2mesh", "--stats", "out.cw2mesh"});
    EXPECT_EQ(twice.status, 1);
    EXPECT_EQ(twice.err, "cw2-bake: out.cw2mesh: is named for two outputs\n");
}

TEST_F(Inputs, GitLfsPointersAreCalledThatWhereverTheyStand) {
    const std::string pointer =
        "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, '0') +
        "\nsize 123456\n";
    const std::string what = "is a Git LFS pointer, not the file; git lfs pull fetches it\n";
    for (const char* name : {"a.obj", "a.gltf", "a.glb", "a.cw2mesh"}) write(name, pointer);
    for (const char* name : {"a.obj", "a.gltf", "a.glb"}) {
        const Outcome outcome = bake({name, "-o", "out.cw2mesh"});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.err, std::string("cw2-bake: ") + name + ": " + what);
    }
    EXPECT_EQ(bake({"--inspect", "a.cw2mesh"}).err, "cw2-bake: a.cw2mesh: " + what);
    EXPECT_EQ(bake({"a.cw2mesh", "-o", "a2.glb"}).err, "cw2-bake: a.cw2mesh: " + what);
    const Outcome drawn = run({CW2_PROGRAM, here("a.cw2mesh"), "--output", here("a.png")});
    EXPECT_EQ(drawn.status, 1);
    EXPECT_EQ(drawn.err, "cw2: " + here("a.cw2mesh").string() + ": " + what);

    GltfWriter gltf = square_gltf();
    gltf.write_gltf(here("square.gltf"));
    write("square.bin", pointer);
    EXPECT_EQ(bake({"square.gltf"}).err, "cw2-bake: square.gltf: /buffers/0: square.bin: " + what);

    write("colors.png", pointer);
    write("mask.png", pointer);
    EXPECT_EQ(bake({"scene.obj", "-o", "out.cw2mesh"}).err,
              "cw2-bake: warning: scene.mtl:3: colors.png: " + what +
                  "cw2-bake: warning: scene.mtl:9: mask.png: " + what);
    write("scene.mtl", pointer);
    EXPECT_EQ(bake({"scene.obj", "-o", "out.cw2mesh"}).err,
              "cw2-bake: warning: scene.obj:1: scene.mtl: " + what);
}

TEST_F(Inputs, RestrictedBakesReadNothingOutsideTheScenesFolder) {
    fs::create_directory(here("scene"));
    for (const char* name : {"scene.obj", "scene.mtl", "colors.png", "rough 1.png", "mask.png"})
        fs::copy_file(here(name), here("scene") / name);
    fs::create_symlink("../normals.png", here("scene/normals.png"));
    const Outcome all = bake({"scene/scene.obj", "-o", "all.cw2mesh"});
    EXPECT_EQ(all.err, "");
    const Outcome restricted =
        bake({"scene/scene.obj", "-o", "restricted.cw2mesh", "--restrict", "--depfile", "deps.mk"});
    EXPECT_EQ(restricted.status, 0);
    EXPECT_EQ(restricted.err,
              "cw2-bake: warning: scene/scene.mtl:6: scene/normals.png: is outside the scene's "
              "folder\n");
    EXPECT_EQ(read("deps.mk").find("normals"), std::string::npos);
    EXPECT_EQ(bake({"scene/scene.obj", "-o", "none.cw2mesh", "--restrict", "--strict"}).status, 1);
    EXPECT_FALSE(fs::exists(here("none.cw2mesh")));
    // The same as if nobody named the normal map.
    std::string mtl = read("scene.mtl");
    write("scene/scene.mtl", mtl.erase(mtl.find("norm normals.png\n"), 17));
    bake({"scene/scene.obj", "-o", "bare.cw2mesh"});
    EXPECT_TRUE(read("restricted.cw2mesh") == read("bare.cw2mesh"));

    write("scene/up.obj", "mtllib ../scene.mtl\n" + read("scene.obj").substr(15));
    fs::remove(here("scene/scene.mtl"));
    const Outcome library = bake({"scene/up.obj", "-o", "up.cw2mesh", "--restrict"});
    EXPECT_NE(library.err.find("scene/up.obj:1: no material library '../scene.mtl'; it is outside "
                               "the scene's folder\n"),
              std::string::npos)
        << library.err;

    bake_well({"scene.obj", "-o", "whole.gltf"});
    std::string gltf = read("whole.gltf");
    const std::size_t data = gltf.find("data:application");
    const std::size_t end = gltf.find('"', data);
    write("scene/outside.gltf", gltf.replace(data, end - data, "../buffer.bin"));
    write("buffer.bin", std::string(1 << 20, '\0'));
    const Outcome buffer = bake({"scene/outside.gltf", "-o", "b.cw2mesh", "--restrict"});
    EXPECT_EQ(buffer.status, 1);
    EXPECT_NE(buffer.err.find("/buffers/0: '../buffer.bin' is outside the scene's folder\n"),
              std::string::npos)
        << buffer.err;
}

}  // namespace
