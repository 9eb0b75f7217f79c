#include "cw2-bake/base/diagnostics.h"

#include <fmt/format.h>

#include <string_view>

namespace bake {
namespace {

constexpr std::size_t kPassedOn = 10;

std::string kind_of(std::string_view warning) {
    std::string kind;
    bool in_quotes = false;
    for (const char c : warning.substr(0, warning.find("; "))) {
        if (c == '\'') in_quotes = !in_quotes;
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
