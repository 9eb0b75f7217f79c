// A progress bar for a person who waits.
#pragma once

#include <chrono>
#include <string_view>

namespace common {

/// Draws a bar on standard error once the work has taken a while, if that is a terminal; erases
/// it when destroyed.
class ProgressBar {
 public:
    /// With `enabled` false nothing is ever drawn, else after `patience`.
    explicit ProgressBar(bool enabled,
                         std::chrono::milliseconds patience = std::chrono::seconds(1));
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// `done` in [0, 1]; `what` is at work.
    void update(double done, std::string_view what);
    /// Takes it away for a line of other text; the next update() draws it again.
    void erase();

 private:
    using Clock = std::chrono::steady_clock;

    bool enabled_;
    bool drawn_ = false;
    Clock::time_point next_draw_;
};

}  // namespace common
