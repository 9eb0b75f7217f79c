// A number for each of many things, of which neighbours mostly have the same.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

namespace bake {

/// Like a vector of 32-bit numbers, with memory for where they change only.
class RunVector {
 public:
    /// Elements that have one number, from the end of the run before on.
    struct Run {
        std::size_t end;
        std::uint32_t number;
        bool operator==(const Run&) const = default;
    };

    void push_back(std::uint32_t number) { extend(size() + 1, number); }

    /// Appends `number` until there are `size` elements; there are no more than that before.
    void extend(std::size_t size, std::uint32_t number) {
        if (size == this->size()) return;
        if (!runs_.empty() && runs_.back().number == number)
            runs_.back().end = size;
        else
            runs_.push_back({size, number});
    }

    std::size_t size() const { return runs_.empty() ? 0 : runs_.back().end; }
    bool empty() const { return runs_.empty(); }
    std::span<const Run> runs() const { return runs_; }

    /// In time that grows with the logarithm of the number of runs.
    std::uint32_t operator[](std::size_t element) const { return run_of(element)->number; }

    bool operator==(const RunVector&) const = default;

    class Iterator {
     public:
        using difference_type = std::ptrdiff_t;
        using value_type = std::uint32_t;

        Iterator() = default;
        Iterator(const Run* run, std::size_t element) : run_(run), element_(element) {}
        std::uint32_t operator*() const { return run_->number; }
        Iterator& operator++() {
            run_ += ++element_ == run_->end;
            return *this;
        }
        Iterator operator++(int) {
            Iterator before = *this;
            ++*this;
            return before;
        }
        bool operator==(const Iterator& other) const { return element_ == other.element_; }

     private:
        const Run* run_ = nullptr;
        std::size_t element_ = 0;
    };
    Iterator begin() const { return {runs_.data(), 0}; }
    Iterator end() const { return {runs_.data() + runs_.size(), size()}; }

 private:
    const Run* run_of(std::size_t element) const {
        if (runs_.size() == 1) return runs_.data();
        return runs_.data() +
               (std::ranges::upper_bound(runs_, element, {}, &Run::end) - runs_.begin());
    }

    std::vector<Run> runs_;
};
static_assert(std::forward_iterator<RunVector::Iterator>);

}  // namespace bake
