#include "cw2-bake/obj/plain_lines.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "common/every_cpu.h"

namespace bake {
namespace {

/// Finds the ends of runs of digits.
class RunEnds {
 public:
    CW2_INLINE RunEnds(std::string_view text, const char* p)
        : first_(text.data()), size_(text.size()) {
        look(p);
    }

    /// Bit i tells whether p[i] is no digit, for kReach bytes; so do 64 bits, of which at least
    /// three are set. `p` never goes back.
    CW2_INLINE std::uint64_t from(const char* p) {
        if (static_cast<std::size_t>(p - base_) > kDigitWindow - kReach) look(p);
        return others_ >> (p - base_) | kStop;
    }

    /// Of the longest word that is read: three runs, what follows each.
    static constexpr std::size_t kReach = 3 * (kMaxDigits + 1);

 private:
    CW2_INLINE void look(const char* p) {
        // Eight bytes before the end of a run are read too.
        const auto offset = static_cast<std::size_t>(p - first_) - 8;
        base_ = p;
        others_ = size_ > kDigitWindow + 8 && offset < size_ - kDigitWindow - 8 ? non_digits(p) : 0;
    }

    // Too far off to end a run that is short enough.
    static constexpr std::uint64_t kStop = 7ull << 61;
    const char* const first_;
    const std::size_t size_;
    const char* base_;
    std::uint64_t others_;
};

/// The last of the blanks after a keyword that ends at `p`.
CW2_INLINE const char* after_keyword(const char* p) {
    while (*p == ' ' && p[1] == ' ') ++p;
    return p;
}

/// What follows the line whose words end at `p`; null if there are more words.
CW2_INLINE const char* after_line(const char* p) {
    while (*p == ' ') ++p;
    if (*p == '\n') return p + 1;
    return *p == '\r' && p[1] == '\n' ? p + 2 : nullptr;
}

/// Reads a blank and "-12.345678" or a shorter decimal. Returns what follows, null if it is none or
/// if it takes more than this to round it as it must.
CW2_INLINE const char* decimal(RunEnds& ends, const char* p, float& value) {
    constexpr double kPowers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7};
    if (*p++ != ' ') return nullptr;
    const bool negative = *p == '-';
    p += negative;
    std::uint64_t others = ends.from(p);
    const char* end = p + std::countr_zero(others);
    const Digits whole{end, static_cast<std::size_t>(end - p)};
    if (whole.count - 1 >= kMaxDigits) return nullptr;
    Digits decimals{end, 0};
    if (*end == '.') {
        others &= others - 1;
        end = p + std::countr_zero(others);
        decimals = {end, static_cast<std::size_t>(end - whole.end - 1)};
        if (decimals.count > kMaxDigits) return nullptr;
    }
    // At most 14 digits are exact as a double, so one division rounds them once. Rounding again, to
    // float, does no harm: k / 10^7 is halfway between two floats or 2^-18 of their distance off,
    // a double 2^-30.
    const auto [units, fraction] = values_of(whole, decimals);
    const double power = kPowers[decimals.count];
    const double magnitude = (units * power + fraction) / power;
    value = static_cast<float>(negative ? -magnitude : magnitude) + 0.0f;  // -0 becomes +0
    return end;
}

/// Reads a blank and v, v/vt, v//vn or v/vt/vn, in the order of Corner. Returns what follows, null
/// if it is none of these.
CW2_INLINE const char* corner(RunEnds& ends, const char* p, Four& indices) {
    if (*p++ != ' ') return nullptr;
    std::uint64_t others = ends.from(p);
    const auto run_from = [&](const char* begin) {
        const char* const end = p + std::countr_zero(others);
        others &= others - 1;
        return Digits{end, static_cast<std::size_t>(end - begin)};
    };
    const Digits position = run_from(p);
    if (position.count - 1 >= kMaxDigits || *p == '0') return nullptr;
    Digits uv{position.end, 0}, normal{position.end, 0};
    const char* end = position.end;
    if (*end == '/') {
        const char* const begin = end + 1;
        uv = run_from(begin);
        if (uv.count > kMaxDigits || *begin == '0') return nullptr;
        end = uv.end;
    }
    if (*end == '/') {
        const char* const begin = end + 1;
        normal = run_from(begin);
        if (normal.count > kMaxDigits || *begin == '0') return nullptr;
        end = normal.end;
    }
    indices = values_of(position, normal, uv);
    return end;
}

CW2_INLINE Four larger(Four a, Four b) {
    return a > b ? a : b;
}

/// Of indices from 1, 0 where there is none.
CW2_INLINE void push_triangle(RawVector<ObjTriangle>& triangles, Four a, Four b, Four c) {
    static_assert(kAbsent + 1 == 0);
    a -= 1, b -= 1, c -= 1;
    Corner* const corners = triangles.emplace_back().data();
    // Each but the last may write a bit too much.
    std::memcpy(static_cast<void*>(corners), &a, sizeof a);
    std::memcpy(static_cast<void*>(corners + 1), &b, sizeof b);
    std::memcpy(static_cast<void*>(corners + 2), &c, sizeof(Corner));
}

}  // namespace

