// What a person who waits sees of a bake's stages.
#pragma once

#include <algorithm>
#include <mutex>
#include <string_view>

#include "common/progress.h"
#include "cw2-bake/base/advance.h"
#include "cw2-bake/stats.h"

namespace bake {

/// A bar that moves from empty to full in each stage; threads may tell it at once.
class StageProgress {
 public:
    /// With `shown` false nothing is ever drawn. Begins the stages of `clock`, too.
    StageProgress(bool shown, StageClock& clock) : clock_(clock), bar_(shown) {}

    void begin(std::string_view stage);
    /// Tells how much more of the stage at work is done.
    const Advance& advance() const { return advance_; }
    /// How much of it is done, and what of it is at work.
    void update(double done, std::string_view what);
    /// Takes the bar away for a line of other text.
    void erase();

 private:
    StageClock& clock_;
    std::mutex mutex_;
    common::ProgressBar bar_;
    double done_ = 0.0;
    Advance advance_ = [this](double more) {
        const std::lock_guard lock(mutex_);
        done_ = std::min(done_ + more, 1.0);
        bar_.update(done_, clock_.at_work());
    };
};

}  // namespace bake
