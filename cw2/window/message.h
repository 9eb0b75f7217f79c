// The latest thing that the window has to tell.
#pragma once

#include <chrono>
#include <string>

namespace cw2 {

struct Message {
    std::string words;  ///< empty for none
    bool is_error = false;
    /// Until when it lies over the picture where there is no panel.
    std::chrono::steady_clock::time_point until{};

    bool passes() const { return !words.empty() && std::chrono::steady_clock::now() < until; }
};

}  // namespace cw2
