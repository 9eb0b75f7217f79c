// The progress bar, as a terminal gets it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/progress.h"
#include "cw2-bake/geometry/compress.h"
#include "cw2-bake/geometry/normals.h"
#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/obj/read_obj.h"
#include "obj_text.h"

namespace {

/// What standard error, made a terminal meanwhile, is given by `work`.
template <typename Work>
std::string shown_on_a_terminal(const Work& work) {
    int reader = -1, terminal = -1;
    if (::openpty(&reader, &terminal, nullptr, nullptr, nullptr) != 0) return "no terminal";
    std::fflush(stderr);
    const int before = ::dup(STDERR_FILENO);
    ::dup2(terminal, STDERR_FILENO);
    work();
    std::fflush(stderr);
    ::dup2(before, STDERR_FILENO);
    ::close(before);
    ::close(terminal);
    std::string text;
    std::array<char, 4096> part;
    for (ssize_t size; (size = ::read(reader, part.data(), part.size())) > 0;)
        text.append(part.data(), static_cast<std::size_t>(size));
    ::close(reader);
    return text;
}

constexpr auto kAtOnce = std::chrono::milliseconds(0);

TEST(ProgressBar, GoesForALineOfOtherTextAndInTheEnd) {
    const std::string shown = shown_on_a_terminal([] {
        common::ProgressBar bar(true, kAtOnce);
        bar.update(0.5, "half.png");
        bar.erase();
        std::fputs("a warning\n", stderr);
    });
    const std::size_t at = shown.find("a warning");
    ASSERT_NE(at, std::string::npos) << shown;
    EXPECT_NE(shown.find(" 50 % half.png"), std::string::npos) << shown;
    EXPECT_LT(shown.find(" 50 % half.png"), at);
    EXPECT_TRUE(shown.substr(0, at).ends_with("\r\033[K")) << shown;
    EXPECT_TRUE(shown.substr(at).find("\033[K") == std::string::npos) << "erased twice";
    const std::string left = shown_on_a_terminal([] {
        common::ProgressBar bar(true, kAtOnce);
        bar.update(1.0, "whole.png");
    });
    EXPECT_TRUE(left.ends_with("\r\033[K")) << left;
}

TEST(ProgressBar, ShowsNothingOfWhatIsQuickOrUnwanted) {
    EXPECT_EQ(shown_on_a_terminal([] {
                  common::ProgressBar(true).update(0.5, "quick");
                  common::ProgressBar(false, kAtOnce).update(0.5, "unwanted");
              }),
              "");
}

/// What the stages of a bake tell, one after the other.
class Told {
 public:
    const bake::Advance& advance() const { return advance_; }
    /// Since the last time.
    double take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(all_, 0.0);
    }

 private:
    std::mutex mutex_;
    double all_ = 0.0;
    bake::Advance advance_ = [this](double more) {
        const std::lock_guard lock(mutex_);
        EXPECT_GE(more, 0.0);
        all_ += more;
    };
};

/// A sheet that is smooth and states no normals.
std::string sheet(int side) {
    std::string text = "s 1\n";
    for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x) text += fmt::format("v {} {} {}\n", x, x * y % 7, y);
    for (int y = 0; y < side; ++y) {
        for (int x = 1; x <= side; ++x) {
            const int a = y * (side + 1) + x;
            text += fmt::format("f {} {} {}\nf {} {} {}\n", a, a + side + 1, a + 1, a + 1,
                                a + side + 1, a + side + 2);
        }
    }
    return text;
}

TEST(Stages, TellAllOfTheirWork) {
    const TemporaryFolder folder;
    folder.write("sheet.obj", sheet(100));
    Told told;
    constexpr double kRounding = 1e-9;
    bake::SourceScene scene = bake::read_obj(
        folder.path() / "sheet.obj", [](const std::string&) {}, 1000, {}, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    const bake::FirstEqual positions(scene.positions);
    bake::generate_normals(scene, positions, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    bake::SourceScene copy = scene;
    bake::weld_in_space(copy, positions, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    bake::FramedTriangles framed = bake::weld(scene, positions, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    bake::add_tangents(scene, framed, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    const bake::FramedScene framed_scene{scene, framed};
    const std::vector<bake::UvBudget> budgets(1);
    const bake::ChunkedScene chunked = bake::make_chunks(framed_scene, budgets, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    const bake::PackedGeometry packed = bake::quantise(
        framed_scene, chunked, budgets,
        {mesh_format::FrameForm::quat48, mesh_format::PositionForm::quantised}, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
    bake::compress(packed, told.advance());
    EXPECT_NEAR(told.take(), 1.0, kRounding);
}

}  // namespace
