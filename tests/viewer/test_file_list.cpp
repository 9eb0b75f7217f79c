// Files that are gone through, and paths that are typed.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cw2/window/file_list.h"
#include "cw2/window/overlay.h"
#include "tests/support/temporary_folder.h"

namespace {

using cw2::FileList;

TEST(FileList, GoesRoundInBothDirections) {
    FileList files({"a", "b", "c"});
    EXPECT_EQ(files.current(), "a");
    EXPECT_EQ(files.place(), "1 of 3");
    files.go(1);
    EXPECT_EQ(files.current(), "b");
    files.go(1);
    files.go(1);
    EXPECT_EQ(files.current(), "a");
    files.go(-1);
    EXPECT_EQ(files.current(), "c");
}

TEST(FileList, NewFilesComeBehindTheCurrentOne) {
    FileList files({"a", "b"});
    files.insert({"x", "y"});
    EXPECT_EQ(files.current(), "x");
    files.go(1);
    EXPECT_EQ(files.current(), "y");
    files.go(1);
    EXPECT_EQ(files.current(), "b");
    files.insert({});
    EXPECT_EQ(files.current(), "b");
    EXPECT_EQ(FileList({"a"}).place(), "");
}

TEST(PathField, CompletesAsFarAsAllFilesAgree) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "models");
    for (const char* name : {"sponza.obj", "sponge.obj"}) const std::ofstream empty(folder / name);
    const auto in = [&](const char* name) { return (folder / name).string(); };
    EXPECT_EQ(cw2::completed_path(in("sp")), in("spon"));
    EXPECT_EQ(cw2::completed_path(in("sponz")), in("sponza.obj"));
    EXPECT_EQ(cw2::completed_path(in("m")), in("models/"));
    EXPECT_EQ(cw2::completed_path(in("x")), in("x"));
    EXPECT_EQ(cw2::completed_path("/no such folder/x"), "/no such folder/x");
}

}  // namespace
