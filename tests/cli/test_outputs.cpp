// What an output may be, and what is left of it when a program is ended.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <future>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/scene_folder.h"
#include "tests/support/wait_until.h"

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

class Outputs : public SceneFolder {
 protected:
    void SetUp() override {
        SceneFolder::SetUp();
        bake_well({"scene.obj", "-o", "scene.cw2mesh", "--quiet"});
    }

    /// With a shell's redirections and limits before it.
    Outcome in_shell(const std::string& before, const Words& command, const std::string& after) {
        Words words{"/bin/bash", "-c", before + " exec \"$@\" " + after, "bash"};
        words.insert(words.end(), command.begin(), command.end());
        return run(words, {{}, folder_.path()});
    }
    Words names() const {
        Words names;
        for (const auto& file : fs::directory_iterator(folder_.path()))
            names.push_back(file.path().filename());
        std::ranges::sort(names);
        return names;
    }
    mode_t mode(const std::string& name) const {
        struct stat status {};
        return ::lstat(here(name).c_str(), &status) == 0 ? status.st_mode : 0;
    }
    void expect_refusal(const std::string& output, const std::string& why) {
        const auto before = names();
        const mode_t mode_before = mode(output);
        const Outcome outcome = bake({"scene.obj", "-o", output});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.err, "cw2-bake: " + output + ": " + why + '\n');
        EXPECT_EQ(names(), before);
        EXPECT_EQ(mode(output), mode_before);
    }
};

TEST_F(Outputs, FifosAndDevicesAreWrittenAsTheyAre) {
    ASSERT_EQ(::mkfifo(here("fifo").c_str(), 0600), 0);
    auto reader = std::async(std::launch::async, [this] { return read("fifo"); });
    bake_well({"scene.obj", "-o", "fifo", "--quiet"});
    EXPECT_EQ(reader.get(), read("scene.cw2mesh"));
    EXPECT_TRUE(S_ISFIFO(mode("fifo")));
    const auto before = names();
    const Outcome piped =
        in_shell("", {BAKE_PROGRAM, "scene.obj", "-o", "/proc/self/fd/1", "--quiet"},
                 "| cmp - scene.cw2mesh");
    EXPECT_EQ(piped.status, 0) << piped.out << piped.err;
    EXPECT_EQ(names(), before);

    constexpr int kMemory = 1, kNull = 3, kFull = 7;  // of Linux' list of devices
    if (::mknod(here("null").c_str(), S_IFCHR | 0600, makedev(kMemory, kNull)) != 0 ||
        ::open(here("null").c_str(), O_WRONLY | O_CLOEXEC) < 0)
        GTEST_SKIP() << "only root makes devices";
    bake_well({"scene.obj", "-o", "null", "--stats", "stats.json", "--quiet"});
    EXPECT_TRUE(S_ISCHR(mode("null")));
    ASSERT_EQ(::mknod(here("full").c_str(), S_IFCHR | 0600, makedev(kMemory, kFull)), 0);
    expect_refusal("full", "cannot be written: No space left on device");
    ASSERT_EQ(::mknod(here("block").c_str(), S_IFBLK | 0600, makedev(7, 200)), 0);
    expect_refusal("block", "is a block device");
}

