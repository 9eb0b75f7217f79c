// A bake is a pure function of its inputs and options: who bakes, where, when and in which language
// makes no difference, and leaves no trace.
#include <gtest/gtest.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/cli/scene_folder.h"

namespace {

namespace fs = std::filesystem;

class PureBake : public SceneFolder {
 protected:
    /// Runs `command`, which bakes `in` to `out`, in `folder`, and returns what was written.
    std::string baked(const fs::path& folder, std::vector<std::string> command,
                      const std::vector<std::string>& environment, const fs::path& in,
                      const fs::path& out) {
        command.insert(command.end(), {in, "-o", out, "--quiet"});
        fs::remove(folder / out);
        const Outcome outcome = run(command, {environment, folder});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read(folder / out);
    }
};

TEST_F(PureBake, FromAnotherRootAsAnotherUserAtAnotherTimeInAnotherLanguage) {
    const TemporaryFolder other;
    const fs::path elsewhere = other.path() / "a deeper" / "folder";
    fs::create_directories(elsewhere);
    fs::copy(folder_.path(), elsewhere);
    for (const fs::path& folder : {other.path(), other.path() / "a deeper", elsewhere})
        fs::permissions(folder, fs::perms::all);
    for (const auto& entry : fs::directory_iterator(elsewhere))
        fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::hours(9000));

    // Where a decimal point is a comma.
    const fs::path languages = other.path() / "languages";
    fs::create_directory(languages);
    const std::string language = "LC_ALL=de_DE.UTF-8", where = "LOCPATH=" + languages.string();
    run({"/usr/bin/localedef", "-i", "de_DE", "-f", "UTF-8", languages / "de_DE.UTF-8"});
    ASSERT_EQ(run({"/usr/bin/printf", "%.1f", "1,5"}, {{language, where}, {}}).out, "1,5");

    // Root can be somebody else, who may not see where the program was built.
    fs::copy_file(BAKE_PROGRAM, elsewhere / "bake");
    std::vector<std::string> as_another{elsewhere / "bake"};
    if (::geteuid() == 0)
        as_another = {"/usr/bin/setpriv", "--reuid=65534", "--regid=65534", "--clear-groups",
                      elsewhere / "bake"};
    utsname host{};
    ASSERT_EQ(::uname(&host), 0);
    std::vector<std::string> traces{folder_.path(), "alice"};
    // Shorter names turn up in any file.
    if (std::string_view(host.nodename).size() > 5) traces.emplace_back(host.nodename);
    for (const char* out : {"out.cw2mesh", "out.glb", "out.gltf"}) {
        const std::string file = baked(folder_.path(), {BAKE_PROGRAM},
                                       {"LC_ALL=C", "TZ=UTC", "USER=alice", "HOME=/home/alice"},
                                       here("scene.obj"), here(out));
        std::this_thread::sleep_for(std::chrono::milliseconds(1100));
        const std::string again = baked(
            elsewhere, as_another, {language, where, "TZ=Asia/Tokyo", "USER=bob", "HOME=/home/bob"},
            "scene.obj", out);
        ASSERT_FALSE(file.empty());
        EXPECT_TRUE(file == again) << out;
        for (const std::string& trace : traces)
            EXPECT_EQ(file.find(trace), std::string::npos) << out << " holds " << trace;
    }
}

}  // namespace
