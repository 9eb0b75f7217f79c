// Both programs as a user meets them: what they print, how they end, what they leave behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder with a small scene in it, where both programs run.
class Cli : public testing::Test {
 protected:
    void SetUp() override {
        write_file(folder_ / "scene.obj", kTriangle);
        const Outcome baked = bake({"scene.obj", "-o", "scene.cw2mesh"});
        ASSERT_EQ(baked.status, 0) << baked.err;
        ASSERT_EQ(baked.err, "");
        write_file(folder_ / "existing.cw2mesh", "what was there");
        write_file(folder_ / "existing.png", "what was there");
        fs::create_directory(folder_ / "folder");
    }

    Outcome bake(const Words& arguments) { return run_here(BAKE_PROGRAM, arguments, {}); }
    Outcome cw2(const Words& arguments, const Words& environment = {}) {
        return run_here(CW2_PROGRAM, arguments, environment);
    }

    /// The program prints one line that begins with its name and holds all of `parts`, ends with
    /// `status`, and changes nothing in the folder.
    void expect_refusal(const std::string& program, int status, const Words& arguments,
                        const Words& parts, const Words& environment = {}) {
        std::string line = program;
        for (const std::string& argument : arguments) line += ' ' + argument;
        SCOPED_TRACE(line);
        const auto before = snapshot();
        const Outcome outcome = program == "cw2" ? cw2(arguments, environment) : bake(arguments);
        EXPECT_EQ(outcome.status, status);
        EXPECT_EQ(outcome.out, "");
        EXPECT_TRUE(outcome.err.starts_with(program + ": ")) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_TRUE(outcome.err.ends_with('\n')) << outcome.err;
        for (const std::string& part : parts) {
            EXPECT_NE(outcome.err.find(part), std::string::npos)
                << outcome.err << " does not hold: " << part;
        }
        EXPECT_TRUE(snapshot() == before) << "the folder has changed";
    }

    fs::path here(const std::string& name) const { return folder_ / name; }

 private:
    Outcome run_here(const std::string& program, const Words& arguments, const Words& environment) {
        Words command{program};
        command.insert(command.end(), arguments.begin(), arguments.end());
        return run(command, {environment, folder_.path()});
    }

    std::map<std::string, std::string> snapshot() const {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
            files[entry.path()] = entry.is_regular_file() ? bytes_of(entry) : "no file";
        }
        return files;
    }

    TemporaryFolder folder_;
};

TEST_F(Cli, HelpAndVersionGoToStandardOutput) {
    for (const std::string option : {"--help", "--version"}) {
        for (const Outcome& outcome : {bake({option}), cw2({option})}) {
            EXPECT_EQ(outcome.status, 0);
            EXPECT_EQ(outcome.err, "");
            EXPECT_NE(outcome.out, "");
            EXPECT_TRUE(outcome.out.ends_with('\n'));
        }
    }
    EXPECT_NE(bake({"--help"}).out.find("--tangent-frame"), std::string::npos);
    EXPECT_NE(cw2({"--help"}).out.find("--camera-position"), std::string::npos);
}

TEST_F(Cli, BakeRefusesWrongUsage) {
    const struct {
        Words arguments;
        Words parts;
    } table[] = {
        {{}, {"INPUT"}},
        {{"scene.obj", "--bogus"}, {"--bogus"}},
        {{"scene.obj", "--strict=maybe"}, {"--strict"}},
        {{"scene.obj", "another.obj"}, {"another.obj"}},
        {{"scene.obj", "-o"}, {"--output"}},
        {{"scene.obj", "--up", "x"}, {"--up", "'x'"}},
        {{"scene.obj", "--tangent-frame", "quat24"}, {"--tangent-frame", "quat24"}},
        {{"scene.obj", "--positions", "f16"}, {"--positions", "f16"}},
        {{"scene.obj", "--textures", "jpeg"}, {"--textures", "jpeg"}},
        {{"scene.obj", "--threads", "0"}, {"--threads", "0"}},
        {{"scene.obj", "--threads", "many"}, {"--threads", "many"}},
        {{"scene.obj", "--json"}, {"--json", "--inspect"}},
        {{"scene.cw2mesh", "-o", "a.glb", "--stats", "a.json"}, {"--stats", "baked"}},
    };
    for (const auto& [arguments, parts] : table) expect_refusal("cw2-bake", 2, arguments, parts);
}

