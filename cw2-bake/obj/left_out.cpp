#include "cw2-bake/obj/left_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "cw2-bake/base/text_lines.h"

namespace bake {
namespace {

/// Statements that are shapes, or bring some.
constexpr std::array<std::string_view, 10> kContent{"curv", "curv2", "surf", "call", "csh",
                                                    "bsp",  "bzp",   "cdc",  "cdp",  "res"};
/// Statements of how shapes look, and the words with which they change nothing.
constexpr std::array<std::string_view, 8> kStates{"bevel",      "c_interp",  "d_interp", "lod",
                                                  "shadow_obj", "trace_obj", "maplib",   "usemap"};
constexpr std::array<std::string_view, 4> kNeutral{"off", "0", "", "(null)"};
/// Names, and what only matters to statements that are warned of.
constexpr std::array<std::string_view, 17> kSilent{
    "g",    "o",    "mg",   "vp", "cstype", "deg", "bmat",  "step", "parm",
    "trim", "hole", "scrv", "sp", "end",    "con", "stech", "ctech"};

template <typename Words>
bool is_one_of(const Words& words, std::string_view word) {
    return std::ranges::find(words, word) != words.end();
}

}  // namespace

std::optional<ObjLeftOut> obj_left_out(std::string_view keyword, std::string_view words) {
    const bool neutral = is_one_of(kStates, keyword) && is_one_of(kNeutral, take_word(words));
    if (neutral || keyword.empty() || keyword.starts_with('#') || is_one_of(kSilent, keyword)) {
        return std::nullopt;
    }
    if (keyword == "l" || keyword == "p") return ObjLeftOut{"points and lines are left out", ""};
    if (is_one_of(kContent, keyword) || is_one_of(kStates, keyword)) {
        return ObjLeftOut{fmt::format("'{}' is not supported and left out", keyword), ""};
    }
    return ObjLeftOut{"statements that are not known are left out", in_quotes(keyword)};
}

}  // namespace bake
