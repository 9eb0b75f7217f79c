// What happens to a bake at its worst moments: the file that was there stays, or the new one takes
// its place, whole, and a message says which.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <set>
#include <thread>

#include "tests/cli/scene_folder.h"

namespace {

using Words = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

/// Whether every fault is tried, which takes minutes, or some of them.
bool is_thorough() {
    return std::getenv("CW2_EVERY_FAULT") != nullptr;
}

class Faults : public SceneFolder {
 protected:
    void SetUp() override {
        SceneFolder::SetUp();
        bake_well(with({"--textures", "none"}));
        old_ = read("out.cw2mesh");
        std::filesystem::copy_file(here("out.cw2mesh"), here("old"));
        bake_well(with({}));
        new_ = read("out.cw2mesh");
        ASSERT_NE(old_, new_);
        files_ = list();
        put_back();
    }

    static Words with(Words arguments) {
        arguments.insert(arguments.begin(),
                         {"scene.obj", "-o", "out.cw2mesh", "--quiet", "--threads", "1"});
        return arguments;
    }
    void put_back() {
        std::filesystem::copy_file(here("old"), here("out.cw2mesh"),
                                   std::filesystem::copy_options::overwrite_existing);
    }
    std::set<std::string> list() const {
        std::set<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            names.insert(entry.path().filename().string());
        return names;
    }

    Outcome bake_with(const Words& environment, const Words& arguments) {
        Words command = with(arguments);
        command.insert(command.begin(), BAKE_PROGRAM);
        return run(command, {environment, folder_.path()});
    }
    /// The limit as bash's ulimit takes it.
    Outcome run_below(const std::string& limit, const Words& arguments) {
        Words command{"/bin/bash", "-c", "ulimit " + limit + " && exec \"$0\" \"$@\"",
                      BAKE_PROGRAM};
        command.insert(command.end(), arguments.begin(), arguments.end());
        return run(command, {{}, folder_.path()});
    }
    /// Nothing where the limit does not even let the program start.
    void expect_old_or_new_below(const std::string& limit) {
        SCOPED_TRACE("ulimit " + limit);
        try {
            if (run_below(limit, {"--version"}).status != 0) return;
        } catch (const std::runtime_error&) {
            return;
        }
        expect_old_or_new(run_below(limit, with({})));
        ++limits_;
    }

    /// Done, and the file is the new one; or not, with a message of one line, and it is the old
    /// one.
    void expect_old_or_new(const Outcome& outcome) {
        if (outcome.status == 0) {
            EXPECT_EQ(outcome.err, "");
            EXPECT_TRUE(read("out.cw2mesh") == new_) << "no error, and not what was to be made";
            put_back();
        } else {
            EXPECT_EQ(outcome.status, 1);
            EXPECT_TRUE(outcome.err.starts_with("cw2-bake: ")) << outcome.err;
            EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
            const std::string file = read("out.cw2mesh");
            EXPECT_TRUE(file == old_ || file == new_) << "the old file is lost: " << outcome.err;
            if (file == new_) put_back();
        }
        EXPECT_EQ(list(), files_);
    }

