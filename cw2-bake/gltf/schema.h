// What the reader relies on in the JSON of a glTF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace bake {

enum class JsonKind : std::uint8_t {
    index,    ///< into the top-level array `target`
    count,    ///< 0 .. kLargestCount
    small,    ///< 0 .. kLargestInt: where tinygltf has an int, and cuts off what does not fit
    number,   ///< finite
    numbers,  ///< an array of `length` numbers, or of any if that is 0
    boolean,
    text,
    object,   ///< of `members`
    objects,  ///< an array of such
    indices,  ///< an array of indices
    lookup,   ///< an object whose members are indices
    lookups,  ///< an array of such
    ids,      ///< an object whose members are of kind small
    texts,    ///< an array of texts
};

struct JsonMember {
    const char* name;
    JsonKind kind;
    bool required = false;
    const char* target = nullptr;
    std::size_t length = 0;
    std::span<const JsonMember> members{};
};

/// The members of the whole file but `asset`.
std::span<const JsonMember> gltf_schema();

}  // namespace bake
