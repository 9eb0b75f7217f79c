#include "cw2-bake/obj/assembly.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <span>
#include <unordered_map>
#include <utility>

#include "common/io.h"
#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/mending.h"
#include "cw2-bake/obj/parser.h"
#include "cw2-bake/obj/vertex_colors.h"

namespace bake {
namespace {

/// A triangle's corners are counted in 32 bits.
constexpr std::size_t kMaxTriangles = 0xFFFF'FFFFu / 3;

[[noreturn]] void throw_at(std::string_view text, const std::string& name, const ObjError& error) {
    throw BakeError(
        fmt::format("{}:{}: {}", name, LineCounter(text, true).at(error.offset), error.what));
}

/// Appends, and makes room as if the rest of the text held nothing else, so that growing never
/// copies; room that stays untouched costs no memory.
template <typename T>
void append(std::vector<T>& all, std::span<const T> more, std::size_t more_text_bytes,
            std::size_t text_bytes_left) {
    if (all.capacity() - all.size() < more.size()) {
        const double elements_per_byte =
            static_cast<double>(more.size()) / static_cast<double>(more_text_bytes);
        const auto expected = static_cast<std::size_t>(elements_per_byte *
                                                       static_cast<double>(text_bytes_left) * 1.1);
        all.reserve(std::max(all.size() + more.size() + expected, all.size() * 3 / 2));
        prefer_huge_pages(all.data(), all.capacity() * sizeof(T));
    }
    all.insert(all.end(), more.data(), more.data() + more.size());
}

template <typename T>
std::uint32_t count32(const std::vector<T>& array) {
    return static_cast<std::uint32_t>(array.size());
}

std::span<const Corner> corners_of(const ObjChunk& chunk) {
    static_assert(sizeof(ObjTriangle) == 3 * sizeof(Corner));
    return {reinterpret_cast<const Corner*>(chunk.triangles.data()), chunk.triangles.size() * 3};
}

ObjCounts counts_of(const SourceScene& scene) {
    return {count32(scene.positions), count32(scene.uvs), count32(scene.normals)};
}

/// Takes the chunks in the order of the text.
class Assembly {
 public:
    Assembly(std::string_view text, const std::string& name) : text_(text), name_(name) {
        contents_.lines = LineCounter(text, true);
    }

    /// The chunk of the text from `begin` to `end`.
    void append_chunk(ObjChunk& chunk, std::size_t begin, std::size_t end);
    ObjContents finish() &&;

 private:
    void append_arrays(const ObjChunk& chunk, std::size_t text_bytes_left);
    void append_colors(const ObjChunk& chunk, std::size_t first_position);
    void append_materials(const ObjChunk& chunk);
    void append_notes(ObjChunk& chunk, std::size_t text_bytes_left);
    template <typename T>
    void add_bad(ObjAttribute attribute, bool some_are_bad, const std::vector<T>& elements,
                 std::size_t first);
    bool resolve(ObjChunk& chunk) const;
    std::uint32_t material_in_use();
    bool all_in_range(ObjAttribute attribute) const;
    bool is_good(ObjAttribute attribute) const;
    void mend();
    template <typename T>
    void mend(ObjAttribute attribute, std::uint32_t Corner::*index, std::vector<T>& elements);
    struct Face {
        std::size_t offset;  // of its statement
        ObjChunk parsed;
    };
    Face parse_face(std::size_t triangle) const;
    void warn_of_missing(ObjAttribute attribute, std::size_t count, std::size_t first_triangle);

