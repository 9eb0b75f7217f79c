// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "global_control.h"

namespace tbb {

enum class filter_mode { serial_in_order, parallel };

/// Of one item; `ended` is the pipeline's.
class flow_control {
 public:
    explicit flow_control(bool& ended) : ended_(ended) {}
    void stop() { ended_ = stopped_ = true; }
    bool is_stopped() const { return stopped_; }
    bool pipeline_has_ended() { return stopped_ = ended_; }

 private:
    bool& ended_;
    bool stopped_ = false;
};

/// Lets items through one at a time, in their order. Throws once an item has failed.
class Turns {
 public:
    template <typename Work>
    auto at(std::size_t item, const Work& work) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return next_ == item || failed_; });
        if (failed_) throw std::runtime_error("an earlier item failed");
        // After one that throws no other has its turn: the rest wait until fail() is called.
        struct Done {
            Turns& turns;
            int before = std::uncaught_exceptions();
            ~Done() {
                if (std::uncaught_exceptions() == before) ++turns.next_;
                turns.changed_.notify_all();
            }
        } done{*this};
        return work();
    }
    void fail() {
        const std::lock_guard lock(mutex_);
        failed_ = true;
        changed_.notify_all();
    }

 private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t next_ = 0;
    bool failed_ = false;
};

/// A stage, or several. The first stage of a pipeline takes a flow_control.
template <typename In, typename Out>
struct filter {
    using Argument = std::conditional_t<std::is_void_v<In>, flow_control, In>;
    std::function<Out(std::size_t item, Argument&)> run;
    std::function<void()> fail;

    template <typename Next>
    filter<In, Next> operator&(const filter<Out, Next>& after) const {
        return {[first = run, second = after.run](std::size_t item, Argument& argument) {
                    Out between = first(item, argument);
                    if constexpr (std::is_void_v<In>) {
                        if (argument.is_stopped()) return Next();
                    }
                    return second(item, between);
                },
                [a = fail, b = after.fail] { a(), b(); }};
    }
};

template <typename In, typename Out, typename Body>
filter<In, Out> make_filter(filter_mode mode, const Body& body) {
    using Argument = typename filter<In, Out>::Argument;
    if (mode == filter_mode::parallel)
        return {[body](std::size_t, Argument& argument) { return body(argument); }, [] {}};
    const auto turns = std::make_shared<Turns>();
    return {[body, turns](std::size_t item, Argument& argument) {
                return turns->at(item, [&] {
                    if constexpr (std::is_void_v<In>) {
                        if (argument.pipeline_has_ended()) return Out();
                    }
                    return body(argument);
                });
            },
            [turns] { turns->fail(); }};
}

inline void parallel_pipeline(std::size_t items_at_once, const filter<void, void>& stages) {
    bool ended = false;
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    run_all(items_at_once, [&](std::size_t) {
        for (bool goes_on = true; goes_on;) {
            flow_control flow(ended);
            try {
                stages.run(next++, flow);
                goes_on = !flow.is_stopped();
            } catch (...) {
                {
                    const std::lock_guard lock(mutex);
                    if (!failure) failure = std::current_exception();
                }
                stages.fail();
                return;
            }
        }
    });
    if (failure) std::rethrow_exception(failure);
}

}  // namespace tbb
