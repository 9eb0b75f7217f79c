// The numbers that a glTF's accessors give.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/gltf/file.h"

namespace bake {

/// Reads accessors of a file; it and `warn` must outlive this. What does not fit together (an
/// accessor that reaches past its buffer view, a wrong type) throws BakeError with the accessor's
/// JSON pointer.
class GltfAccessors {
 public:
    GltfAccessors(const GltfFile& file, const Warn& warn) : file_(file), warn_(warn) {}

    /// Elements of an accessor without a view, all zeros: the only ones that take no bytes of the
    /// file.
    static constexpr std::size_t kMostZeros = std::size_t{1} << 24;

    std::size_t count(int accessor) const { return at(accessor).count; }
    int components(int accessor) const;

    /// All components of all elements, finite; normalised integers become [0, 1] or [-1, 1]. The
    /// accessor must have `components` an element. Valid until keep_only().
    const std::vector<float>& floats(int accessor, int components);

    /// The same of what a scene can do without: elements that are not finite become zeros, with a
    /// warning.
    const std::vector<float>& optional_floats(int accessor, int components);

    /// What floats() gives, which is forgotten at once.
    std::vector<float> take_floats(int accessor, int components);

    /// Scalars of an unsigned type.
    std::vector<std::uint32_t> indices(int accessor);

    /// Forgets what floats() gave, but for these: primitives often share accessors, but a file may
    /// claim more elements in all than memory holds.
    void keep_only(std::span<const int> accessors);

    [[noreturn]] void fail(int accessor, const std::string& what) const;

 private:
    enum class NotFinite : std::uint8_t { is_error, is_zero };
    const std::vector<float>& cached(int accessor, int components, NotFinite rule);
    std::vector<float> read_floats(int accessor, int components, NotFinite rule);
    const tinygltf::Accessor& at(int accessor) const {
        return file_.model.accessors[static_cast<std::size_t>(accessor)];
    }
    std::span<const std::byte> view_bytes(int view);
    std::vector<std::byte> packed_elements(int accessor);
    std::vector<std::byte> view_elements(int accessor, int view, std::size_t offset,
                                         std::size_t count, std::size_t element_bytes,
                                         bool may_have_stride);
    void apply_sparse(int accessor, std::size_t element_bytes, std::vector<std::byte>& elements);

    const GltfFile& file_;
    const Warn& warn_;
    std::map<int, std::vector<float>> floats_;
    std::map<int, std::vector<std::byte>> decompressed_;  ///< buffer views
    std::size_t compressed_bytes_ = 0;                    ///< of those
    std::set<int> not_finite_;                            ///< accessors of which a warning told
};

}  // namespace bake
