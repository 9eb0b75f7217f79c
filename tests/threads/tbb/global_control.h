// What the preset `check` compiles in place of oneTBB: the thread sanitizer does not see how the
// library hands work from thread to thread, so these hand it over by the standard library alone.
// Only what the project uses, and only as fast as tests need.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tbb {

class global_control {
 public:
    enum parameter { max_allowed_parallelism };

    global_control(parameter, std::size_t value) : before_(value_.exchange(value)) {}
    ~global_control() { value_ = before_; }
    global_control(const global_control&) = delete;
    global_control& operator=(const global_control&) = delete;

    static std::size_t active_value(parameter) { return value_; }

 private:
    inline static std::atomic<std::size_t> value_ = 4;
    std::size_t before_;
};

/// Calls task(i) for i in [0, count); each thread has its share of them, so that the sanitizer sees
/// what two of them touch. Throws the first exception of a task.
template <typename Task>
void run_all(std::size_t count, const Task& task) {
    const std::size_t shares = std::min(count, global_control::active_value({}));
    std::atomic<bool> failed = false;
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&](std::size_t share) {
        try {
            for (std::size_t i = share; i < count && !failed; i += shares) task(i);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failed.exchange(true)) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> threads;
        for (std::size_t share = 1; share < shares; ++share) threads.emplace_back(work, share);
        if (shares > 0) work(0);
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace tbb
