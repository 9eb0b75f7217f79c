#include "cw2-bake/obj/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/decimal.h"
#include "cw2-bake/obj/left_out.h"
#include "cw2-bake/obj/plain_lines.h"

namespace bake {
namespace {

constexpr std::array<const char*, 3> kElementNames{"vertex", "texture coordinate", "normal"};

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kFullByte = 255.0f;

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

const char* word_end(const char* p) {
    while (!is_blank(*p) && !is_line_end(*p)) ++p;
    return p;
}

std::string word_at(const char* p) {
    return in_quotes({p, word_end(p)});
}

const char* skip_blanks(const char* p) {
    while (is_blank(*p)) ++p;
    return p;
}

/// What stands where a number should.
enum class Found { number, line_continues, nothing, no_number, no_finite_number };

std::string problem(Found found, const char* p) {
    if (found == Found::nothing) return "a number is missing";
    return word_at(p) +
           (found == Found::no_number ? " is not a number" : " is not a finite number");
}

/// Every pointer into the text stands before a line end, which stops all scanning; `limit_` is the
/// end of the text at hand. The functions that parse a statement return what follows its line, or
/// null if it goes on in the next line: then it is joined and parsed again.
class ChunkParser {
 public:
    ChunkParser(std::string_view text, const ObjContext& context, ObjChunk& chunk)
        : text_(text), context_(context), chunk_(chunk), plain_(text, context, chunk) {}

    void parse(std::size_t begin, std::size_t end);

 private:
    const char* statement(const char* p);
    const char* position(const char* p);
    const char* uv(const char* p);
    const char* normal(const char* p);
    void color(const char* p);
    void polypaint(const char* p);
    const char* face(const char* p);
    void other(std::string_view statement);
    void smoothing(std::string_view words);

    const char* corner(const char* p, Corner& corner);
    template <ObjAttribute attribute>
    const char* index(const char* p, std::uint32_t local_count, std::uint32_t& value);
    void bad_element(std::string what, ObjAttribute attribute);
    void bad_index(std::string what, ObjAttribute attribute, std::uint32_t& result);
    std::string out_of_range(const char* p, ObjAttribute attribute, std::uint32_t local_count);
    template <typename T>
    Found number(const char*& p, T& value) const;
    template <typename Vector>
    Found vector(const char*& p, Vector& v) const;
    void note(std::string_view kind, std::string_view word = {});
    const char* rest(const char* p);
    const char* after_line(const char* p);
    std::uint32_t triangle_count() const {
        return static_cast<std::uint32_t>(chunk_.triangles.size());
    }

