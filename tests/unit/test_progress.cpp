// The progress bar, as a terminal gets it.
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <string>

#include "common/progress.h"

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

}  // namespace