TEST_F(Cli, BakeRefusesWhatIsNoScene) {
    const struct {
        std::string name;
        std::string text;
        Words parts;
    } table[] = {
        {"empty.obj", "", {"empty.obj: "}},
        {"notes.txt", "Dear diary,\ntoday I baked nothing.\n", {"notes.txt"}},
        {"no_faces.obj", "v 0 0 0\nv 1 0 0\n", {"no_faces.obj: ", "face"}},
        {"index.obj", std::string(kTriangle) + "f 1 2 4\n", {"index.obj:5: ", "4"}},
        {"index_zero.obj", std::string(kTriangle) + "f 1 2 0\n", {"index_zero.obj:5: "}},
        {"nan.obj", std::string("v 0 nan 0\n") + kTriangle, {"nan.obj:1: "}},
        {"infinite.obj", std::string("v 0 1e99 0\n") + kTriangle, {"infinite.obj:1: "}},
        {"word.obj", std::string("v 0 zero 0\n") + kTriangle, {"word.obj:1: "}},
        {"short.obj", std::string("v 0 0\n") + kTriangle, {"short.obj:1: "}},
        {"zeros.obj", std::string(1000, '\0'), {"zeros.obj"}},
    };
    for (const auto& [name, text, parts] : table) {
        write_file(here(name), text);
        expect_refusal("cw2-bake", 1, {name, "-o", "existing.cw2mesh"}, parts);
        expect_refusal("cw2-bake", 1, {name, "-o", "new.cw2mesh"}, parts);
    }
    expect_refusal("cw2-bake", 1, {"missing.obj"}, {"missing.obj: ", "No such file"});
    expect_refusal("cw2-bake", 1, {"two\nlines.obj"}, {"two\\x0alines.obj: "});
    expect_refusal("cw2", 1, {"two\nlines.cw2mesh"}, {"two\\x0alines.cw2mesh: "});
    expect_refusal("cw2-bake", 1, {"folder"}, {"folder: ", "directory"});
    expect_refusal("cw2-bake", 1, {"/dev/null"}, {"/dev/null: "});
    expect_refusal("cw2-bake", 1, {"scene.cw2mesh", "-o", "existing.cw2mesh"}, {"scene.cw2mesh"});
}

TEST_F(Cli, StrictBakeRefusesWhatWouldBeAWarning) {
    write_file(here("warned.obj"), std::string("mtllib gone.mtl\n") + kTriangle);
    const Outcome lenient = bake({"warned.obj", "-o", "lenient.cw2mesh"});
    EXPECT_EQ(lenient.status, 0);
    EXPECT_TRUE(lenient.err.starts_with("cw2-bake: warning: ")) << lenient.err;
    EXPECT_NE(lenient.err.find("gone.mtl"), std::string::npos) << lenient.err;
    EXPECT_EQ(bake({"warned.obj", "-o", "lenient.cw2mesh", "--quiet"}).err, "");
    expect_refusal("cw2-bake", 1, {"warned.obj", "--strict"}, {"warned.obj:1: ", "gone.mtl"});

    write_file(here("textured.mtl"), "newmtl m\nmap_Kd gone.png\n");
    write_file(here("textured.obj"), std::string("mtllib textured.mtl\nusemtl m\n") + kTriangle);
    expect_refusal("cw2-bake", 1, {"textured.obj", "--strict"}, {"textured.mtl:2: ", "gone.png"});

    write_file(here("index_uv.obj"), std::string(kTriangle) + "\nf 1/1 2/1 3/1\n");
    EXPECT_EQ(bake({"index_uv.obj", "-o", "lenient.cw2mesh", "--quiet"}).status, 0);
    expect_refusal("cw2-bake", 1, {"index_uv.obj", "--strict"}, {"index_uv.obj:6: ", "missing"});
}

