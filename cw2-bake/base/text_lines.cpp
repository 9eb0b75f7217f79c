#include "cw2-bake/base/text_lines.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>

#include "common/every_cpu.h"
#include "common/io.h"

namespace bake {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

std::string_view take_word(std::string_view& text) {
    text = trimmed(text);
    const auto end = std::find_if(text.begin(), text.end(), is_blank);
    const std::string_view word = text.substr(0, static_cast<std::size_t>(end - text.begin()));
    text = trimmed(text.substr(word.size()));
    return word;
}

std::string_view without_quotes(std::string_view text) {
    const bool quoted = text.size() > 2 && text.front() == '"' && text.back() == '"';
    return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

std::string_view without_bom(std::string_view text) {
    return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
}

std::string_view without_padding(std::string_view text) {
    const auto is_padding = [](char c) {
        return c == '\0' || c == '\x1A' || is_blank(c) || is_line_end(c);
    };
    while (!text.empty() && is_padding(text.back())) text.remove_suffix(1);
    return text;
}

std::size_t line_end(std::string_view text, std::size_t offset) {
    while (offset < text.size() && !is_line_end(text[offset])) ++offset;
    if (offset == text.size()) return offset;
    const bool crlf = text.substr(offset, 2) == "\r\n";
    return offset + (crlf ? 2 : 1);
}

std::string take_statement(std::string_view text, std::size_t& offset) {
    std::string statement;
    for (;;) {
        const std::size_t next = line_end(text, offset);
        std::string_view line = text.substr(offset, next - offset);
        while (!line.empty() && is_line_end(line.back())) line.remove_suffix(1);
        offset = next;
        const bool comment = statement.empty() && trimmed(line).starts_with('#');
        if (!line.ends_with('\\') || comment) return statement.append(line);
        line.remove_suffix(1);
        statement.append(line).append(1, ' ');
        if (offset == text.size()) return statement;
    }
}

namespace {

/// How often `c` is in `text`. Counts in bytes, of which compilers make vectors.
CW2_EVERY_CPU std::size_t count_of(std::string_view text, char c) {
    constexpr std::size_t kLanes = 32;
    constexpr std::size_t kMostRows = 255;
    std::size_t count = 0;
    while (text.size() >= kLanes) {
        const std::size_t rows = std::min(text.size() / kLanes, kMostRows);
        std::uint8_t lanes[kLanes] = {};
        for (std::size_t row = 0; row < rows; ++row)
            for (std::size_t i = 0; i < kLanes; ++i) lanes[i] += text[row * kLanes + i] == c;
        for (const std::uint8_t lane : lanes) count += lane;
        text.remove_prefix(rows * kLanes);
    }
    return count + static_cast<std::size_t>(std::ranges::count(text, c));
}

/// How many there are in `text`; a CR before `next` LF is none.
std::size_t line_ends(std::string_view text, std::string_view next) {
    std::size_t count = count_of(text, '\n');
    for (std::size_t cr = text.find('\r'); cr != text.npos; cr = text.find('\r', cr + 1))
        count += (cr + 1 < text.size() ? text.substr(cr + 1, 1) : next) != "\n";
    return count;
}

}  // namespace

std::size_t line_number(std::string_view text, std::size_t offset) {
    return LineCounter(text).at(offset);
}

std::size_t LineCounter::at(std::size_t offset) {
    const auto behind = std::ranges::upper_bound(counted_, offset, {}, &Counted::offset);
    const Counted start = behind == counted_.begin() ? Counted{0, 1} : behind[-1];
    if (offset < offset_ || start.offset > offset_) {
        offset_ = start.offset;
        line_ = start.line;
    }
    constexpr std::size_t kBlock = 1 << 20;
    const std::size_t end = std::min(offset, text_.size());
    const auto count = [&](const tbb::blocked_range<std::size_t>& part, std::size_t lines) {
        for (std::size_t begin = part.begin(); begin < part.end(); begin += kBlock) {
            const auto block = text_.substr(begin, std::min(kBlock, part.end() - begin));
            lines += line_ends(block, text_.substr(begin + block.size(), 1));
            if (is_mapped_) common::forget_mapped(std::as_bytes(std::span(block)));
        }
        return lines;
    };
    line_ += tbb::parallel_reduce(tbb::blocked_range<std::size_t>(offset_, end, kBlock),
                                  std::size_t{0}, count, std::plus());
    offset_ = end;
    return line_;
}

std::string in_quotes(std::string_view text) {
    constexpr std::size_t kLongest = 60;
    std::string shown = "'";
    for (const char c : text.substr(0, kLongest)) {
        const auto byte = static_cast<unsigned char>(c);
        shown += byte < 0x20 || byte == 0x7F ? '?' : c;
    }
    return shown + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace bake