    std::string_view text_;
    const ObjContext& context_;
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
                ++chunk_.line_count;
                continue;
            }
            std::size_t after = offset_;
            std::string joined = take_statement(text, after);
            joined += '\n';
            limit_ = joined.data() + joined.size();
            if (!statement(joined.data())) other({joined.data(), joined.size() - 1});
            for (; offset_ < after; offset_ = line_end(text, offset_)) ++chunk_.line_count;
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
    } else if (*p == 'f' && p[1] == 'o' && ends_word(p[2])) {
        return face(p + 2);  // an older name
    } else if (is_line_end(*p) || *p == '#') {
        if (*p == '#') polypaint(p + 1);
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

/// Moves `p` behind the number, or to what stands in its place.
template <typename T>
Found ChunkParser::number(const char*& p, T& value) const {
    p = skip_blanks(p);
    if (is_continuation(p)) return Found::line_continues;
    if (is_line_end(*p) || *p == '#') return Found::nothing;
    const char* digits = *p == '+' && p[1] != '-' ? p + 1 : p;
    const char* const end = read_decimal(digits, limit_, value);
    if (!end) return Found::no_number;
    // Microsoft's C library writes 1.#INF, -1.#IND and 1.#QNAN.
    const bool is_special =
        *end == '#' && end[-1] == '.' && std::isalpha(static_cast<unsigned char>(end[1]));
    if (!ends_word(*end) && !is_special) return Found::no_number;
    if (is_special || !std::isfinite(value)) return Found::no_finite_number;
    value += T{0};  // -0 becomes +0
    p = end;
    return Found::number;
}

template <typename Vector>
Found ChunkParser::vector(const char*& p, Vector& v) const {
    Found found = Found::number;
    for (int i = 0; i < Vector::length() && found == Found::number; ++i) found = number(p, v[i]);
    return found;
}

void ChunkParser::note(std::string_view kind, std::string_view word) {
    add_note(chunk_.notes, {std::string(kind), std::string(word), offset_, 1});
}

const char* ChunkParser::position(const char* p) {
    const char* start = p;
    glm::vec3 v;
    Found found;
    if (context_.origin == glm::dvec3(0.0)) {
        found = vector(p, v);
    } else {
        glm::dvec3 far;
        found = vector(p, far);
        v = glm::vec3(far - context_.origin) + 0.0f;  // no -0
    }
    if (found == Found::line_continues) return nullptr;
    if (found != Found::number) fail(problem(found, p));
    const char* const behind = p;
    if (!(p = rest(p))) return nullptr;
    color(behind);
    chunk_.positions.push_back(v);
    chunk_.text_bytes[kObjPosition] += static_cast<std::size_t>(p - start);
    return p;
}

const char* ChunkParser::uv(const char* p) {
    const char* start = p;
    glm::vec2 v{0.0f};
    Found found = number(p, v.x);
    if (found == Found::number) {
        found = number(p, v.y);
        if (found == Found::nothing) found = Found::number;  // one dimension
    }
    const char* const stopped = p;
    if (!(p = rest(p))) return nullptr;
    if (found != Found::number) bad_element(problem(found, stopped), kObjUv);
    chunk_.uvs.push_back(found == Found::number ? v : glm::vec2{kNaN});
    chunk_.text_bytes[kObjUv] += static_cast<std::size_t>(p - start);
    return p;
}

const char* ChunkParser::normal(const char* p) {
    const char* start = p;
    glm::vec3 v;
    const Found found = vector(p, v);
    const char* const stopped = p;
    if (!(p = rest(p))) return nullptr;
    if (found != Found::number) bad_element(problem(found, stopped), kObjNormal);
    chunk_.add_normal(found == Found::number ? v : glm::vec3{kNaN});
    chunk_.text_bytes[kObjNormal] += static_cast<std::size_t>(p - start);
    return p;
}

/// x y z r g b, the way most programs add colours, or r g b and alpha. Fewer numbers are a weight,
/// which is of no use here.
void ChunkParser::color(const char* p) {
    std::array<float, 4> values{};
    std::size_t count = 0;
    bool is_good = true;
    for (; count < values.size(); ++count) {
        const Found found = number(p, values[count]);
        if (found == Found::nothing) break;
        if (found == Found::number) continue;
        is_good = false;
        p = word_end(p);
    }
    if (count < 3) return;
    if (!is_good) return note("vertex colours that are no finite numbers are left out");
    const glm::vec3 color{values[0], values[1], values[2]};
    const auto in_range = [](float value) { return value >= 0 && value <= 1; };
    if (!std::all_of(values.begin(), values.begin() + 3, in_range)) note(kObjColorOutside);
    chunk_.colors.push_back({static_cast<std::uint32_t>(chunk_.positions.size()), color});
    if (count == 4 && values[3] != 1 && values[3] != kFullByte) {
        note("the alpha of vertex colours is left out");
    }
}

/// "#MRGB" and eight hexadecimal digits for each of some positions.
void ChunkParser::polypaint(const char* p) {
    constexpr std::string_view kMark = "MRGB ";
    for (const char c : kMark) {
        if (*p++ != c) return;
    }
    p = skip_blanks(p);
    const auto positions = static_cast<std::uint32_t>(chunk_.positions.size());
    constexpr std::ptrdiff_t kDigits = 8;
    for (const char* const end = word_end(p); end - p >= kDigits; p += kDigits) {
        std::uint32_t color = 0;
        if (std::from_chars(p, p + kDigits, color, 16).ptr != p + kDigits) return;
        chunk_.polypaint.push_back({positions, color});
    }
}

void ChunkParser::bad_element(std::string what, ObjAttribute attribute) {
    auto& first = chunk_.bad_element[attribute];
    if (!first) first = ObjError{offset_, std::move(what)};
}

/// Without its position a corner is none; without anything else it goes.
void ChunkParser::bad_index(std::string what, ObjAttribute attribute, std::uint32_t& result) {
    if (context_.known) {
        if (attribute == kObjPosition) fail(std::move(what));
        auto& first = chunk_.bad_index[attribute];
        if (!first) first = ObjError{offset_, std::move(what)};
    }
    result = kObjInvalid;
    chunk_.has_invalid = true;
}

std::string ChunkParser::out_of_range(const char* p, ObjAttribute attribute,
                                      std::uint32_t local_count) {
    const char* end = p + 1;
    while (*end >= '0' && *end <= '9') ++end;
    const std::string_view digits(p, end);
    const char* name = kElementNames[attribute];
    if (*p != '-') {
        return fmt::format("{} index {} is out of range: the file has {}", name, digits,
                           context_.total[attribute]);
    }
    return fmt::format("{} index {} is out of range: {} come before it", name, digits,
                       std::uint64_t{context_.before[attribute]} + local_count);
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
    const bool is_wild = p - digits > kSafeDigits;
    const std::uint64_t before = std::uint64_t{context_.before[attribute]} + local_count;
    if (!is_wild && value == 0) {
        bad_index(fmt::format("{} index 0: indices count from 1", kElementNames[attribute]),
                  attribute, result);
    } else if (is_wild || value > (relative ? before : context_.total[attribute])) {
        bad_index(out_of_range(start, attribute, local_count), attribute, result);
    } else if (relative) {
        result = kObjRelative + kObjRelativeBias + local_count - static_cast<std::uint32_t>(value);
        chunk_.has_relative = true;
    } else {
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
        chunk_.lacks_normals |= current.normal >= kObjInvalid;
        if (count == 0) first = current;
        if (count >= 2) chunk_.triangles.push_back({first, previous, current});
        previous = current;
    }
    if (count < 3) note("a face of fewer than three corners is left out");
    if (count > 3) chunk_.polygons.push_back({first_triangle, count});
    p = after_line(p);
    chunk_.text_bytes[kObjFaceText] += static_cast<std::size_t>(p - start);
    return p;
}

/// Without a word it is on: so ZBrush writes it.
void ChunkParser::smoothing(std::string_view words) {
    const std::string_view word = take_word(words);
    std::uint32_t group = 0;
    if (word.empty() || word.starts_with('#') || word == "on") {
        group = 1;
    } else if (word != "off") {
        const auto [end, error] = std::from_chars(word.begin(), word.end(), group);
        if (error != std::errc() || end != word.end()) {
            return note("what is no smoothing group leaves smoothing as it was", in_quotes(word));
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
    } else if (const auto left_out = obj_left_out(keyword, words)) {
        note(left_out->kind, left_out->word);
    }
}

}  // namespace

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
                     const ObjContext& context, ObjChunk& chunk) {
    ChunkParser(text, context, chunk).parse(begin, end);
}

}  // namespace bake
