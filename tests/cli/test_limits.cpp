// Inputs at the ends of what can be: no area, coordinates near the largest float, no memory.
#include "common/encode_png.h"
#include "tests/cli/scene_folder.h"

namespace {

class Limits : public SceneFolder {};

TEST_F(Limits, AnExportThatWouldShowNothingIsRefused) {
    const std::string flat = "v 0 0 0\nv 0 0 0\nv 1 1 1\nf 1 1 1\nf 1 2 3\n";
    write("flat.obj", flat);
    bake_well({"flat.obj", "-o", "flat.cw2mesh", "--quiet"});
    for (const char* input : {"flat.obj", "flat.cw2mesh"}) {
        const Outcome outcome = bake({input, "-o", "flat.glb", "--quiet"});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.err, std::string("cw2-bake: ") + input +
                                   ": shows no triangles: two corners of each are equal\n");
        EXPECT_FALSE(std::filesystem::exists(here("flat.glb")));
    }
    write("flat.obj", flat + "v 2 2 2\nf 1 3 4\n");  // a line, but of distinct corners
    bake_well({"flat.obj", "-o", "flat.glb", "--quiet"});
    bake_well({"flat.glb", "-o", "again.cw2mesh", "--quiet"});
}

TEST_F(Limits, ASceneWithoutAnyAreaIsWarnedOf) {
    // A line, a point, and a line whose corners are rounded.
    const std::string flat =
        "v 0 0 0\nv 1 0 0\nv 3 0 0\nf 1 2 3\nf 2 2 2\n"
        "v 0.1 0.1 0.1\nv 0.2 0.2 0.2\nv 0.7 0.7 0.7\nf 4 5 6\n";
    write("flat.obj", flat);
    const Outcome outcome = bake({"flat.obj", "--quiet", "--strict"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "cw2-bake: flat.obj: shows nothing: no triangle has an area\n");
    EXPECT_EQ(bake({"flat.obj"}).err,
              "cw2-bake: warning: flat.obj: shows nothing: no triangle has an area\n");
    // A sliver of 1:1000 far from the origin is one.
    write("sliver.obj", flat + "v 900 0 0\nv 901 0 0\nv 902 0.001 0\nf 7 8 9\n");
    bake_well({"sliver.obj"});
}

TEST_F(Limits, CoordinatesNearTheLargestFloatAreBlamedOnTheInput) {
    for (const char* text : {"v 0 0 -1e30\nv 3.40282e38 0 0\nv 0 1 0\nf 1 2 3\n",
                             "v 1e-30 1500 0\nv 0 5 -1e30\nv 3.40282e38 0 0\nf 1 2 3\nf 3 2 1\n",
                             "v 3e38 0 0\nv -3e38 0 0\nv 0 3e38 0\nf 1 2 3\n",
                             "v 3e38 3e38 3e38\nv -3e38 -3e38 -3e38\nv 0 1 0\nf 1 2 3\n"}) {
        write("far.obj", text);
        for (const char* output : {"far.cw2mesh", "far.glb"}) {
            for (const char* positions : {"quantised", "f32"}) {
                const Outcome outcome =
                    bake({"far.obj", "-o", output, "--positions", positions, "--quiet"});
                EXPECT_EQ(outcome.status, 1);
                EXPECT_TRUE(outcome.err.starts_with("cw2-bake: far.obj: its extent, "))
                    << outcome.err;
                EXPECT_FALSE(std::filesystem::exists(here(output)));
            }
        }
    }
}

TEST_F(Limits, ALackOfMemorySaysWhatWasRead) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 3'000'000; ++i) text += "f 1 2 3\n";
    write("many.obj", text);
    const Outcome outcome = run({"/bin/bash", "-c", "ulimit -v 120000; exec \"$0\" \"$@\"",
                                 BAKE_PROGRAM, "many.obj", "--quiet", "--threads", "1"},
                                {{}, folder_.path()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "cw2-bake: many.obj: there is not enough memory for the stage 'read'\n");
}

TEST_F(Limits, HoweverLittleMemoryThereIsTheMessageSaysSo) {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 200'000; ++i)
        text += "v " + std::to_string(i % 251) + " 1 " + std::to_string(i) + "\nf -1 1 2\n";
    write("many.obj", text);
    int lacks = 0;
    for (int megabytes = 60; megabytes < 180; megabytes += 12) {
        const std::string limit = "ulimit -v " + std::to_string(megabytes) + "000;";
        const Outcome outcome = run({"/bin/bash", "-c", limit + "exec \"$0\" \"$@\"", BAKE_PROGRAM,
                                     "many.obj", "-o", "many.cw2mesh", "--quiet", "--threads", "2"},
                                    {{}, folder_.path()});
        EXPECT_LE(outcome.status, 1) << outcome.err;
        if (outcome.status == 0) continue;
        ++lacks;
        EXPECT_TRUE(outcome.err.starts_with("cw2-bake: many.obj: there is not enough memory ") ||
                    outcome.err.starts_with("cw2-bake: pthread_create has failed"))
            << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(here("many.cw2mesh")));
    }
    EXPECT_GT(lacks, 2);
}

TEST_F(Limits, ALackOfMemoryForATextureNamesItsImage) {
    constexpr int kSize = 4000;
    const std::vector<std::byte> texels(std::size_t{3} * kSize * kSize, std::byte{90});
    const auto png = common::encode_png({.width = kSize,
                                         .height = kSize,
                                         .channels = common::PngPicture::Channels::rgb,
                                         .says_srgb = false,
                                         .texels = texels});
    write("big.png", {reinterpret_cast<const char*>(png.data()), png.size()});
    write("m.mtl", "newmtl m\nmap_Kd big.png\n");
    write("one.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    const Outcome outcome = run({"/bin/bash", "-c", "ulimit -v 140000; exec \"$0\" \"$@\"",
                                 BAKE_PROGRAM, "one.obj", "--quiet", "--threads", "1"},
                                {{}, folder_.path()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err,
              "cw2-bake: m.mtl:2: big.png: there is not enough memory to make its texture\n");
}
TEST_F(Limits, AWriteThatFailsLeavesWhatWasThere) {
    bake_well({"scene.obj", "-o", "out.cw2mesh", "--textures", "none", "--quiet"});
    const std::string before = read("out.cw2mesh");
    std::string text;
    for (int i = 0; i < 3000; ++i)
        text += "v " + std::to_string(i) + " 0 0\nv 0 1 0\nv 0 0 1\nf -1 -2 -3\n";
    write("many.obj", text);
    const auto count = [this] {
        return std::distance(std::filesystem::directory_iterator(folder_.path()), {});
    };
    const auto files = count();
    const Outcome outcome = run({"/bin/bash", "-c", "ulimit -f 1; trap '' XFSZ; exec \"$0\" \"$@\"",
                                 BAKE_PROGRAM, "many.obj", "-o", "out.cw2mesh", "--quiet"},
                                {{}, folder_.path()});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.err.starts_with("cw2-bake: out.cw2mesh: cannot be written: "))
        << outcome.err;
    EXPECT_EQ(read("out.cw2mesh"), before);
    EXPECT_EQ(count(), files);
}

}  // namespace
