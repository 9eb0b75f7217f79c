// Vectors whose new elements hold anything: for arrays that several threads fill in parallel.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace bake {

/// Leaves elements as the memory is. So their pages are touched first by the thread that writes
/// them, not by the one that makes the array.
template <typename T>
struct RawAllocator : std::allocator<T> {
    static_assert(std::is_trivially_copyable_v<T>);

    template <typename Other>
    struct rebind {
        using other = RawAllocator<Other>;
    };
    void construct(T*) noexcept {}
    template <typename... Args>
    void construct(T* place, Args&&... args) {
        std::construct_at(place, std::forward<Args>(args)...);
    }
};

template <typename T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace bake
