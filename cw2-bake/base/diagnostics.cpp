#include "cw2-bake/base/diagnostics.h"

#include <fmt/format.h>

#include <cctype>
#include <string_view>

namespace bake {
namespace {

constexpr std::size_t kPassedOn = 10;

bool is_in_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

/// Without digits, and without what is quoted; an apostrophe within a word is no quote.
std::string kind_of(std::string_view warning) {
    warning = warning.substr(0, warning.find("; "));
    std::string kind;
    bool in_quotes = false;
    for (std::size_t i = 0; i < warning.size(); ++i) {
        const char c = warning[i];
        if (c == '\'') {
            const bool opens = i == 0 || warning[i - 1] == ' ' || warning[i - 1] == '(';
            const bool closes = i + 1 == warning.size() || !is_in_word(warning[i + 1]);
            if (in_quotes ? closes : opens) in_quotes = !in_quotes;
        }
        if (!in_quotes && (c < '0' || c > '9')) kind += c;
    }
    const std::size_t place = kind.rfind(": ");
    return place == kind.npos ? kind : kind.substr(place + 2);
}

}  // namespace

void WarningFilter::take(const std::string& warning) {
    Kind& kind = kinds_[kind_of(warning)];
    if (++kind.count <= kPassedOn) return warn_(warning);
    if (kind.count == kPassedOn + 1) kind.eleventh = warning;
}

void WarningFilter::tell_rest() const {
    for (const auto& [name, kind] : kinds_) {
        if (kind.count <= kPassedOn) continue;
        const std::size_t more = kind.count - kPassedOn;
        warn_(more == 1 ? kind.eleventh
                        : fmt::format("{} (and {} more of this kind)", kind.eleventh, more - 1));
    }
}

}  // namespace bake