    std::string_view text_;
    const std::string& name_;
    ObjContents contents_;
    struct PieceStart {
        std::size_t offset;  // in the text
        std::size_t first_triangle;
        ObjCounts before;
    };
    std::vector<PieceStart> pieces_;
    ObjCounts max_index_{};
    std::unordered_map<std::optional<std::string>, std::uint32_t> material_ids_;
    ObjMaterialUse material_use_{};
    std::uint32_t material_id_ = kAbsent;  // of material_use_, once a face uses it
    VertexColors colors_;
    std::vector<ObjNote> notes_;
    bool has_invalid_ = false;
    std::array<std::optional<ObjError>, 3> bad_element_;
    std::array<std::vector<std::uint32_t>, 3> bad_;  // elements that are NaN, ascending
};

/// The chunk's relative indices become indices from 0, or kObjInvalid. False if some do.
bool Assembly::resolve(ObjChunk& chunk) const {
    const ObjCounts before = counts_of(contents_.scene);
    bool good = true;
    const auto resolve_index = [&](std::uint32_t& index, ObjAttribute attribute) {
        if (index >= kObjInvalid || index < kObjRelative) return;
        const std::uint64_t place = std::uint64_t{before[attribute]} + (index - kObjRelative);
        const bool in_range = place >= kObjRelativeBias;
        index = in_range ? static_cast<std::uint32_t>(place - kObjRelativeBias) : kObjInvalid;
        good &= in_range;
    };
    for (ObjTriangle& triangle : chunk.triangles) {
        for (Corner& corner : triangle) {
            resolve_index(corner.position, kObjPosition);
            resolve_index(corner.uv, kObjUv);
            resolve_index(corner.normal, kObjNormal);
        }
    }
    return good;
}

void Assembly::append_chunk(ObjChunk& chunk, std::size_t begin, std::size_t end) {
    if (chunk.error) throw_at(text_, name_, *chunk.error);
    const SourceScene& scene = contents_.scene;
    pieces_.push_back({begin, scene.corners.size() / 3, counts_of(scene)});
    contents_.lines.add_counted(chunk.line_count, end);
    const std::size_t text_bytes_left = text_.size() - end;
    has_invalid_ |= chunk.has_invalid;
    add_bad(kObjUv, chunk.bad_element[kObjUv].has_value(), chunk.uvs, scene.uvs.size());
    add_bad(kObjNormal, chunk.bad_element[kObjNormal] || chunk.has_zero_normal, chunk.normals,
            scene.normals.size());
    if (chunk.has_relative && !resolve(chunk)) has_invalid_ = true;
    append_materials(chunk);
    append_notes(chunk, text_bytes_left);
    append_arrays(chunk, text_bytes_left);
}

void Assembly::append_arrays(const ObjChunk& chunk, std::size_t text_bytes_left) {
    SourceScene& scene = contents_.scene;
    append_colors(chunk, scene.positions.size());
    const auto& bytes = chunk.text_bytes;
    append<glm::vec3>(scene.positions, chunk.positions, bytes[kObjPosition], text_bytes_left);
    append<glm::vec2>(scene.uvs, chunk.uvs, bytes[kObjUv], text_bytes_left);
    append<glm::vec3>(scene.normals, chunk.normals, bytes[kObjNormal], text_bytes_left);
    append<Corner>(scene.corners, corners_of(chunk), bytes[kObjFaceText], text_bytes_left);
    const bool too_many =
        scene.positions.size() > kMaxObjElements || scene.uvs.size() > kMaxObjElements ||
        scene.normals.size() > kMaxObjElements || scene.corners.size() / 3 > kMaxTriangles;
    if (too_many) throw BakeError(name_ + ": has more elements than 32 bits can count");
    for (std::size_t i = 0; i < max_index_.size(); ++i) {
        max_index_[i] = std::max(max_index_[i], chunk.max_index[i]);
    }
}

/// Of a chunk's elements, which start at `first`.
template <typename T>
void Assembly::add_bad(ObjAttribute attribute, bool some_are_bad, const std::vector<T>& elements,
                       std::size_t first) {
    for (std::size_t i = 0; some_are_bad && i < elements.size(); ++i)
        if (std::isnan(elements[i].x))
            bad_[attribute].push_back(static_cast<std::uint32_t>(first + i));
}

void Assembly::append_colors(const ObjChunk& chunk, std::size_t first_position) {
    for (const ObjColor& color : chunk.colors) {
        colors_.set(first_position + color.position, color.color);
    }
    for (const ObjPolypaint& paint : chunk.polypaint) {
        colors_.paint(first_position + paint.positions, paint.color);
    }
}

std::uint32_t Assembly::material_in_use() {
    if (material_id_ == kAbsent) {
        auto& names = contents_.material_names;
        const auto [entry, is_new] = material_ids_.try_emplace(material_use_.name, count32(names));
        if (is_new) {
            names.push_back(material_use_.name.value_or(""));
            auto& offset = contents_.material_offsets.emplace_back();
            if (material_use_.name) offset = material_use_.offset;
        }
        material_id_ = entry->second;
    }
    return material_id_;
}

void Assembly::append_materials(const ObjChunk& chunk) {
    auto& triangle_material = contents_.scene.triangle_material;
    const std::size_t base = triangle_material.size();
    const auto use_until = [&](std::size_t end) {
        if (base + end > triangle_material.size())
            triangle_material.extend(base + end, material_in_use());
    };
    for (const ObjMaterialUse& use : chunk.material_uses) {
        use_until(use.first_triangle);
        material_use_ = use;
        material_id_ = kAbsent;
    }
    use_until(chunk.triangles.size());
}

void Assembly::append_notes(ObjChunk& chunk, std::size_t text_bytes_left) {
    const auto first_triangle = static_cast<std::uint32_t>(contents_.scene.corners.size() / 3);
    for (ObjPolygon& polygon : chunk.polygons) polygon.first_triangle += first_triangle;
    append<ObjPolygon>(contents_.polygons, chunk.polygons, chunk.text_bytes[kObjFaceText],
                       text_bytes_left);
    for (ObjSmoothingUse use : chunk.smoothing_uses) {
        use.first_triangle += first_triangle;
        contents_.smoothing_uses.push_back(use);
    }
    for (const ObjNote& note : chunk.notes) add_note(notes_, note);
    for (std::size_t i = 0; i < bad_element_.size(); ++i) {
        if (!bad_element_[i]) bad_element_[i] = chunk.bad_element[i];
    }
    auto& libraries = contents_.libraries;
    libraries.insert(libraries.end(), chunk.libraries.begin(), chunk.libraries.end());
    if (chunk.lacks_normals)
        add_range(contents_.scene.without_normals,
                  {first_triangle, first_triangle + chunk.triangles.size()});
}

bool Assembly::all_in_range(ObjAttribute attribute) const {
    return !has_invalid_ && max_index_[attribute] <= counts_of(contents_.scene)[attribute];
}

/// Whether all elements are numbers, all normals have a length, and all indices in range.
bool Assembly::is_good(ObjAttribute attribute) const {
    return bad_[attribute].empty() && all_in_range(attribute);
}

/// Parses the statement of a triangle again, now that the bounds of its indices are known.
Assembly::Face Assembly::parse_face(std::size_t triangle) const {
    const auto piece =
        std::ranges::upper_bound(pieces_, triangle, {}, &PieceStart::first_triangle) - 1;
    ObjContext bounds{.before = piece->before, .total = counts_of(contents_.scene), .known = true};
    triangle -= piece->first_triangle;
    ObjChunk chunk;
    std::size_t begin = piece->offset, end = begin;
    for (;; begin = end) {
        end = obj_chunk_end(text_, begin, 1);
        chunk.clear();
        parse_obj_chunk(text_, begin, end, ObjContext{}, chunk);
        if (triangle < chunk.triangles.size()) break;
        triangle -= chunk.triangles.size();
        bounds.before[kObjPosition] += count32(chunk.positions);
        bounds.before[kObjUv] += count32(chunk.uvs);
        bounds.before[kObjNormal] += count32(chunk.normals);
    }
    chunk.clear();
    parse_obj_chunk(text_, begin, end, bounds, chunk);
    return {begin, std::move(chunk)};
}

void Assembly::warn_of_missing(ObjAttribute attribute, std::size_t count,
                               std::size_t first_triangle) {
    const std::optional<ObjError>& element = bad_element_[attribute];
    const bool is_normal = attribute == kObjNormal;
    const char* const name = is_normal ? "normal" : "texture coordinate";
    if (count == 0) {
        if (!element) return;
        contents_.warnings.push_back(
            {element->offset, fmt::format("{}; no corner has this {}", element->what, name)});
        return;
    }
    const Face face = parse_face(first_triangle);
    const std::optional<ObjError>& index = face.parsed.bad_index[attribute];
    const std::string why =
        index      ? index->what
        : !element ? "its length is 0"
                   : fmt::format("line {}: {}", contents_.lines.at(element->offset), element->what);
    contents_.warnings.push_back(
        {face.offset, fmt::format("{} {} a {} that is missing; {} ({})", count,
                                  count == 1 ? "corner has" : "corners have", name,
                                  is_normal ? "made" : "0 is used", why)});
}

template <typename T>
void Assembly::mend(ObjAttribute attribute, std::uint32_t Corner::*index,
                    std::vector<T>& elements) {
    SourceScene& scene = contents_.scene;
    const Mended mended = mend_corners(elements, bad_[attribute], all_in_range(attribute), index,
                                       contents_.polygons, scene.corners);
    for (const std::uint32_t i : bad_[attribute]) elements[i] = T{0.0f};
    if (attribute == kObjNormal)
        scene.without_normals = joined(scene.without_normals, mended.ranges);
    warn_of_missing(attribute, mended.count, mended.first_triangle);
}

void Assembly::mend() {
    SourceScene& scene = contents_.scene;
    for (std::size_t i = 0; !is_good(kObjPosition) && i < scene.corners.size(); ++i) {
        if (scene.corners[i].position < scene.positions.size()) continue;
        const Face face = parse_face(i / 3);
        throw_at(text_, name_, face.parsed.error.value());
    }
    if (!is_good(kObjUv)) mend(kObjUv, &Corner::uv, scene.uvs);
    if (!is_good(kObjNormal)) mend(kObjNormal, &Corner::normal, scene.normals);
}

ObjContents Assembly::finish() && {
    mend();
    contents_.colors = std::move(colors_).finish(contents_.scene.positions.size(), notes_);
    for (const ObjNote& note : notes_) {
        const std::string first = note.word.empty() ? "" : ", the first " + note.word;
        contents_.warnings.push_back(
            {note.offset, fmt::format("{}{} ({} in all)", note.kind, first, note.count)});
    }
    std::ranges::stable_sort(contents_.warnings, {}, &ObjError::offset);
    return std::move(contents_);
}

/// How much text is released in one go: each time interrupts the other threads.
constexpr std::size_t kReleaseBytes = 1 << 20;

struct Piece {
    std::size_t begin = 0;
    std::size_t end = 0;
    ObjChunk chunk;
    std::exception_ptr error;
};

void parse_pieces(std::string_view text, std::size_t chunk_bytes, const ObjContext& context,
                  Assembly& assembly, const Advance& advance) {
    const std::size_t in_flight =
        2 * tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    // The last stage finishes pieces in order, so a slot is free when its turn comes again.
    std::vector<Piece> slots(in_flight);
    std::size_t next_slot = 0;
    std::size_t next_begin = 0;
    std::size_t released = 0;

    const auto cut = [&](tbb::flow_control& control) -> Piece* {
        if (next_begin == text.size()) {
            control.stop();
            return nullptr;
        }
        Piece& piece = slots[next_slot];
        next_slot = (next_slot + 1) % slots.size();
        piece.begin = next_begin;
        piece.end = next_begin = obj_chunk_end(text, next_begin, chunk_bytes);
        return &piece;
    };
    const auto parse = [&](Piece* piece) {
        piece->chunk.clear();
        try {
            parse_obj_chunk(text, piece->begin, piece->end, context, piece->chunk);
        } catch (...) {
            piece->error = std::current_exception();  // a piece before it may have one, too
        }
        return piece;
    };
    const auto take = [&](Piece* piece) {
        if (piece->error) std::rethrow_exception(piece->error);
        assembly.append_chunk(piece->chunk, piece->begin, piece->end);
        advance(static_cast<double>(piece->end - piece->begin) / static_cast<double>(text.size()));
        if (piece->end - released < kReleaseBytes && piece->end < text.size()) return;
        common::forget_mapped(
            std::as_bytes(std::span(text)).subspan(released, piece->end - released));
        released = piece->end;
    };
    using tbb::filter_mode;
    tbb::parallel_pipeline(in_flight,
                           tbb::make_filter<void, Piece*>(filter_mode::serial_in_order, cut) &
                               tbb::make_filter<Piece*, Piece*>(filter_mode::parallel, parse) &
                               tbb::make_filter<Piece*, void>(filter_mode::serial_in_order, take));
}

}  // namespace

ObjContents parse_obj(std::string_view text, const std::string& name, std::size_t chunk_bytes,
                      const glm::dvec3& origin, const Advance& advance) {
    Assembly assembly(text, name);
    parse_pieces(text, chunk_bytes, {.origin = origin}, assembly, advance);
    ObjContents contents = std::move(assembly).finish();
    contents.scene.origin = origin;
    return contents;
}

}  // namespace bake
