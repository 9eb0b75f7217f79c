// Errors and warnings of the bake.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace bake {

/// What cannot be baked; what() is one line "PATH:LINE: what is wrong" (or "PATH: ...").
class BakeError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Takes one line "PATH:LINE: what is odd". May throw BakeError (under --strict). Called from one
/// thread at a time.
using Warn = std::function<void(const std::string&)>;

}  // namespace bake
