// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <mutex>

namespace tbb {

/// Of the thread that asks; unlike a std::thread::id never that of a thread that has ended.
inline unsigned own_number() {
    static std::atomic<unsigned> next;
    thread_local const unsigned number = next++;
    return number;
}

template <typename Value>
class enumerable_thread_specific {
 public:
    enumerable_thread_specific() : make_([] { return Value(); }) {}
    explicit enumerable_thread_specific(std::function<Value()> make) : make_(std::move(make)) {}

    Value& local() {
        const std::lock_guard lock(mutex_);
        auto found = values_.find(own_number());
        if (found == values_.end()) found = values_.emplace(own_number(), make_()).first;
        return found->second;
    }

 private:
    std::function<Value()> make_;
    std::mutex mutex_;
    std::map<unsigned, Value> values_;
};

}  // namespace tbb
