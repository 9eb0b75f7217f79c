// Files that change while they are read, and what is beside a file that is written.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <utility>

#include "common/io.h"
#include "common/signals.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

class Io : public testing::Test {
 protected:
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    void commit(const std::string& name) const {
        common::OutputFile file(folder_ / name);
        file.write(std::as_bytes(std::span(name)));
        file.commit();
    }

    TemporaryFolder folder_;
};

void read_what_is_gone(const fs::path& path) {
    common::handle_signals("program");
    const common::MappedFile file(path);
    common::note_temporary(path.string() + ".left");
    fs::resize_file(path, 1);
    volatile std::byte last = file.bytes().back();
    static_cast<void>(last);
}

TEST_F(Io, AMappedFileThatBecameShorterIsAnError) {
    write("file", std::string(100'000, 'x'));
    write("file.left", "");
    EXPECT_EXIT(read_what_is_gone(folder_ / "file"), testing::ExitedWithCode(1),
                "^program: .*/file: became shorter while it was read\n$");
    EXPECT_FALSE(fs::exists(folder_ / "file.left"));
}

TEST_F(Io, WhatIsForgottenOfAFileIsReadAnew) {
    std::string text(100'000, 'x');
    for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i % 23);
    write("file", text);
    const common::MappedFile file(folder_ / "file");
    for (const auto& [begin, size] : {std::pair<std::size_t, std::size_t>{0, 100'000},
                                      {5'000, 60'000},
                                      {4'096, 4'096},
                                      {10, 20},
                                      {99'999, 1}}) {
        common::forget_mapped(file.bytes().subspan(begin, size));
        EXPECT_EQ(std::memcmp(file.bytes().data(), text.data(), text.size()), 0) << begin;
    }
}

void read_beyond_all_files() {
    common::handle_signals("program");
    std::raise(SIGBUS);
}

TEST_F(Io, AnyOtherBusErrorStaysOne) {
    EXPECT_EXIT(read_beyond_all_files(), testing::KilledBySignal(SIGBUS), "^$");
}

TEST_F(Io, AFileThatChangesIsNoticed) {
    write("file", "some");
    const common::MappedFile file(folder_ / "file");
    EXPECT_NO_THROW(file.require_unchanged());
    fs::last_write_time(folder_ / "file", fs::file_time_type::clock::now() - std::chrono::hours(1));
    EXPECT_THROW(file.require_unchanged(), common::FileError);
    const common::MappedFile again(folder_ / "file");
    EXPECT_NO_THROW(again.require_unchanged());
    commit("file");  // another file in its place is no change of the one that is mapped
    EXPECT_NO_THROW(again.require_unchanged());
}

TEST_F(Io, LeftoversGoUnlessSomebodyHoldsThem) {
    for (const char* name :
         {"out.cw2-tmp-abc123", "other.png.cw2-tmp-000000", "out.backup", "out.cw2-tmp-ABCDEF",
          "out.cw2-tmp-held00", "cw2-tmp-abc123", "model.cw2-backup"})
        write(name, "x");
    const int held = ::open((folder_ / "out.cw2-tmp-held00").c_str(), O_RDONLY);
    ASSERT_EQ(::flock(held, LOCK_EX), 0);
    commit("out");
    EXPECT_FALSE(fs::exists(folder_ / "out.cw2-tmp-abc123"));
    EXPECT_FALSE(fs::exists(folder_ / "other.png.cw2-tmp-000000"));
    for (const char* name : {"out", "out.backup", "out.cw2-tmp-ABCDEF", "out.cw2-tmp-held00",
                             "cw2-tmp-abc123", "model.cw2-backup"})
        EXPECT_TRUE(fs::exists(folder_ / name)) << name;
    ::close(held);
}

TEST_F(Io, ANameMayBeAsLongAsNamesMayBe) {
    commit(std::string(255, 'n'));
    EXPECT_EQ(fs::file_size(folder_ / std::string(255, 'n')), 255u);
}

}  // namespace
