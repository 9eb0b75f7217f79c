#include "common/quoted_text.h"

#include <cstddef>

namespace common {

namespace {

struct Sequence {
    std::size_t length;
    bool is_character;
};

/// What `text`, which is not empty, begins with: a character or, if none does, the longest
/// beginning of one, at least one byte. (Unicode 15, table 3-7.)
Sequence first_of(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return {1, true};
    if (lead < 0xC2 || lead > 0xF4) return {1, false};
    const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    // Neither longer than needed, nor half of a surrogate pair, nor beyond U+10FFFF.
    unsigned char low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
    unsigned char high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
    std::size_t i = 1;
    for (; i < length && i < text.size() && byte(i) >= low && byte(i) <= high; ++i) {
        low = 0x80;
        high = 0xBF;
    }
    return {i, i == length};
}

}  // namespace

std::string quoted_text(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string result = "\"";
    while (!text.empty()) {
        const Sequence sequence = first_of(text);
        const char c = text.front();
        const auto byte = static_cast<unsigned char>(c);
        if (!sequence.is_character) {
            result += "\xEF\xBF\xBD";
        } else if (byte < 0x20 || byte == 0x7F) {
            result += "\\u00";
            result += kDigits[byte / 16];
            result += kDigits[byte % 16];
        } else {
            if (c == '"' || c == '\\') result += '\\';
            result += text.substr(0, sequence.length);
        }
        text.remove_prefix(sequence.length);
    }
    return result + '"';
}

}  // namespace common
