// What the checks of a file and of a document have in common.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mesh-format/file.h"

namespace mesh_format {

/// What goes wrong in a file, told with the file's name and the place in it.
class Checker {
 public:
    explicit Checker(std::string_view name) : name_(name) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw FormatError(std::string(name_) + ": " + what);
    }
    void require(bool condition, const char* what) const {
        if (!condition) fail(what);
    }
    /// As above, for record `index` of the table `table`.
    void require(bool condition, const char* table, std::size_t index, const char* what) const {
        if (!condition) fail(std::string(table) + ' ' + std::to_string(index) + ": " + what);
    }

 private:
    std::string_view name_;
};

/// Whether [offset, offset + size) lies in [0, end), without overflow.
inline bool in_range(std::uint64_t offset, std::uint64_t size, std::uint64_t end) {
    return offset <= end && size <= end - offset;
}

/// As check() of file.h, where the texels section has `texel_bytes` bytes.
void check(const Document& document, std::uint64_t texel_bytes, std::string_view name);

/// What is left to ask of a document that passed check() once it is decoded, to indices that are
/// all vertices: whether floats are finite.
void check_decoded(const Document& document, std::string_view name);

}  // namespace mesh_format
