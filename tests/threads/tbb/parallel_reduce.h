// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include "blocked_range.h"
#include "global_control.h"

namespace tbb {

template <typename Range, typename Value, typename Body, typename Join>
Value parallel_reduce(const Range& range, const Value& identity, const Body& body,
                      const Join& join) {
    std::vector<Value> parts(range.piece_count(), identity);
    run_all(parts.size(), [&](std::size_t i) { parts[i] = body(range.piece(i), identity); });
    Value result = identity;
    for (const Value& part : parts) result = join(result, part);
    return result;
}

}  // namespace tbb
