// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include "blocked_range.h"
#include "global_control.h"

namespace tbb {

struct simple_partitioner {};

template <typename Index, typename Body>
void parallel_for(Index begin, Index end, const Body& body, simple_partitioner = {}) {
    run_all(static_cast<std::size_t>(end - begin),
            [&](std::size_t i) { body(begin + static_cast<Index>(i)); });
}

template <typename Index, typename Body>
void parallel_for(const blocked_range<Index>& range, const Body& body, simple_partitioner = {}) {
    run_all(range.piece_count(), [&](std::size_t i) { body(range.piece(i)); });
}

}  // namespace tbb
