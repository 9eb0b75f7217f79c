#include "cw2-bake/stage_progress.h"

namespace bake {

void StageProgress::begin(std::string_view stage) {
    const std::lock_guard lock(mutex_);
    clock_.begin(stage);
    done_ = 0.0;
    bar_.update(done_, stage);
}

void StageProgress::update(double done, std::string_view what) {
    const std::lock_guard lock(mutex_);
    bar_.update(done, what);
}

void StageProgress::erase() {
    const std::lock_guard lock(mutex_);
    bar_.erase();
}

}  // namespace bake
