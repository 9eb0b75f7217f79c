#include "cw2-bake/base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace bake {

namespace {

constexpr auto kPatience = std::chrono::seconds(1);
constexpr auto kInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;
constexpr std::size_t kLabelWidth = 40;

}  // namespace

ProgressBar::ProgressBar(bool enabled)
    : enabled_(enabled && ::isatty(STDERR_FILENO) != 0), next_draw_(Clock::now() + kPatience) {}

ProgressBar::~ProgressBar() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::update(double done, std::string_view what) {
    if (!enabled_ || Clock::now() < next_draw_) return;
    next_draw_ = Clock::now() + kInterval;
    drawn_ = true;
    const int filled = static_cast<int>(std::clamp(done, 0.0, 1.0) * kBarWidth);
    fmt::print(stderr, "\r\033[K[{:=<{}}{: <{}}] {:3.0f} % {}", "", filled, "", kBarWidth - filled,
               100.0 * done, what.substr(0, kLabelWidth));
    std::fflush(stderr);
}

}  // namespace bake