TEST_F(Outputs, FoldersAndSocketsAreRefused) {
    fs::create_directory(here("folder"));
    expect_refusal("folder", "is a directory");
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
    ASSERT_LT(here("socket").native().size(), sizeof address.sun_path);
    std::strcpy(address.sun_path, here("socket").c_str());
    ASSERT_EQ(::bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    expect_refusal("socket", "is a socket");
    ::close(socket);
}

/// A bake reads, and warns, before it writes.
TEST_F(Outputs, WhatCannotBeWrittenIsFoundBeforeTheWorkBegins) {
    write("warns.obj", "usemtl missing\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    ASSERT_NE(bake({"warns.obj", "-o", "warns.cw2mesh"}).err, "");
    const Words all{"out.cw2mesh", "depfile", "stats.json"};
    const auto before = names();
    for (const std::string& lost : all) {
        const auto name = [&](const std::string& file) {
            return file == lost ? "nowhere/" + file : file;
        };
        const Outcome outcome = bake(
            {"warns.obj", "-o", name(all[0]), "--depfile", name(all[1]), "--stats", name(all[2])});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.err,
                  "cw2-bake: nowhere/" + lost + ": cannot be written: No such file or directory\n");
        EXPECT_EQ(names(), before);
    }
    const Outcome exported =
        bake({"scene.cw2mesh", "-o", "out.glb", "--depfile", "nowhere/depfile"});
    EXPECT_EQ(exported.err,
              "cw2-bake: nowhere/depfile: cannot be written: No such file or directory\n");
    EXPECT_EQ(names(), before);
    // Where the output's folder is missing since the input's name is wrong, that is said.
    EXPECT_EQ(bake({"nowhere/scene.obj"}).err,
              "cw2-bake: nowhere/scene.obj: cannot be opened: No such file or directory\n");
}

TEST_F(Outputs, OfALinkItsTargetIsReplaced) {
    fs::create_directory(here("folder"));
    write("folder/old", "old");
    for (const char* name : {"old", "new"}) {
        fs::create_symlink("folder/" + std::string(name), here(name));
        bake_well({"scene.obj", "-o", name, "--quiet"});
        EXPECT_TRUE(S_ISLNK(mode(name)));
        EXPECT_EQ(read("folder/" + std::string(name)), read("scene.cw2mesh"));
    }
    fs::create_symlink("b", here("a"));
    fs::create_symlink("a", here("b"));
    EXPECT_EQ(bake({"scene.obj", "-o", "a"}).status, 1);
    // What is an input stays one behind a link.
    fs::create_symlink("scene.mtl", here("link"));
    EXPECT_EQ(bake({"scene.obj", "-o", "link"}).status, 1);
}

TEST_F(Outputs, ModeAndOwnerOfWhatWasThereAreKept) {
    constexpr uid_t kUser = 54321;
    constexpr gid_t kGroup = 12345;
    write("old", "old");
    const bool owned = ::chown(here("old").c_str(), kUser, kGroup) == 0;
    ASSERT_EQ(::chmod(here("old").c_str(), 0640), 0);
    const Outcome outcome = in_shell("umask 027;",
                                     {BAKE_PROGRAM, "scene.obj", "-o", "old", "--stats", "new.json",
                                      "--depfile", "new.d", "--quiet"},
                                     "");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    struct stat status {};
    ASSERT_EQ(::stat(here("old").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0640u);
    if (owned) {
        EXPECT_EQ(status.st_uid, kUser);
        EXPECT_EQ(status.st_gid, kGroup);
    }
    EXPECT_EQ(mode("new.json") & 07777, 0640u);
    EXPECT_EQ(mode("new.d") & 07777, 0640u);
}

TEST_F(Outputs, StandardOutputThatIsFullIsAnError) {
    const Words commands[] = {{BAKE_PROGRAM, "--inspect", "scene.cw2mesh"},
                              {BAKE_PROGRAM, "--inspect", "--json", "scene.cw2mesh"},
                              {BAKE_PROGRAM, "scene.obj", "-o", "again.cw2mesh"},
                              {BAKE_PROGRAM, "--help"},
                              {CW2_PROGRAM, "--list-views"},
                              {CW2_PROGRAM, "--list-devices"},
                              {CW2_PROGRAM, "--version"},
                              {CW2_PROGRAM, "scene.cw2mesh", "--size", "16x16", "--pixel", "3,4"}};
    for (const Words& command : commands) {
        const Outcome outcome = in_shell("", command, ">/dev/full");
        EXPECT_EQ(outcome.status, 1);
        EXPECT_NE(
            outcome.err.find(": standard output: cannot be written: No space left on device\n"),
            std::string::npos)
            << outcome.err;
    }
    // Nothing gets into the place of what is closed.
    EXPECT_EQ(
        in_shell("", {BAKE_PROGRAM, "scene.obj", "-o", "again.cw2mesh"}, ">&- 2>&- <&-").status, 0);
    EXPECT_EQ(read("again.cw2mesh"), read("scene.cw2mesh"));
}

TEST_F(Outputs, AFileBeyondTheLimitIsAnErrorAndLeavesNothing) {
    const auto before = names();
    const Outcome outcome =
        in_shell("ulimit -f 1;", {BAKE_PROGRAM, "scene.obj", "-o", "new.cw2mesh"}, "");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "cw2-bake: new.cw2mesh: cannot be written: File too large\n");
    EXPECT_EQ(names(), before);
}

TEST_F(Outputs, SignalsLeaveNoTemporaryFiles) {
    const auto before = names();
    const auto is_at_work = [this] {
        return std::ranges::any_of(names(), [](const std::string& name) {
            return name.find(".json.cw2-tmp-") != std::string::npos;
        });
    };
    fs::create_directory(here("turn"));
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGKILL}) {
        Running turn({CW2_PROGRAM, "scene.cw2mesh", "--size", "320x240", "--frames", "10000",
                      "--output", "turn/%05d.png", "--stats", "stats.json"},
                     {{}, folder_.path()});
        ASSERT_TRUE(wait_until(is_at_work));
        ASSERT_TRUE(wait_until([&] { return fs::exists(here("turn/00001.png")); }));
        ASSERT_EQ(::kill(turn.process(), signal), 0);
        EXPECT_EQ(turn.wait().status, 128 + signal);
        EXPECT_EQ(is_at_work(), signal == SIGKILL);
        for (const auto& file : fs::directory_iterator(here("turn")))
            EXPECT_TRUE(file.path().extension() == ".png" || signal == SIGKILL) << file.path();
        fs::remove(here("turn/00001.png"));
    }
    bake_well({"scene.obj", "--quiet"});  // in the same folder
    EXPECT_FALSE(is_at_work());
    fs::remove_all(here("turn"));
    EXPECT_EQ(names(), before);
}