PlainLines::PlainLines(std::string_view text, const ObjContext& context, ObjChunk& chunk)
    : text_(text), chunk_(chunk), reads_positions_(context.origin == glm::dvec3(0.0)) {
    const auto limit = [&](ObjAttribute attribute) {
        return static_cast<std::int32_t>(context.total[attribute]);
    };
    limit_ = Four{limit(kObjPosition), limit(kObjNormal), limit(kObjUv), 0};
}

template <typename Vector>
CW2_INLINE const char* PlainLines::vector(const char* p, Vector& v) const {
    RunEnds ends(text_, p + 1);
    for (int i = 0; i < Vector::length(); ++i) {
        if (!(p = decimal(ends, p, v[i]))) return nullptr;
    }
    return after_line(p);
}

CW2_INLINE const char* PlainLines::position(const char* p) {
    glm::vec3 v;
    if ((p = vector(p, v))) chunk_.positions.push_back(v);
    return p;
}

CW2_INLINE const char* PlainLines::uv(const char* p) {
    glm::vec2 v;
    if ((p = vector(p, v))) chunk_.uvs.push_back(v);
    return p;
}

CW2_INLINE const char* PlainLines::normal(const char* p) {
    glm::vec3 v;
    if ((p = vector(p, v))) chunk_.add_normal(v);
    return p;
}

CW2_INLINE const char* PlainLines::face(const char* p) {
    RunEnds ends(text_, p + 1);
    Four a, b, c;
    if (!(p = corner(ends, p, a)) || !(p = corner(ends, p, b)) || !(p = corner(ends, p, c))) {
        return nullptr;
    }
    Four max = larger(larger(max_, a), larger(b, c));
    Four absent = absent_ | (a == 0) | (b == 0) | (c == 0);
    const std::size_t first = chunk_.triangles.size();
    push_triangle(chunk_.triangles, a, b, c);
    const char* next;
    while (!(next = after_line(p))) {
        b = c;
        if (!(p = corner(ends, p, c))) break;
        max = larger(max, c);
        absent |= c == 0;
        push_triangle(chunk_.triangles, a, b, c);
    }
    if (!p || any(max > limit_)) {
        chunk_.triangles.resize(first);
        return nullptr;
    }
    const std::size_t count = chunk_.triangles.size() - first;
    if (count > 1) {
        chunk_.polygons.push_back(
            {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count + 2)});
    }
    max_ = max;
    absent_ = absent;
    return next;
}

/// Returns what follows the line; null if it is not read.
CW2_INLINE const char* PlainLines::line(const char* p) {
    const char* const start = p;
    std::size_t kind;
    if (*p == 'f') {
        p = face(after_keyword(p + 1));
        kind = kObjFaceText;
    } else if (*p == 'v' && p[1] == 't') {
        p = uv(after_keyword(p + 2));
        kind = kObjUv;
    } else if (*p == 'v' && p[1] == 'n') {
        p = normal(after_keyword(p + 2));
        kind = kObjNormal;
    } else if (*p == 'v' && reads_positions_) {
        p = position(after_keyword(p + 1));
        kind = kObjPosition;
    } else {
        return nullptr;
    }
    if (p) chunk_.text_bytes[kind] += static_cast<std::size_t>(p - start);
    return p;
}

std::size_t PlainLines::read(std::size_t begin, std::size_t end) {
    const char* p = text_.data() + begin;
    while (p < text_.data() + end) {
        const char* const next = line(p);
        if (!next) break;
        p = next;
        ++chunk_.line_count;
    }
    return static_cast<std::size_t>(p - text_.data());
}

void PlainLines::finish() {
    chunk_.lacks_normals |= absent_[1] != 0;
    const auto raise = [&](ObjAttribute attribute, std::int32_t index) {
        std::uint32_t& max = chunk_.max_index[attribute];
        max = std::max(max, static_cast<std::uint32_t>(index));
    };
    raise(kObjPosition, max_[0]);
    raise(kObjNormal, max_[1]);
    raise(kObjUv, max_[2]);
}

}  // namespace bake
