// TBB as far as this project uses it, by std::thread: for the preset check (see CONTRIBUTING.md).
#pragma once

#include <array>
#include <functional>

#include "global_control.h"

namespace tbb {

template <typename... Tasks>
void parallel_invoke(const Tasks&... tasks) {
    const std::array<std::function<void()>, sizeof...(Tasks)> all = {std::cref(tasks)...};
    run_all(all.size(), [&](std::size_t i) { all[i](); });
}

}  // namespace tbb