TEST_F(Cli, OutputsThatCannotBeWrittenAreRefused) {
    for (const std::string output : {"nowhere/out", "folder/missing/out", "/proc/out"}) {
        expect_refusal("cw2-bake", 1, {"scene.obj", "-o", output + ".cw2mesh"},
                       {output + ".cw2mesh: "});
        for (const std::string extension : {".png", ".exr"}) {
            expect_refusal("cw2", 1, {"scene.cw2mesh", "--output", output + extension},
                           {output + extension + ": "});
        }
    }
    // No picture without the statistics that were asked for.
    expect_refusal("cw2", 1,
                   {"scene.cw2mesh", "--output", "existing.png", "--stats", "nowhere/s.json"},
                   {"nowhere/s.json: "});
    for (const std::string other : {"scene.cw2mesh", "./scene.cw2mesh", "existing.png"}) {
        expect_refusal("cw2", 2, {"scene.cw2mesh", "--output", "existing.png", "--stats", other},
                       {"--stats", fs::path(other).filename()});
    }
    expect_refusal("cw2", 1, {"scene.cw2mesh", "--output", "nowhere/%d.png", "--frames", "3"},
                   {"nowhere/0.png: "});
    fs::create_directory(here("folder.png"));
    expect_refusal("cw2-bake", 1, {"scene.obj", "-o", "folder"}, {"folder: ", "directory"});
    expect_refusal("cw2", 1, {"scene.cw2mesh", "--output", "folder.png"},
                   {"folder.png: ", "directory"});
    // Told before a picture is drawn: there is none of the first frames.
    fs::create_directory(here("frames0"));
    expect_refusal("cw2", 1, {"scene.cw2mesh", "--output", "frames%d/a.png", "--frames", "2"},
                   {"frames1/a.png: "});
    EXPECT_TRUE(fs::is_empty(here("frames0")));
    // Not even a scene is looked at.
    for (const std::string name : {"out.jpg", "out", "existing.cw2mesh"}) {
        expect_refusal("cw2", 2, {"missing.cw2mesh", "--output", name},
                       {'\'' + name + '\'', ".png", ".exr"});
    }
}

TEST_F(Cli, Cw2RefusesWrongUsage) {
    const struct {
        Words arguments;
        Words parts;
    } table[] = {
        {{}, {"scene"}},
        {{"--bogus"}, {"--bogus"}},
        {{"--view", "sideways"}, {"--view", "sideways", "--list-views"}},
        {{"--view"}, {"--view"}},
        {{"--camera-position", "1,2"}, {"--camera-position", "1,2"}},
        {{"--camera-position", "1,2,3,4"}, {"--camera-position", "1,2,3,4"}},
        {{"--camera-target", "1,2,z"}, {"--camera-target", "1,2,z"}},
        {{"--light-position", "nan,0,0"}, {"--light-position", "nan,0,0"}},
        {{"--light-color", "1,,1"}, {"--light-color", "1,,1"}},
        {{"--background", ""}, {"--background"}},
        {{"--ambient", "1e999,0,0"}, {"--ambient"}},
        {{"--camera-position", "1,2,3", "--camera-target", "1,2,3"}, {"camera"}},
        {{"--size", "640"}, {"--size", "640"}},
        {{"--size", "0x10"}, {"--size", "0x10"}},
        {{"--size", "640x480x2"}, {"--size"}},
        {{"--size", "-640x480"}, {"--size"}},
        {{"--fov", "0"}, {"--fov", "0"}},
        {{"--fov", "180"}, {"--fov", "180"}},
        {{"--roughness", "1.5"}, {"--roughness", "1.5"}},
        {{"--metalness", "nan"}, {"--metalness", "nan"}},
        {{"--normal-strength", "-1"}, {"--normal-strength", "-1"}},
        {{"--time", "noon"}, {"--time", "noon"}},
        {{"--samples", "2"}, {"--samples", "2"}},
        {{"--samples", "1024"}, {"--samples", "1024"}},
        {{"--background", "nothing"}, {"--background", "nothing"}},
        {{"--encoding", "log"}, {"--encoding", "'log'"}},
        {{"--encoding", "linear", "--false-color", "auto"}, {"--encoding", "--false-color"}},
        {{"--pixel", "3"}, {"--pixel", "'3'"}},
        {{"--pixel", "1280,0"}, {"--pixel", "1280,0"}},
        {{"--anisotropy", "99"}, {"--anisotropy", "99"}},
        {{"--bench", "-1"}, {"--bench", "-1"}},
        {{"--bench", "0"}, {"--bench", "'0'", "1.."}},
        {{"--exposure", "bright"}, {"--exposure", "bright"}},
        {{"--exposure", "65"}, {"--exposure", "65"}},
        {{"--false-color", "1,1"}, {"--false-color", "1,1"}},
        {{"--false-color", "1"}, {"--false-color", "'1'"}},
        {{"--false-color", "0,nan"}, {"--false-color", "0,nan"}},
        {{"--split", "normal"}, {"--split", "'normal'"}},
        {{"--split", "normal,sideways"}, {"--split", "normal,sideways"}},
        {{"--split", "normal,shaded,uv"}, {"--split"}},
        {{"--split", "normal:no-camera,shaded"}, {"--split", "no-camera"}},
        {{"--divider", "1.5"}, {"--divider", "1.5"}},
        {{"--frames", "0"}, {"--frames", "'0'"}},
        {{"--frames", "5..3/8"}, {"--frames", "5..3/8"}},
        {{"--frames", "3..8/8"}, {"--frames", "3..8/8"}},
        {{"--frames", "1..2"}, {"--frames", "1..2"}},
        {{"--frames", "-1"}, {"--frames", "-1"}},
        {{"--frames", "8"}, {"--output", "existing.png", "%04d"}},
        {{"--frames", "1", "--bench", "2"}, {"--frames", "--bench"}},
        {{"--frames", "1", "--orbit", "moon"}, {"--orbit", "moon"}},
        {{"--orbit", "light"}, {"--orbit", "--frames"}},
        {{"another.cw2mesh"}, {"another.cw2mesh"}},
        {{"--no-normal-map=maybe"}, {"true or false"}},
    };
    for (const auto& [options, parts] : table) {
        Words arguments{"--output", "existing.png"};
        if (!options.empty()) arguments.push_back("scene.cw2mesh");
        arguments.insert(arguments.end(), options.begin(), options.end());
        expect_refusal("cw2", 2, arguments, parts);
    }
    expect_refusal("cw2", 2, {"scene.cw2mesh", "--stats", "a.json"}, {"--output", "--bench"});
    expect_refusal("cw2", 2, {"scene.cw2mesh", "--frames", "3"}, {"--output"});
}