    /// How many allocations a bake makes, and how many calls that write.
    std::pair<long, long> count(const Words& arguments) {
        const Outcome outcome = bake_with(
            {"LD_PRELOAD=" FAULT_SHIM, "FAULT_COUNT=" + here("count").string()}, arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::ifstream file(here("count"));
        std::pair<long, long> counts;
        file >> counts.first >> counts.second;
        std::filesystem::remove(here("count"));
        put_back();
        return counts;
    }

    std::string old_, new_;
    std::set<std::string> files_;
    int limits_ = 0;  // that were tried
};

TEST_F(Faults, AnyAllocationMayFail) {
    const auto [count, ignored] = Faults::count({});
    ASSERT_GT(count, 1000);
    std::mt19937 random(1);
    long done = 0;
    // All of the first thousand, then some; in a hurry, some of both.
    const long step = is_thorough() ? 1 : 17;
    for (long n = 1; n <= count + step;
         n += n < 1000 ? step : 1 + static_cast<long>(random() % 200)) {
        for (const bool goes_on : {false, true}) {
            SCOPED_TRACE("allocation " + std::to_string(n) + (goes_on ? " and all after it" : ""));
            Words environment{"LD_PRELOAD=" FAULT_SHIM, "FAULT_ALLOCATION=" + std::to_string(n)};
            if (goes_on) environment.emplace_back("FAULT_FROM_THEN_ON=1");
            expect_old_or_new(bake_with(environment, {}));
            ++done;
        }
    }
    RecordProperty("faults", std::to_string(done));
}

TEST_F(Faults, AnyWriteMayFail) {
    const Words outputs{"--stats", "stats.json", "--depfile", "out.d"};
    const auto [ignored, count] = Faults::count(outputs);
    ASSERT_GT(count, 5);
    for (const char* name : {"stats.json", "out.d"}) std::filesystem::remove(here(name));
    for (long n = 1; n <= count; ++n) {
        for (const bool goes_on : {false, true}) {
            SCOPED_TRACE("write " + std::to_string(n) + (goes_on ? " and all after it" : ""));
            Words environment{"LD_PRELOAD=" FAULT_SHIM, "FAULT_WRITE=" + std::to_string(n)};
            if (goes_on) environment.emplace_back("FAULT_FROM_THEN_ON=1");
            const Outcome outcome = bake_with(environment, outputs);
            EXPECT_TRUE(outcome.status == 0 || outcome.status == 1) << outcome.status;
            EXPECT_EQ(std::ranges::count(outcome.err, '\n'), outcome.status) << outcome.err;
            // The file comes first; what is told of it, after.
            const std::string file = read("out.cw2mesh");
            EXPECT_TRUE(file == new_ || (outcome.status == 1 && file == old_));
            for (const char* name : {"stats.json", "out.d"}) std::filesystem::remove(here(name));
            EXPECT_EQ(list(), files_);
            put_back();
        }
    }
}

TEST_F(Faults, KillsAtAnyMomentLeaveAWholeFile) {
    Words command = with({});
    command.insert(command.begin(), BAKE_PROGRAM);
    const auto begin = Clock::now();
    ASSERT_EQ(run(command, {{}, folder_.path()}).status, 0);
    const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin);
    put_back();
    std::mt19937 random(2);
    int left_old = 0;
    const int kills = is_thorough() ? 2000 : 60;
    for (int i = 0; i < kills; ++i) {
        {
            Running bake(command, {{}, folder_.path()});
            std::this_thread::sleep_for(whole * (random() % 1000) / 900);
            ::kill(bake.process(), i % 2 ? SIGKILL : SIGTERM);
            const Outcome outcome = bake.wait();
            EXPECT_TRUE(outcome.status == 0 || outcome.status == 128 + SIGKILL ||
                        outcome.status == 128 + SIGTERM)
                << outcome.status << outcome.err;
        }
        const std::string file = read("out.cw2mesh");
        ASSERT_TRUE(file == old_ || file == new_) << i;
        left_old += file == old_;
        put_back();
    }
    EXPECT_GT(left_old, 0);
    // What the last of the killed left goes with the next bake.
    ASSERT_EQ(run(command, {{}, folder_.path()}).status, 0);
    EXPECT_EQ(list(), files_);
}

TEST_F(Faults, LimitsOfTheSystemAreErrors) {
    const int step = is_thorough() ? 1 : 5;
    for (int files = 4; files <= 40; files += step)
        expect_old_or_new_below("-n " + std::to_string(files));
    for (int kilobytes = 0; kilobytes * 1024 < 2 * static_cast<int>(new_.size()); ++kilobytes)
        expect_old_or_new_below("-f " + std::to_string(kilobytes));
    for (int megabytes = 20; megabytes <= 240; megabytes += 4 * step)
        expect_old_or_new_below("-v " + std::to_string(1024 * megabytes));
    EXPECT_GT(limits_, 15);
}

TEST_F(Faults, AFullFileSystemIsAnError) {
    const std::string script =
        "mount -t tmpfs -o size=24k tmpfs \"$1\" && cp \"$2/old\" \"$1/out.cw2mesh\" && "
        "head -c 1M /dev/zero >\"$1/filler\" 2>/dev/null; cd \"$2\"; "
        "\"$0\" scene.obj -o \"$1/out.cw2mesh\" --quiet; echo \"status $?\"; "
        "cmp \"$1/out.cw2mesh\" \"$2/old\" && ls \"$1\"";
    std::filesystem::create_directory(here("small"));
    const Outcome outcome = run({"/usr/bin/unshare", "--mount", "--map-root-user", "/bin/bash",
                                 "-c", script, BAKE_PROGRAM, here("small"), here("")});
    if (outcome.out.empty()) GTEST_SKIP() << "no file system can be mounted here: " << outcome.err;
    EXPECT_EQ(outcome.out, "status 1\nfiller\nout.cw2mesh\n") << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
}

}  // namespace
