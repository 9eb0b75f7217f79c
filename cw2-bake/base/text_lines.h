// Lines and statements of OBJ and MTL text. A line ends in LF, CR or CRLF.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace bake {

inline bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

/// White space inside a line.
inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/// Without the blanks at both ends.
std::string_view trimmed(std::string_view text);

/// Takes the first word, and the blanks around it, off `text`; empty if there is none.
std::string_view take_word(std::string_view& text);

/// `text` without the double quotes around it, if there are, and the blanks inside them.
std::string_view without_quotes(std::string_view text);

/// `text` without a UTF-8 byte order mark at its start.
std::string_view without_bom(std::string_view text);

/// `text` without what programs pad files with at their end: NULs, Ctrl-Zs and white space.
std::string_view without_padding(std::string_view text);

/// Where the line that holds text[offset] ends, its line end included.
std::size_t line_end(std::string_view text, std::size_t offset);

/// The statement whose first line starts at `offset`, without its line end; lines that end in a
/// backslash are joined with the next by a blank, unless the statement is a comment. Moves
/// `offset` to the line after it.
std::string take_statement(std::string_view text, std::size_t& offset);

/// The number of the line, from 1, that holds text[offset]. Linear in `offset`: for the one message
/// of an error.
std::size_t line_number(std::string_view text, std::size_t offset);

/// Tells line numbers one after the other. Linear in the largest offset where none is below the one
/// before it.
class LineCounter {
 public:
    /// Of a text that `is_mapped`, as forget_mapped() wants it, the memory is let go of.
    explicit LineCounter(std::string_view text, bool is_mapped = false)
        : text_(text), is_mapped_(is_mapped) {}

    /// Some lines behind those known so far, the next of which starts at `offset`, need not be
    /// counted again.
    void add_counted(std::size_t lines, std::size_t offset) {
        counted_.push_back({offset, (counted_.empty() ? 1 : counted_.back().line) + lines});
    }

    /// As line_number() tells it.
    std::size_t at(std::size_t offset);

 private:
    struct Counted {
        std::size_t offset;
        std::size_t line;  // that starts there
    };

    std::string_view text_;
    bool is_mapped_;
    std::vector<Counted> counted_;
    std::size_t offset_ = 0;
    std::size_t line_ = 1;  // that holds text_[offset_]
};

/// `text` in quotes, fit for a message: shortened, and without control characters.
std::string in_quotes(std::string_view text);

}  // namespace bake
