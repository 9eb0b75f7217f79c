#include "cw2-bake/obj/assembly.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <span>
#include <unordered_map>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/obj/parser.h"

namespace bake {
namespace {

/// A triangle's corners are counted in 32 bits.
constexpr std::size_t kMaxTriangles = 0xFFFF'FFFFu / 3;

[[noreturn]] void throw_at(std::string_view text, const std::string& name, const ObjError& error) {
    throw BakeError(fmt::format("{}:{}: {}", name, line_number(text, error.offset), error.what));
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
    Assembly(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    void append_chunk(ObjChunk& chunk, std::size_t text_bytes_left);
    /// Of the indices that are not relative, the largest of each attribute is in range.
    bool in_range() const;
    ObjContents finish() && { return std::move(contents_); }

 private:
    void append_arrays(const ObjChunk& chunk, std::size_t text_bytes_left);
    void append_materials(const ObjChunk& chunk);
    void append_notes(const ObjChunk& chunk);
    bool resolve(ObjChunk& chunk) const;
    std::uint32_t material_in_use();

    std::string_view text_;
    const std::string& name_;
    ObjContents contents_;
    ObjCounts max_index_{};
    std::unordered_map<std::string, std::uint32_t> material_ids_;
    ObjMaterialUse material_use_{};
    std::uint32_t material_id_ = kAbsent;  // of material_use_, once a face uses it
    bool relative_out_of_range_ = false;
};

/// The chunk's relative indices become indices from 0. False if one is out of range.
bool Assembly::resolve(ObjChunk& chunk) const {
    const ObjCounts before = counts_of(contents_.scene);
    bool good = true;
    const auto resolve_index = [&](std::uint32_t& index, ObjAttribute attribute) {
        if (index == kAbsent || index < kObjRelative) return;
        const std::uint64_t place = std::uint64_t{before[attribute]} + (index - kObjRelative);
        good &= place >= kObjRelativeBias;
        index = static_cast<std::uint32_t>(place - kObjRelativeBias);
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

void Assembly::append_chunk(ObjChunk& chunk, std::size_t text_bytes_left) {
    if (chunk.error) throw_at(text_, name_, *chunk.error);
    if (chunk.has_relative && !resolve(chunk)) relative_out_of_range_ = true;
    append_materials(chunk);
    append_notes(chunk);
    append_arrays(chunk, text_bytes_left);
}

void Assembly::append_arrays(const ObjChunk& chunk, std::size_t text_bytes_left) {
    SourceScene& scene = contents_.scene;
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

std::uint32_t Assembly::material_in_use() {
    if (material_id_ == kAbsent) {
        auto& materials = contents_.scene.materials;
        const auto [entry, is_new] =
            material_ids_.try_emplace(material_use_.name, count32(materials));
        if (is_new) {
            materials.emplace_back().name = material_use_.name;
            contents_.material_offsets.push_back(material_use_.offset);
        }
        material_id_ = entry->second;
    }
    return material_id_;
}

void Assembly::append_materials(const ObjChunk& chunk) {
    auto& triangle_material = contents_.scene.triangle_material;
    const std::size_t base = triangle_material.size();
    const auto use_until = [&](std::size_t end) {
        if (base + end > triangle_material.size()) {
            triangle_material.resize(base + end, material_in_use());
        }
    };
    for (const ObjMaterialUse& use : chunk.material_uses) {
        use_until(use.first_triangle);
        material_use_ = use;
        material_id_ = kAbsent;
    }
    use_until(chunk.triangles.size());
}

void Assembly::append_notes(const ObjChunk& chunk) {
    const auto first_triangle = static_cast<std::uint32_t>(contents_.scene.corners.size() / 3);
    for (ObjPolygon polygon : chunk.polygons) {
        polygon.first_triangle += first_triangle;
        contents_.polygons.push_back(polygon);
    }
    for (ObjSmoothingUse use : chunk.smoothing_uses) {
        use.first_triangle += first_triangle;
        contents_.smoothing_uses.push_back(use);
    }
    for (const ObjStatement& statement : chunk.unsupported) {
        const bool known =
            std::any_of(contents_.unsupported.begin(), contents_.unsupported.end(),
                        [&](const ObjStatement& other) { return other.words == statement.words; });
        if (!known) contents_.unsupported.push_back(statement);
    }
    auto& libraries = contents_.libraries;
    libraries.insert(libraries.end(), chunk.libraries.begin(), chunk.libraries.end());
    auto& short_faces = contents_.short_faces;
    short_faces.insert(short_faces.end(), chunk.short_faces.begin(), chunk.short_faces.end());
    contents_.lacks_normals |= chunk.lacks_normals;
}

bool Assembly::in_range() const {
    const ObjCounts counts = counts_of(contents_.scene);
    return !relative_out_of_range_ && max_index_[0] <= counts[0] && max_index_[1] <= counts[1] &&
           max_index_[2] <= counts[2];
}

/// Gives back the memory of text[begin, end), of which nothing will be read soon, save for the page
/// that the text after it shares.
void release(std::string_view text, std::size_t begin, std::size_t end) {
    static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const auto page_of = [&](std::size_t offset) {
        return reinterpret_cast<std::uintptr_t>(text.data() + offset) / page * page;
    };
    const std::uintptr_t size = page_of(end) - page_of(begin);
    if (size > 0) madvise(reinterpret_cast<void*>(page_of(begin)), size, MADV_DONTNEED);
}

/// How much text is released in one go: each time interrupts the other threads.
constexpr std::size_t kReleaseBytes = 1 << 20;

struct Piece {
    std::size_t begin = 0;
    std::size_t end = 0;
    ObjChunk chunk;
};

void parse_pieces(std::string_view text, std::size_t chunk_bytes, Assembly& assembly) {
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
        parse_obj_chunk(text, piece->begin, piece->end, ObjIndexBounds{}, piece->chunk);
        return piece;
    };
    const auto take = [&](Piece* piece) {
        assembly.append_chunk(piece->chunk, text.size() - piece->end);
        if (piece->end - released < kReleaseBytes && piece->end < text.size()) return;
        release(text, released, piece->end);
        released = piece->end;
    };
    using tbb::filter_mode;
    tbb::parallel_pipeline(in_flight,
                           tbb::make_filter<void, Piece*>(filter_mode::serial_in_order, cut) &
                               tbb::make_filter<Piece*, Piece*>(filter_mode::parallel, parse) &
                               tbb::make_filter<Piece*, void>(filter_mode::serial_in_order, take));
}

/// Parses everything again to find the statement with an index out of range.
[[noreturn]] void throw_index_error(std::string_view text, const std::string& name,
                                    std::size_t chunk_bytes, const ObjCounts& total) {
    ObjIndexBounds bounds{.before = {}, .total = total};
    ObjChunk chunk;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = obj_chunk_end(text, begin, chunk_bytes);
        chunk.clear();
        parse_obj_chunk(text, begin, end, bounds, chunk);
        if (chunk.error) throw_at(text, name, *chunk.error);
        bounds.before[kObjPosition] += count32(chunk.positions);
        bounds.before[kObjUv] += count32(chunk.uvs);
        bounds.before[kObjNormal] += count32(chunk.normals);
        begin = end;
    }
    throw BakeError(name + ": has an index that is out of range");
}

}  // namespace

ObjContents parse_obj(std::string_view text, const std::string& name, std::size_t chunk_bytes) {
    Assembly assembly(text, name);
    parse_pieces(text, chunk_bytes, assembly);
    const bool in_range = assembly.in_range();
    ObjContents contents = std::move(assembly).finish();
    if (!in_range) throw_index_error(text, name, chunk_bytes, counts_of(contents.scene));
    return contents;
}

}  // namespace bake
