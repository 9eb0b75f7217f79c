// Decimal numbers of a text.
#pragma once

#include <fast_float/fast_float.h>

#include <system_error>

namespace bake {

/// Reads the number at `begin`, of what is before `end`; one that is too large for T is infinite,
/// one that is too small is 0. Returns the place behind it, or null where there is none.
template <typename T>
const char* read_decimal(const char* begin, const char* end, T& value) {
    const auto [behind, error] = fast_float::from_chars(begin, end, value);
    // From its version 5 on, the library calls out of range what it has set to infinity or 0.
    const bool is_number = error == std::errc() || error == std::errc::result_out_of_range;
    return is_number ? behind : nullptr;
}

}  // namespace bake