TEST_F(Cli, AConfigFileStandsForItsOptions) {
    write_file(here("shot.toml"),
               "scene = 'scene.cw2mesh'\nsize = '32x24'\nview = 'normal'\n"
               "camera-position = [0.5, 1, 2]\noutput = 'from_config.png'\n");
    EXPECT_EQ(cw2({"--config", "shot.toml"}).err, "");
    EXPECT_EQ(cw2({"scene.cw2mesh", "--size", "32x24", "--view", "normal", "--camera-position",
                   "0.5,1,2", "--output", "from_options.PNG"})
                  .err,
              "");
    EXPECT_TRUE(bytes_of(here("from_config.png")).starts_with("\x89PNG"));
    EXPECT_TRUE(bytes_of(here("from_config.png")) == bytes_of(here("from_options.PNG")));

    const Words with_config{"scene.cw2mesh", "--output", "new.png", "--config", "bad.toml"};
    write_file(here("bad.toml"), "ambient = [0, 0, 0]\nambiance = [0, 0, 0]\n");
    expect_refusal("cw2", 2, with_config, {"bad.toml:2: ", "'ambiance'"});
    write_file(here("bad.toml"), "\nsamples = 3\n");
    expect_refusal("cw2", 2, with_config, {"bad.toml:2: samples: ", "'3'"});
    expect_refusal("cw2", 1, {"scene.cw2mesh", "--output", "new.png", "--config", "gone.toml"},
                   {"gone.toml: ", "No such file"});
}

