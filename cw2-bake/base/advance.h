// How far a stage of the bake is.
#pragma once

#include <functional>

namespace bake {

/// Told how much more of a stage's work is done, as a part of all of it, by any thread.
using Advance = std::function<void(double)>;

/// For when nobody watches.
inline const Advance kUnwatched = [](double) {};

}  // namespace bake
