// Names, which may hold anything, as text in a file that others read.
#pragma once

#include <string>
#include <string_view>

namespace common {

/// `text` in quotes, as JSON and TOML both read it. What is no UTF-8 (files and materials may be
/// named in any encoding) becomes U+FFFD, one for each longest beginning of a character.
std::string quoted_text(std::string_view text);

}  // namespace common