TEST_F(Cli, FramesAreTheSameHoweverTheyAreSpreadOverProcesses) {
    ASSERT_EQ(run({MAKE_TEST_SCENES_PROGRAM, here("scenes")}).status, 0);
    ASSERT_EQ(bake({"scenes/stage.obj", "-o", "stage.cw2mesh", "--quiet"}).status, 0);
    for (const std::string orbit : {"camera", "light"}) {
        fs::create_directories(here("whole"));
        fs::create_directories(here("parts"));
        const auto draw = [&](const std::string& frames, const std::string& folder) {
            const Outcome outcome = cw2({"stage.cw2mesh", "--size", "96x64", "--orbit", orbit,
                                         "--frames", frames, "--output", folder + "/a_%02d.png"});
            EXPECT_EQ(outcome.status, 0);
            EXPECT_EQ(outcome.err, "");
            EXPECT_TRUE(outcome.out.ends_with(" a second\n")) << outcome.out;
        };
        draw("7", "whole");
        for (const std::string part : {"0..2/7", "3..3/7", "4..6/7"}) draw(part, "parts");
        EXPECT_EQ(std::distance(fs::directory_iterator(here("whole")), {}), 7);
        EXPECT_EQ(std::distance(fs::directory_iterator(here("parts")), {}), 7);
        std::string last;
        for (int frame = 0; frame < 7; ++frame) {
            const std::string name = "/a_0" + std::to_string(frame) + ".png";
            const std::string bytes = bytes_of(here("whole" + name));
            EXPECT_TRUE(bytes.starts_with("\x89PNG")) << name;
            EXPECT_TRUE(bytes == bytes_of(here("parts" + name))) << name;
            EXPECT_FALSE(bytes == last) << name;
            last = bytes;
        }
        fs::remove_all(here("whole"));
        fs::remove_all(here("parts"));
    }
}

