// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include <cstddef>

namespace tbb {

template <typename Index>
class blocked_range {
 public:
    blocked_range(Index begin, Index end, std::size_t grain = 1)
        : begin_(begin), end_(end), grain_(grain) {}
    Index begin() const { return begin_; }
    Index end() const { return end_; }

    std::size_t piece_count() const {
        return (static_cast<std::size_t>(end_ - begin_) + grain_ - 1) / grain_;
    }
    blocked_range piece(std::size_t i) const {
        const Index first = begin_ + static_cast<Index>(i * grain_);
        const bool is_last = i + 1 == piece_count();
        return {first, is_last ? end_ : first + static_cast<Index>(grain_), grain_};
    }

 private:
    Index begin_, end_;
    std::size_t grain_;
};

}  // namespace tbb