TEST_F(Outputs, ATruncatedInputIsAnErrorAtAnyTime) {
    std::string large = read("scene.obj");
    for (int i = 0; i < 60'000; ++i) large += "v 0.5 0.25 0.125\nf -1 1 2\n";
    write("large.mtl", read("scene.mtl"));
    const std::string picture = read("colors.png") + std::string(3 << 20, 'x');
    write("large.obj", large);
    bake_well({"large.obj", "--quiet"});
    const std::string baked = read("large.cw2mesh");
    const struct {
        Words command;
        std::string input;
        std::string contents;
    } table[] = {
        {{BAKE_PROGRAM, "large.obj", "-o", "out.cw2mesh", "--quiet"}, "large.obj", large},
        {{BAKE_PROGRAM, "scene.obj", "-o", "out.cw2mesh", "--quiet"}, "colors.png", picture},
        {{BAKE_PROGRAM, "large.cw2mesh", "-o", "out.glb", "--quiet"}, "large.cw2mesh", baked},
        {{CW2_PROGRAM, "large.cw2mesh", "--output", "out.png", "--size", "64x64"},
         "large.cw2mesh",
         baked},
    };
    std::mt19937 random(5);
    for (int i = 0; i < 28; ++i) {
        const auto& [command, input, contents] = table[i % 4];
        write(input, contents);
        Running running(command, {{}, folder_.path()});
        const int most = command.front() == CW2_PROGRAM ? 120'000 : 30'000;
        std::this_thread::sleep_for(std::chrono::microseconds(random() % most));
        fs::resize_file(here(input), random() % 3 * 400'000 % contents.size());
        const Outcome outcome = running.wait();
        EXPECT_LE(outcome.status, 1) << outcome.err;
        if (outcome.status == 1) {
            EXPECT_NE(outcome.err.find(input), std::string::npos) << outcome.err;
        }
        for (const std::string& name : names())
            EXPECT_EQ(name.find(".cw2-tmp-"), std::string::npos);
    }
}

}  // namespace
