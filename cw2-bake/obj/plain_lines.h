// The lines that make up nearly all of an OBJ, in the form in which nearly all programs write them.
#pragma once

#include <cstddef>
#include <string_view>

#include "cw2-bake/obj/chunk.h"
#include "cw2-bake/obj/digits.h"

namespace bake {

/// Reads v, vt, vn and f lines of short decimals and of indices from 1, with single blanks between
/// their words, which a glance at 64 bytes tells apart. Whatever else a line may hold, right or
/// wrong, is left to others.
class PlainLines {
 public:
    /// Looks nowhere but into `text`. Indices above `context.total` are left to others, and
    /// positions where there is an origin.
    PlainLines(std::string_view text, const ObjContext& context, ObjChunk& chunk);

    /// Reads lines of text[begin, end), which end in line ends, into the chunk. Returns where the
    /// first line starts that it does not read; `end` if it has read all.
    std::size_t read(std::size_t begin, std::size_t end);

    /// To be called after the last read(): tells the chunk about the indices that were read.
    void finish();

 private:
    const char* line(const char* p);
    template <typename Vector>
    const char* vector(const char* p, Vector& v) const;
    const char* position(const char* p);
    const char* uv(const char* p);
    const char* normal(const char* p);
    const char* face(const char* p);

    std::string_view text_;
    ObjChunk& chunk_;
    bool reads_positions_;
    Four limit_;     // by place in a Corner: the largest index from 1 that is read
    Four max_{};     // the largest that were
    Four absent_{};  // -1 where a corner lacked an index
};

}  // namespace bake
