// When a file counts as changed.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "cw2/window/file_watch.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

class FileWatch : public testing::Test {
 protected:
    FileWatch() { write("as it was"); }

    void write(const std::string& text) const { std::ofstream(path_) << text; }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "scene.cw2mesh";
};

TEST_F(FileWatch, AFileThatStaysHasNotChanged) {
    cw2::FileWatch watch({path_});
    for (int look = 0; look < 3; ++look) EXPECT_FALSE(watch.changed());
}

TEST_F(FileWatch, AChangeIsToldOnceAndOnlyWhenItHasComeToRest) {
    cw2::FileWatch watch({path_});
    write("half of");
    EXPECT_FALSE(watch.changed());
    write("half of another");
    EXPECT_FALSE(watch.changed());
    EXPECT_TRUE(watch.changed());
    EXPECT_FALSE(watch.changed());
}

TEST_F(FileWatch, AFileThatIsGoneHasNotChangedUntilAnotherIsThere) {
    cw2::FileWatch watch({path_});
    std::filesystem::remove(path_);
    for (int look = 0; look < 3; ++look) EXPECT_FALSE(watch.changed());
    write("quite another");
    EXPECT_FALSE(watch.changed());
    EXPECT_TRUE(watch.changed());
}

TEST_F(FileWatch, WhatWasWrittenSinceATimeCountsAsChanged) {
    using std::chrono::system_clock, std::chrono::minutes;
    const auto write_at = [this](const fs::file_time_type& time) {
        std::filesystem::last_write_time(path_, time);
    };
    const auto now = fs::file_time_type::clock::now();
    write_at(now - minutes(2));
    EXPECT_FALSE(cw2::FileWatch({path_}, system_clock::now() - minutes(1)).changed());
    cw2::FileWatch watch({path_}, system_clock::now() - minutes(3));
    EXPECT_TRUE(watch.changed());
    EXPECT_FALSE(watch.changed());
    // A clock that goes wrong makes no endless changes.
    write_at(now + minutes(5));
    EXPECT_FALSE(cw2::FileWatch({path_}, system_clock::now() - minutes(3)).changed());
}

TEST_F(FileWatch, AnyOfSeveralFilesCounts) {
    const std::filesystem::path other = path_.string() + ".other";
    cw2::FileWatch watch({path_, other});
    EXPECT_FALSE(watch.changed());
    std::ofstream(other) << "it has come";
    EXPECT_FALSE(watch.changed());
    EXPECT_TRUE(watch.changed());
    std::filesystem::remove(other);
    EXPECT_FALSE(watch.changed());
    EXPECT_TRUE(watch.changed());
    EXPECT_FALSE(watch.changed());
}

}  // namespace