TEST_F(Cli, ValuesMayStartWithAMinus) {
    const Outcome outcome =
        cw2({"scene.cw2mesh", "--output", "minus.png", "--size", "16x16", "--camera-position",
             "-7.5,1.6,-0.3", "--camera-target", "-2,-1,-0", "--light-position", "-0,-4,-0.5"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(fs::exists(here("minus.png")));
}

TEST_F(Cli, DamagedScenesAreRefused) {
    const std::string whole = bytes_of(here("scene.cw2mesh"));
    for (const std::size_t size :
         {std::size_t{0}, std::size_t{5}, std::size_t{100}, std::size_t{600}, whole.size() - 1}) {
        write_file(here("truncated.cw2mesh"), whole.substr(0, size));
        expect_refusal("cw2", 1, {"truncated.cw2mesh", "--output", "existing.png"},
                       {"truncated.cw2mesh: "});
        expect_refusal("cw2-bake", 1, {"--inspect", "truncated.cw2mesh"}, {"truncated.cw2mesh: "});
    }
    for (const std::size_t at :
         {std::size_t{0}, std::size_t{20}, std::size_t{40}, whole.size() - 1}) {
        std::string altered = whole;
        altered[at] = static_cast<char>(altered[at] + 1);
        write_file(here("altered.cw2mesh"), altered);
        expect_refusal("cw2", 1, {"altered.cw2mesh", "--output", "new.png"}, {"altered.cw2mesh: "});
    }
    std::string future = whole;
    future[8] = 99;
    write_file(here("future.cw2mesh"), future);
    expect_refusal("cw2", 1, {"future.cw2mesh", "--output", "new.png"},
                   {"future.cw2mesh: ", "version 99", "bake again"});
}

TEST_F(Cli, WhatIsNoSceneIsRefused) {
    write_file(here("notes.txt"), "Dear diary,\n");
    const Words output{"--output", "existing.png"};
    const auto refuse = [&](const std::string& name, const Words& parts) {
        expect_refusal("cw2", 1, {name, "--output", "existing.png"}, parts);
    };
    refuse("missing.cw2mesh", {"missing.cw2mesh: ", "No such file"});
    refuse("folder", {"folder: ", "directory"});
    refuse("notes.txt", {"notes.txt: "});
    refuse("existing.png", {"existing.png: "});
    refuse("/dev/null", {"/dev/null: "});
    // With no display, either: what is wrong with the scene comes first.
    expect_refusal("cw2", 1, {"missing.cw2mesh"}, {"missing.cw2mesh: "}, {"DISPLAY="});
}

TEST_F(Cli, MissingDevicesAreRefused) {
    const Words draw{"scene.cw2mesh", "--output", "existing.png"};
    const auto with = [&](const Words& options) {
        Words arguments = draw;
        arguments.insert(arguments.end(), options.begin(), options.end());
        return arguments;
    };
    expect_refusal("cw2", 1, draw, {"Vulkan"}, {"VK_DRIVER_FILES=/nonexistent.json"});
    expect_refusal("cw2", 1, {"--list-devices"}, {"Vulkan"}, {"VK_DRIVER_FILES=/nonexistent.json"});
    expect_refusal("cw2", 1, with({"--device", "99"}), {"99", "--list-devices"});
    expect_refusal("cw2", 1, with({"--device", "abacus"}), {"abacus", "--list-devices"});
    expect_refusal("cw2", 1, with({"--size", "100000x100000"}), {"--size"});
    expect_refusal("cw2", 1, with({"--validation"}), {"--validation"},
                   {"VK_LAYER_PATH=/nonexistent"});
    expect_refusal("cw2", 1, {"scene.cw2mesh"}, {"display"}, {"DISPLAY=", "WAYLAND_DISPLAY="});
}

TEST_F(Cli, ListsAndInspectionsGoToStandardOutput) {
    for (const Outcome& outcome :
         {cw2({"--list-views"}), cw2({"--list-devices"}), bake({"--inspect", "scene.cw2mesh"}),
          bake({"--inspect", "--json", "scene.cw2mesh"})}) {
        EXPECT_EQ(outcome.status, 0);
        EXPECT_EQ(outcome.err, "");
        EXPECT_TRUE(outcome.out.ends_with('\n')) << outcome.out;
    }
    EXPECT_NE(cw2({"--list-devices"}).out.find("llvmpipe"), std::string::npos);
    EXPECT_NE(cw2({"--list-views"}).out.find("light-direction"), std::string::npos);
}

TEST_F(Cli, BakesAreTheSameForAnyNumberOfThreads) {
    ASSERT_EQ(run({MAKE_TEST_SCENES_PROGRAM, here("scenes")}).status, 0);
    const auto baked = [&](const std::string& threads, const Words& options) {
        Words arguments{"scenes/stage.obj", "-o", "stage.cw2mesh", "--quiet", "--threads", threads};
        arguments.insert(arguments.end(), options.begin(), options.end());
        fs::remove(here("stage.cw2mesh"));  // or its textures would be used again
        const Outcome outcome = bake(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return bytes_of(here("stage.cw2mesh"));
    };
    for (const Words& options : {Words{}, Words{"--compress"}}) {
        const std::string bytes = baked("1", options);
        EXPECT_GT(bytes.size(), 10'000u);
        for (const std::string threads : {"1", "2", "5"}) {
            EXPECT_TRUE(baked(threads, options) == bytes) << threads;
        }
    }
}

TEST_F(Cli, PicturesAreTheSameForAnyNumberOfThreadsAndContentsOfMemory) {
    ASSERT_EQ(run({MAKE_TEST_SCENES_PROGRAM, here("scenes")}).status, 0);
    ASSERT_EQ(bake({"scenes/stage.obj", "-o", "stage.cw2mesh", "--quiet"}).status, 0);
    for (const std::string output : {"stage.png", "stage.exr"}) {
        const auto drawn = [&](const Words& environment) {
            const Outcome outcome =
                cw2({"stage.cw2mesh", "--output", output, "--size", "320x180"}, environment);
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            return bytes_of(here(output));
        };
        const std::string bytes = drawn({});
        EXPECT_GT(bytes.size(), 10'000u);
        EXPECT_TRUE(drawn({}) == bytes);
        // glibc fills what malloc hands out with the complement of MALLOC_PERTURB_.
        for (const Words& environment :
             {Words{"LP_NUM_THREADS=0", "MALLOC_PERTURB_=85"},
              Words{"LP_NUM_THREADS=1", "MALLOC_PERTURB_=170"}, Words{"LP_NUM_THREADS=3"}}) {
            EXPECT_TRUE(drawn(environment) == bytes) << output << ' ' << environment.front();
        }
    }
}

TEST_F(Cli, FinishedFilesTakeTheirTargetsPlaceAndLeaveNothingElse) {
    EXPECT_EQ(bake({"scene.obj", "-o", "existing.cw2mesh"}).status, 0);
    EXPECT_EQ(bytes_of(here("existing.cw2mesh")), bytes_of(here("scene.cw2mesh")));
    EXPECT_EQ(cw2({"scene.cw2mesh", "--output", "existing.png", "--size", "16x16"}).status, 0);
    EXPECT_TRUE(bytes_of(here("existing.png")).starts_with("\x89PNG"));
    // scene.obj, scene.cw2mesh, existing.cw2mesh, existing.png, folder
    EXPECT_EQ(std::distance(fs::directory_iterator(here("")), {}), 5);
}

}  // namespace
