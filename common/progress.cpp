#include "common/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

namespace common {

namespace {

constexpr auto kInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;
constexpr std::size_t kLabelWidth = 40;

}  // namespace

ProgressBar::ProgressBar(bool enabled, std::chrono::milliseconds patience)
    : enabled_(enabled && ::isatty(STDERR_FILENO) != 0), next_draw_(Clock::now() + patience) {}

ProgressBar::~ProgressBar() {
    erase();
}

void ProgressBar::erase() {
    if (std::exchange(drawn_, false)) std::fputs("\r\033[K", stderr);
}

void ProgressBar::update(double done, std::string_view what) {
    if (!enabled_ || Clock::now() < next_draw_) return;
    next_draw_ = Clock::now() + kInterval;
    drawn_ = true;
    std::string bar(kBarWidth, ' ');
    std::fill_n(bar.begin(), static_cast<int>(std::clamp(done, 0.0, 1.0) * kBarWidth), '=');
    std::fprintf(stderr, "\r\033[K[%s] %3.0f %% %s", bar.c_str(), 100.0 * done,
                 std::string(what.substr(0, kLabelWidth)).c_str());
    std::fflush(stderr);
}

}  // namespace common
