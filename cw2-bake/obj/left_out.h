// The statements of an OBJ that are not read.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bake {

struct ObjLeftOut {
    std::string kind;  ///< what a warning says, see ObjNote
    std::string word;
};

/// What is lost with a statement that is not read; none if it changes nothing that is drawn.
std::optional<ObjLeftOut> obj_left_out(std::string_view keyword, std::string_view words);

}  // namespace bake
