// What a glTF says of its looks and the reader does not follow.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace bake {

/// One line "/json/pointer: what becomes of it" for each kind of thing, of its first place, with
/// the number of places if there are more. The JSON must be checked.
std::vector<std::string> find_unread(const nlohmann::json& root);

}  // namespace bake
