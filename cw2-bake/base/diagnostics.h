// Errors and warnings of the bake.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
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

/// Passes on ten warnings of a kind and counts the others. Two are of one kind if they differ only
/// in where, in numbers, in what is quoted, and in what stands behind a semicolon.
class WarningFilter {
 public:
    /// `warn` must outlive this.
    explicit WarningFilter(const Warn& warn) : warn_(warn) {}

    /// What passes on and counts; as long as this lives.
    Warn filtered() {
        return [this](const std::string& warning) { take(warning); };
    }
    /// Warns of those that were counted: how many there were, and the first of them.
    void tell_rest() const;

 private:
    void take(const std::string& warning);

    struct Kind {
        std::size_t count = 0;
        std::string eleventh;
    };
    const Warn& warn_;
    std::map<std::string, Kind> kinds_;
};

}  // namespace bake
