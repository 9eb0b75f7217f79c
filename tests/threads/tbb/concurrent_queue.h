// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include <mutex>
#include <queue>

namespace tbb {

template <typename Value>
class concurrent_queue {
 public:
    void push(const Value& value) {
        const std::lock_guard lock(mutex_);
        values_.push(value);
    }
    bool try_pop(Value& value) {
        const std::lock_guard lock(mutex_);
        if (values_.empty()) return false;
        value = values_.front();
        values_.pop();
        return true;
    }

 private:
    std::mutex mutex_;
    std::queue<Value> values_;
};

}  // namespace tbb
