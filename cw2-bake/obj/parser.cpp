#include "cw2-bake/obj/parser.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/plain_lines.h"

namespace bake {
namespace {

constexpr std::array<const char*, 3> kElementNames{"vertex", "texture coordinate", "normal"};

/// What is wrong with the statement at hand; does not leave this file.
struct Failure {
    std::string what;
};

[[noreturn]] void fail(std::string what) {
    throw Failure{std::move(what)};
}

bool ends_word(char c) {
    return is_blank(c) || is_line_end(c) || c == '#' || c == '\\';
}

bool is_continuation(const char* p) {
    return *p == '\\' && is_line_end(p[1]);
}

std::string word_at(const char* p) {
    const char* end = p;
    while (!is_blank(*end) && !is_line_end(*end)) ++end;
    return in_quotes({p, end});
}

const char* skip_blanks(const char* p) {
    while (is_blank(*p)) ++p;
    return p;
}

/// Every pointer into the text stands before a line end, which stops all scanning; `limit_` is the
/// end of the text at hand. The functions that parse a statement return what follows its line, or
/// null if it goes on in the next line: then it is joined and parsed again.
class ChunkParser {
 public:
    ChunkParser(std::string_view text, const ObjIndexBounds& bounds, ObjChunk& chunk)
        : text_(text), bounds_(bounds), chunk_(chunk), plain_(text, bounds, chunk) {}

    void parse(std::size_t begin, std::size_t end);

 private:
    const char* statement(const char* p);
    const char* position(const char* p);
    const char* uv(const char* p);
    const char* normal(const char* p);
    const char* face(const char* p);
    void other(std::string_view statement);
    void smoothing(std::string_view words);

    const char* corner(const char* p, Corner& corner);
    template <ObjAttribute attribute>
    const char* index(const char* p, std::uint32_t local_count, std::uint32_t& value);
    [[noreturn]] void fail_range(const char* p, ObjAttribute attribute, std::uint32_t local_count);
    const char* number(const char* p, float& value);
    const char* rest(const char* p);
    const char* after_line(const char* p);
    std::uint32_t triangle_count() const {
        return static_cast<std::uint32_t>(chunk_.triangles.size());
    }

