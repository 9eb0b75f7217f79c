// Memory that is used again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace mesh_format {

/// Arrays for one task after the other: what one took, the next takes again, in the same order.
/// Fresh memory from the system costs more than what a mesh's decoding does with it.
class Scratch {
 public:
    /// What was taken may be taken again.
    void reset() { taken_ = 0; }

    /// Of any contents; until reset() or the end of this.
    template <typename T>
    T* take(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignof(std::max_align_t));
        if (taken_ == arrays_.size()) arrays_.emplace_back();
        Array& array = arrays_[taken_++];
        const std::size_t size = count * sizeof(T);
        if (array.size < size) {
            array.size = std::max(size, 2 * array.size);
            array.bytes.reset();
            array.bytes = std::make_unique_for_overwrite<std::byte[]>(array.size);
        }
        return reinterpret_cast<T*>(array.bytes.get());
    }

 private:
    struct Array {
        std::unique_ptr<std::byte[]> bytes;
        std::size_t size = 0;
    };
    std::vector<Array> arrays_;
    std::size_t taken_ = 0;
};

}  // namespace mesh_format
