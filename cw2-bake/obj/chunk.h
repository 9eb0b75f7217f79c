// What a piece of OBJ text states, as arrays that can be strung together.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/source_scene.h"

namespace bake {

/// The indices of a face's corner, in the order in which a corner states them.
enum ObjAttribute { kObjPosition, kObjUv, kObjNormal };
using ObjCounts = std::array<std::uint32_t, 3>;  ///< by ObjAttribute

/// While a piece is parsed with no knowledge of the rest, indices are checked only against these.
inline constexpr std::uint32_t kMaxObjElements = 0x7FFF'FFFF;
inline constexpr std::uint32_t kMaxObjDistance = 0x2000'0000;

/// What is known of the rest of the text when a piece is parsed: what indices may refer to, the
/// elements before the piece and in the whole file, and where the scene lies.
struct ObjContext {
    ObjCounts before{kMaxObjDistance, kMaxObjDistance, kMaxObjDistance};
    ObjCounts total{kMaxObjElements, kMaxObjElements, kMaxObjElements};
    bool known = false;  ///< so that what is out of range can be reported
    /// Subtracted from positions, in double; they are read faster where it is 0.
    glm::dvec3 origin{0.0};
};

/// An index that is out of range whatever the rest of the text holds.
inline constexpr std::uint32_t kObjInvalid = kAbsent - 1;

/// An index of a corner that counts back from the elements stated so far is held as
/// kObjRelative + kObjRelativeBias + its place from the start of the piece's own elements.
inline constexpr std::uint32_t kObjRelative = 0x8000'0000;
inline constexpr std::uint32_t kObjRelativeBias = 0x4000'0000;

/// A face of more than three corners: `corner_count - 2` triangles, a fan about its first corner.
struct ObjPolygon {
    std::uint32_t first_triangle;
    std::uint32_t corner_count;
};

/// From `first_triangle` on, this material is in use.
struct ObjMaterialUse {
    std::uint32_t first_triangle = 0;
    std::optional<std::string> name;  ///< none before the first `usemtl`
    std::size_t offset = 0;           ///< of the statement in the text
};

/// From `first_triangle` on, this smoothing group is in use.
struct ObjSmoothingUse {
    std::uint32_t first_triangle;
    std::uint32_t group;
};

/// A statement kept as text: `words` is what follows its keyword.
struct ObjStatement {
    std::size_t offset;
    std::string words;
};

struct ObjError {
    std::size_t offset;  ///< of the statement
    std::string what;
};

/// What is left out or odd, and how often.
struct ObjNote {
    std::string kind;    ///< what a message says of all
    std::string word;    ///< of the first, if it helps
    std::size_t offset;  ///< of the first one's statement
    std::size_t count;
};

/// Counts it with those of its kind.
void add_note(std::vector<ObjNote>& notes, const ObjNote& note);

/// What a `v` line states behind the position.
struct ObjColor {
    std::uint32_t position;  ///< index from 0, from the start of the piece's own
    glm::vec3 color;         ///< as stated
};

/// The kind of note of a colour that is not in [0, 1].
inline constexpr const char* kObjColorOutside = "vertex colours outside 0 to 1 are clamped";

/// One colour of a ZBrush comment, which belongs to one of the last positions before it: the last
/// colour of successive comments to the last position.
struct ObjPolypaint {
    std::uint32_t positions;  ///< of the piece, before the comment
    std::uint32_t color;      ///< 0xMMRRGGBB, M being ZBrush's mask
};

using ObjTriangle = std::array<Corner, 3>;

/// Where ObjChunk::text_bytes counts faces; attributes are counted by ObjAttribute.
inline constexpr std::size_t kObjFaceText = 3;

struct ObjChunk {
    /// Scaled to length 1, or NaN where it has none.
    void add_normal(const glm::vec3& v) {
        const double x = v.x, y = v.y, z = v.z;
        const double length = std::sqrt(x * x + y * y + z * z);
        has_zero_normal |= length == 0;
        normals.push_back(glm::vec3(x / length, y / length, z / length) + 0.0f);
    }

    std::vector<glm::vec3> positions;
    std::vector<glm::vec2> uvs;      ///< NaN where the line holds no finite number
    std::vector<glm::vec3> normals;  ///< of length 1; or NaN, in the same way or of length 0
    std::vector<ObjColor> colors;
    std::vector<ObjPolypaint> polypaint;
    /// Indices are from 0 or relative, see kObjRelative; or kObjInvalid.
    RawVector<ObjTriangle> triangles;
    std::vector<ObjPolygon> polygons;
    std::vector<ObjMaterialUse> material_uses;
    std::vector<ObjSmoothingUse> smoothing_uses;
    std::vector<ObjStatement> libraries;
    std::vector<ObjNote> notes;
    /// By ObjAttribute: the first line of a UV or a normal that is no finite number, and, where the
    /// bounds are known, the first index of one that is out of range.
    std::array<std::optional<ObjError>, 3> bad_element, bad_index;
    ObjCounts max_index{};                    ///< the largest that is not relative, from 1
    std::array<std::size_t, 4> text_bytes{};  ///< of v, vt, vn and f lines; see kObjFaceText
    std::size_t line_count = 0;
    bool has_relative = false;
    bool has_zero_normal = false;   ///< some is NaN for that
    bool has_invalid = false;       ///< some index is kObjInvalid
    bool lacks_normals = false;     ///< some corner states no normal, or some normal is 0
    std::optional<ObjError> error;  ///< the first one; nothing after it is read

    /// Empties everything and keeps the memory.
    void clear();
};

}  // namespace bake
