// The numbers that a glTF's accessors give.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "cw2-bake/gltf/file.h"

namespace bake {

/// Reads accessors of a file, which must outlive this. What does not fit together (an accessor
/// that reaches past its buffer view, a wrong type) throws BakeError with the accessor's JSON
/// pointer.
class GltfAccessors {
 public:
    explicit GltfAccessors(const GltfFile& file) : file_(file) {}

    std::size_t count(int accessor) const { return at(accessor).count; }
    int components(int accessor) const;

    /// All components of all elements, finite; normalised integers become [0, 1] or [-1, 1]. The
    /// accessor must have `components` an element. Valid until keep_only().
    const std::vector<float>& floats(int accessor, int components);

    /// Scalars of an unsigned type.
    std::vector<std::uint32_t> indices(int accessor) const;

    /// Forgets what floats() gave, but for these: primitives often share accessors, but a file may
    /// claim more elements in all than memory holds.
    void keep_only(std::span<const int> accessors);

 private:
    const tinygltf::Accessor& at(int accessor) const {
        return file_.model.accessors[static_cast<std::size_t>(accessor)];
    }
    [[noreturn]] void fail(int accessor, const std::string& what) const;
    std::vector<std::byte> packed_elements(int accessor) const;
    std::vector<std::byte> view_elements(int accessor, int view, std::size_t offset,
                                         std::size_t count, std::size_t element_bytes,
                                         bool may_have_stride) const;
    void apply_sparse(int accessor, std::size_t element_bytes,
                      std::vector<std::byte>& elements) const;

    const GltfFile& file_;
    std::map<int, std::vector<float>> floats_;
};

}  // namespace bake
