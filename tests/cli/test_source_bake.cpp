// cw2 draws an OBJ or a glTF: it bakes them into the user's cache, once.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <future>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/scene_folder.h"
#include "tests/support/wait_until.h"

namespace {

namespace fs = std::filesystem;

class SourceBake : public SceneFolder {
 protected:
    void SetUp() override {
        SceneFolder::SetUp();
        fs::create_directory(here("temporary"));
    }

    Outcome draw(const std::string& scene, const std::string& picture,
                 std::vector<std::string> options = {}, const std::string& program = CW2_PROGRAM) {
        options.insert(options.begin(),
                       {program, scene, "--output", picture, "--size", "96x64", "--samples", "1"});
        return run(options, {{"XDG_CACHE_HOME=" + cache_, "TMPDIR=" + here("temporary").string()},
                             folder_.path()});
    }
    void draw_well(const std::string& scene, const std::string& picture) {
        const Outcome outcome = draw(scene, picture);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
    }
    /// The inodes of what is baked in the cache.
    std::map<fs::path, ino_t> entries() const {
        std::map<fs::path, ino_t> found;
        for (const auto& file : fs::directory_iterator(fs::path(cache_) / "cw2")) {
            struct stat status {};
            if (file.path().extension() == ".cw2mesh" && ::stat(file.path().c_str(), &status) == 0)
                found[file.path()] = status.st_ino;
        }
        return found;
    }
    std::string cache_ = here("cache").string();
};

TEST_F(SourceBake, IsMadeOnceAndDrawsWhatABakeByHandDraws) {
    draw_well("scene.obj", "first.png");
    const auto first = entries();
    EXPECT_EQ(first.size(), 1u);
    draw_well("scene.obj", "again.png");
    EXPECT_EQ(entries(), first);
    EXPECT_EQ(read("again.png"), read("first.png"));
    bake_well({"scene.obj", "--textures", "lossless"});
    draw_well("scene.cw2mesh", "by_hand.png");
    EXPECT_EQ(read("by_hand.png"), read("first.png"));
    EXPECT_FALSE(fs::exists(here("scene.obj.cw2mesh")));

    bake_well({"scene.obj", "-o", "scene.glb"});
    draw_well("scene.glb", "gltf.png");
    EXPECT_EQ(entries().size(), 2u);
}

TEST_F(SourceBake, IsMadeAnewWhenAnythingItReadHasChanged) {
    draw_well("scene.obj", "before.png");
    const auto before = entries();
    write("scene.mtl", read("scene.mtl") + "newmtl unused\nKd 1 0 0\n");
    draw_well("scene.obj", "unused.png");
    EXPECT_NE(entries(), before);
    EXPECT_EQ(read("unused.png"), read("before.png"));
    write_picture(here("colors.png"), painted(16, 16, 3, [](int, int) {
                      return std::vector{1.0, 0.0, 0.0};
                  }));
    draw_well("scene.obj", "red.png");
    EXPECT_NE(read("red.png"), read("before.png"));
    EXPECT_EQ(entries().size(), 1u);
}

TEST_F(SourceBake, WarnsAgainUntilWhatIsMissingIsThere) {
    fs::rename(here("mask.png"), here("away.png"));
    const Outcome first = draw("scene.obj", "a.png");
    EXPECT_EQ(first.status, 0);
    EXPECT_NE(first.err.find("cw2-bake: warning: "), std::string::npos) << first.err;
    EXPECT_NE(first.err.find("mask.png"), std::string::npos) << first.err;
    EXPECT_EQ(first.err.find(folder_.path()), std::string::npos) << first.err;
    const auto before = entries();
    const Outcome again = draw("scene.obj", "a.png");
    EXPECT_EQ(again.err, first.err);
    EXPECT_EQ(entries(), before);
    fs::rename(here("away.png"), here("mask.png"));
    draw_well("scene.obj", "b.png");
    EXPECT_NE(read("b.png"), read("a.png"));
}

TEST_F(SourceBake, PassesOptionsOnAndErrorsBack) {
    draw_well("scene.obj", "y.png");
    EXPECT_EQ(draw("scene.obj", "z.png", {"--up", "z"}).status, 0);
    EXPECT_NE(read("y.png"), read("z.png"));
    EXPECT_EQ(entries().size(), 2u);

    const TemporaryFolder elsewhere;
    fs::rename(here("colors.png"), elsewhere / "colors.png");
    fs::create_symlink(elsewhere / "colors.png", here("colors.png"));
    EXPECT_EQ(draw("scene.obj", "z.png").err, "");
    const Outcome restricted = draw("scene.obj", "z.png", {"--restrict"});
    EXPECT_NE(restricted.err.find("colors.png: is outside the scene's folder\n"), std::string::npos)
        << restricted.err;

    fs::remove(here("mask.png"));
    const Outcome strict = draw("scene.obj", "strict.png", {"--strict"});
    EXPECT_EQ(strict.status, 1);
    EXPECT_TRUE(strict.err.starts_with("cw2: ")) << strict.err;
    EXPECT_NE(strict.err.find("scene.mtl:9: "), std::string::npos) << strict.err;
    EXPECT_FALSE(fs::exists(here("strict.png")));

    write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    const Outcome broken = draw("broken.obj", "broken.png");
    EXPECT_EQ(broken.status, 1);
    EXPECT_TRUE(broken.err.starts_with("cw2: broken.obj:2: ")) << broken.err;
    // As it was given, whatever the name's form.
    const Outcome absolute = draw(here("broken.obj"), "broken.png");
    EXPECT_TRUE(absolute.err.starts_with("cw2: " + here("broken.obj").string() + ":2: "))
        << absolute.err;
    const Outcome upward = draw("temporary/../broken.obj", "broken.png");
    EXPECT_TRUE(upward.err.starts_with("cw2: temporary/../broken.obj:2: ")) << upward.err;

    bake_well({"scene.obj", "--textures", "none"});
    EXPECT_EQ(draw("scene.cw2mesh", "a.png", {"--up", "z"}).status, 2);
    EXPECT_EQ(draw("missing.obj", "a.png").status, 1);
}

TEST_F(SourceBake, DoesWithoutACacheAndLeavesNothing) {
    for (const char* place : {"/proc/none", "relative"}) {
        cache_ = place;
        const Outcome outcome =
            run({CW2_PROGRAM, "scene.obj", "--output", "a.png", "--size", "96x64"},
                {{"XDG_CACHE_HOME=" + cache_, "HOME=/proc/none", "MESA_SHADER_CACHE_DISABLE=true",
                  "TMPDIR=" + here("temporary").string()},
                 folder_.path()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        EXPECT_TRUE(fs::is_empty(here("temporary")));
    }
}

TEST_F(SourceBake, TakesNamesThatMakeCannot) {
    for (const char* name : {"it's; a #1 $cene: 100%.obj", "a b\\c.obj"}) {
        write(name, read("scene.obj"));
        draw_well(name, "odd.png");
        draw_well(name, "odd.png");
        draw_well("scene.obj", "plain.png");
        EXPECT_EQ(read("odd.png"), read("plain.png")) << name;
    }
}

TEST_F(SourceBake, RunsAtTheSameTimeShareOneEntry) {
    std::vector<std::future<Outcome>> runs;
    for (int i = 0; i < 4; ++i) {
        runs.push_back(std::async(std::launch::async, [this, i] {
            return draw("scene.obj", "p" + std::to_string(i) + ".png");
        }));
    }
    for (auto& each : runs) {
        const Outcome outcome = each.get();
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
    }
    for (int i = 1; i < 4; ++i) EXPECT_EQ(read("p" + std::to_string(i) + ".png"), read("p0.png"));
    EXPECT_EQ(entries().size(), 1u);
}

TEST_F(SourceBake, TheOldestEntriesGoAboveTwoGigabytes) {
    draw_well("scene.obj", "a.png");
    const fs::path folder = fs::path(cache_) / "cw2";
    for (const auto& [name, hours] : {std::pair<std::string, int>{"old", 1}, {"older", 2}}) {
        for (const char* extension : {".cw2mesh", ".lock", ".notes"})
            std::ofstream(folder / (name + extension)) << "x";
        const fs::path baked = folder / (name + ".cw2mesh");
        fs::resize_file(baked, std::uintmax_t{1200} << 20);
        fs::last_write_time(baked, fs::file_time_type::clock::now() - std::chrono::hours(hours));
    }
    bake_well({"scene.obj", "-o", "scene.glb"});
    draw_well("scene.glb", "a.png");
    EXPECT_TRUE(fs::exists(folder / "old.cw2mesh"));
    EXPECT_FALSE(fs::exists(folder / "older.cw2mesh"));
    EXPECT_FALSE(fs::exists(folder / "older.notes"));
    EXPECT_EQ(entries().size(), 3u);
}

TEST_F(SourceBake, SignalsLeaveNoTemporaryBake) {
    std::string text = read("scene.obj");
    for (int i = 0; i < 300'000; ++i) text += "v 0.5 0.25 " + std::to_string(i) + "\nf -1 1 2\n";
    write("large.obj", text);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        Running running({CW2_PROGRAM, "large.obj", "--output", "a.png", "--size", "96x64"},
                        {{"XDG_CACHE_HOME=/proc/none", "MESA_SHADER_CACHE_DISABLE=true",
                          "TMPDIR=" + here("temporary").string()},
                         folder_.path()});
        ASSERT_TRUE(wait_until([&] { return !fs::is_empty(here("temporary")); }));
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        ASSERT_EQ(::kill(running.process(), signal), 0);
        EXPECT_EQ(running.wait().status, 128 + signal);
        EXPECT_TRUE(fs::is_empty(here("temporary")));
    }
    EXPECT_FALSE(fs::exists(here("a.png")));
}

TEST_F(SourceBake, WhatAKilledBakeLeavesInTheCacheGoes) {
    const fs::path folder = fs::path(cache_) / "cw2";
    fs::create_directories(folder);
    write("cache/cw2/0123456789abcdef.cw2mesh.cw2-tmp-x1y2z3", "half a bake");
    draw_well("scene.obj", "a.png");
    EXPECT_FALSE(fs::exists(folder / "0123456789abcdef.cw2mesh.cw2-tmp-x1y2z3"));
}

TEST_F(SourceBake, WarningsStandInLinesOfTheirOwn) {
    std::string noise(std::size_t{3} * 2048 * 2048, '\0');
    std::uint32_t random = 1;
    for (char& c : noise) c = static_cast<char>((random = random * 1664525u + 1013904223u) >> 24);
    write("noise.ppm", "P6 2048 2048 255\n" + noise);
    write("noise.mtl",
          "newmtl m\nmap_Kd noise.ppm\nmap_Pr noise.ppm\nmap_Ke noise.ppm\n"
          "map_d gone.png\n");
    write("noise.obj", "mtllib noise.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    const std::string bake = std::string(BAKE_PROGRAM) + " noise.obj --threads 1 -o n.cw2mesh";
    const std::string shown =
        run({"/usr/bin/script", "-qec", bake, "/dev/null"}, {{}, folder_.path()}).out;
    const std::size_t at = shown.find("cw2-bake: warning: ");
    ASSERT_NE(at, std::string::npos) << shown;
    const std::string before = shown.substr(0, at);
    // A fast machine has shown no bar yet; ProgressBar's own test waits for none.
    EXPECT_TRUE(before.empty() || before.ends_with("\r\033[K")) << shown;
}

TEST_F(SourceBake, AMissingBakerIsNamed) {
    fs::create_directory(here("bin"));
    fs::copy_file(CW2_PROGRAM, here("bin/cw2"));
    const Outcome outcome = draw("scene.obj", "a.png", {}, here("bin/cw2").string());
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find(here("bin/cw2-bake").string()), std::string::npos) << outcome.err;
}

}  // namespace