    std::string_view text_;
    const ObjIndexBounds& bounds_;
    ObjChunk& chunk_;
    PlainLines plain_;
    const char* limit_ = nullptr;
    std::size_t offset_ = 0;  // of the statement at hand
};

void ChunkParser::parse(std::size_t begin, std::size_t end) {
    const std::string_view text = text_.substr(0, end);
    // The last line of a file may lack its line end; it is copied like a continued one.
    std::size_t whole_lines = end;
    while (whole_lines > begin && !is_line_end(text[whole_lines - 1])) --whole_lines;

    offset_ = begin;
    try {
        for (;;) {
            offset_ = plain_.read(offset_, whole_lines);
            if (offset_ == end) break;
            limit_ = text.data() + whole_lines;
            const char* next = offset_ < whole_lines ? statement(text.data() + offset_) : nullptr;
            if (next) {
                offset_ = static_cast<std::size_t>(next - text.data());
                continue;
            }
            std::size_t after = offset_;
            std::string joined = take_statement(text, after);
            joined += '\n';
            limit_ = joined.data() + joined.size();
            if (!statement(joined.data())) other({joined.data(), joined.size() - 1});
            offset_ = after;
        }
    } catch (const Failure& failure) {
        chunk_.error = ObjError{offset_, failure.what};
    }
    plain_.finish();
}

/// Null also for the keywords that other() knows.
const char* ChunkParser::statement(const char* p) {
    p = skip_blanks(p);
    if (*p == 'v') {
        if (ends_word(p[1])) return position(p + 1);
        if (p[1] == 't' && ends_word(p[2])) return uv(p + 2);
        if (p[1] == 'n' && ends_word(p[2])) return normal(p + 2);
    } else if (*p == 'f' && ends_word(p[1])) {
        return face(p + 1);
    } else if (is_line_end(*p) || *p == '#') {
        return after_line(p);
    }
    return nullptr;
}

const char* ChunkParser::after_line(const char* p) {
    while (!is_line_end(*p)) ++p;
    const bool crlf = *p == '\r' && p + 1 < limit_ && p[1] == '\n';
    return p + (crlf ? 2 : 1);
}

/// Skips what a statement may state beyond what is of use here.
const char* ChunkParser::rest(const char* p) {
    while (!is_line_end(*p)) {
        if (is_continuation(p)) return nullptr;
        if (*p == '#') break;
        ++p;
    }
    return after_line(p);
}

const char* ChunkParser::number(const char* p, float& value) {
    p = skip_blanks(p);
    if (is_continuation(p)) return nullptr;
    if (is_line_end(*p) || *p == '#') fail("a number is missing");
    const char* digits = *p == '+' && p[1] != '-' ? p + 1 : p;
    const auto [end, error] = fast_float::from_chars(digits, limit_, value);
    if (error != std::errc() || !ends_word(*end)) fail(word_at(p) + " is not a number");
    if (!std::isfinite(value)) fail(word_at(p) + " is not a finite number");
    value += 0.0f;  // -0 becomes +0
    return end;
}

const char* ChunkParser::position(const char* p) {
    const char* start = p;
    glm::vec3 v;
    if (!(p = number(p, v.x)) || !(p = number(p, v.y)) || !(p = number(p, v.z))) return nullptr;
    if (!(p = rest(p))) return nullptr;
    chunk_.positions.push_back(v);
    chunk_.text_bytes[kObjPosition] += static_cast<std::size_t>(p - start);
    return p;
}

const char* ChunkParser::uv(const char* p) {
    const char* start = p;
    glm::vec2 v{0.0f};
    if (!(p = number(p, v.x))) return nullptr;
    p = skip_blanks(p);
    const bool one_dimensional = is_line_end(*p) || *p == '#';
    if (!one_dimensional && !(p = number(p, v.y))) return nullptr;
    if (!(p = rest(p))) return nullptr;
    chunk_.uvs.push_back(v);
    chunk_.text_bytes[kObjUv] += static_cast<std::size_t>(p - start);
    return p;
}

const char* ChunkParser::normal(const char* p) {
    const char* start = p;
    glm::vec3 v;
    if (!(p = number(p, v.x)) || !(p = number(p, v.y)) || !(p = number(p, v.z))) return nullptr;
    if (!(p = rest(p))) return nullptr;
    chunk_.add_normal(v);
    chunk_.text_bytes[kObjNormal] += static_cast<std::size_t>(p - start);
    return p;
}

void ChunkParser::fail_range(const char* p, ObjAttribute attribute, std::uint32_t local_count) {
    const char* end = p + 1;
    while (*end >= '0' && *end <= '9') ++end;
    const std::string_view digits(p, end);
    const char* name = kElementNames[attribute];
    if (*p != '-') {
        fail(fmt::format("{} index {} is out of range: the file has {}", name, digits,
                         bounds_.total[attribute]));
    }
    fail(fmt::format("{} index {} is out of range: {} come before it", name, digits,
                     std::uint64_t{bounds_.before[attribute]} + local_count));
}

template <ObjAttribute attribute>
const char* ChunkParser::index(const char* p, std::uint32_t local_count, std::uint32_t& result) {
    const char* start = p;
    const bool relative = *p == '-';
    p += relative;
    const char* digits = p;
    std::uint64_t value = 0;
    for (unsigned digit; (digit = static_cast<unsigned>(*p - '0')) <= 9; ++p) {
        value = value * 10 + digit;
    }
    if (p == digits) fail(word_at(start) + " is not an index");
    constexpr std::ptrdiff_t kSafeDigits = 18;
    if (p - digits > kSafeDigits) fail_range(start, attribute, local_count);
    if (value == 0) fail(fmt::format("{} index 0: indices count from 1", kElementNames[attribute]));
    if (relative) {
        if (value > std::uint64_t{bounds_.before[attribute]} + local_count) {
            fail_range(start, attribute, local_count);
        }
        result = kObjRelative + kObjRelativeBias + local_count - static_cast<std::uint32_t>(value);
        chunk_.has_relative = true;
    } else {
        if (value > bounds_.total[attribute]) fail_range(start, attribute, local_count);
        const auto from_one = static_cast<std::uint32_t>(value);
        chunk_.max_index[attribute] = std::max(chunk_.max_index[attribute], from_one);
        result = from_one - 1;
    }
    return p;
}

/// v, v/vt, v//vn or v/vt/vn; a slash with nothing after it is let pass.
const char* ChunkParser::corner(const char* p, Corner& corner) {
    const char* start = p;
    const auto count = [](const auto& array) { return static_cast<std::uint32_t>(array.size()); };
    corner = {kAbsent, kAbsent, kAbsent};
    p = index<kObjPosition>(p, count(chunk_.positions), corner.position);
    if (*p == '/') {
        ++p;
        if (*p != '/' && !ends_word(*p)) p = index<kObjUv>(p, count(chunk_.uvs), corner.uv);
        if (*p == '/') {
            ++p;
            if (!ends_word(*p)) {
                p = index<kObjNormal>(p, count(chunk_.normals), corner.normal);
            }
        }
    }
    if (!ends_word(*p)) fail(word_at(start) + " is not a corner of a face");
    return p;
}

const char* ChunkParser::face(const char* p) {
    const char* start = p;
    const std::uint32_t first_triangle = triangle_count();
    Corner first, previous, current;
    std::uint32_t count = 0;
    for (;; ++count) {
        p = skip_blanks(p);
        if (is_line_end(*p) || *p == '#') break;
        if (is_continuation(p)) {
            chunk_.triangles.resize(first_triangle);
            return nullptr;
        }
        p = corner(p, current);
        chunk_.lacks_normals |= current.normal == kAbsent;
        if (count == 0) first = current;
        if (count >= 2) chunk_.triangles.push_back({first, previous, current});
        previous = current;
    }
    if (count < 3) chunk_.short_faces.push_back(offset_);
    if (count > 3) chunk_.polygons.push_back({first_triangle, count});
    p = after_line(p);
    chunk_.text_bytes[kObjFaceText] += static_cast<std::size_t>(p - start);
    return p;
}

void ChunkParser::smoothing(std::string_view words) {
    std::uint32_t group = 0;
    if (words == "on") {
        group = 1;
    } else if (words != "off") {
        const auto [end, error] = std::from_chars(words.begin(), words.end(), group);
        if (error != std::errc() || end != words.end()) {
            fail(in_quotes(words) + " is not a smoothing group");
        }
    }
    chunk_.smoothing_uses.push_back({triangle_count(), group});
}

void ChunkParser::other(std::string_view words) {
    const std::string_view keyword = take_word(words);
    if (keyword == "usemtl") {
        chunk_.material_uses.push_back({triangle_count(), std::string(words), offset_});
    } else if (keyword == "mtllib") {
        chunk_.libraries.push_back({offset_, std::string(words)});
    } else if (keyword == "s") {
        smoothing(words);
    } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf" || keyword == "call") {
        chunk_.unsupported.push_back({offset_, std::string(keyword)});
    }
}

}  // namespace

void ObjChunk::clear() {
    positions.clear();
    uvs.clear();
    normals.clear();
    triangles.clear();
    polygons.clear();
    material_uses.clear();
    smoothing_uses.clear();
    libraries.clear();
    unsupported.clear();
    short_faces.clear();
    max_index = {};
    text_bytes = {};
    has_relative = false;
    lacks_normals = false;
    error.reset();
}

std::size_t obj_chunk_end(std::string_view text, std::size_t begin, std::size_t size) {
    if (size >= text.size() - begin) return text.size();
    std::size_t end = begin + size - 1;
    for (;;) {
        while (end < text.size() && !is_line_end(text[end])) ++end;
        const bool continued = end > begin && text[end - 1] == '\\';
        end = line_end(text, end);
        if (end == text.size() || !continued) return end;
    }
}

void parse_obj_chunk(std::string_view text, std::size_t begin, std::size_t end,
                     const ObjIndexBounds& bounds, ObjChunk& chunk) {
    ChunkParser(text, bounds, chunk).parse(begin, end);
}

}  // namespace bake
